"""The modules of CalculiX's script, copied beside it."""
