"""Equilibrium of elastic pieces, in terms of the openings and slips at contact nodes."""
