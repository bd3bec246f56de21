"""Structures of blocks against published answers, hand formulas and other programs."""
