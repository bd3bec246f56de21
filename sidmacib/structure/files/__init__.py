"""Structures in files: their own YAML, COMPAS, triangle meshes; and results for COMPAS."""
