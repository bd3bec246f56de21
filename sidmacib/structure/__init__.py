"""Structures of blocks of any shape: arches, walls, vaults; their interfaces, and loads on them."""
