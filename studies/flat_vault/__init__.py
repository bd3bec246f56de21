"""A flat vault of blocks that lean on each other."""
