"""The modules of YADE's script, copied beside it."""
