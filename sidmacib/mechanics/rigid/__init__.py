"""Equilibrium of rigid pieces, in terms of their displacements."""
