"""Joints whose safe load comes nearest to what they carry, by an optimiser."""
