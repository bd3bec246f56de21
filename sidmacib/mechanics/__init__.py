"""Rigid pieces that meet across faces: equilibrium, failure and limit load of any such assembly."""
