"""Structures of blocks in a study: their cases, problems and records."""
