"""The modules of LIGGGHTS's script, copied beside it."""
