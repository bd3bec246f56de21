"""A barrel vault from a file of COMPAS to the locks that it needs."""
