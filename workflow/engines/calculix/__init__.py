"""CalculiX: what it can do (engine), and the modules of its script, copied beside every script."""
