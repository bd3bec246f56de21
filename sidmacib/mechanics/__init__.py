"""Pieces that meet across faces: assemblies, equilibrium, failure and limit load. No joint here."""
