"""How long everything takes: on this machine, beside other programs, and of large studies."""
