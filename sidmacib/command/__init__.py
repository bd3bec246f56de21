"""The command `multilock`: answers for one joint, in a terminal."""
