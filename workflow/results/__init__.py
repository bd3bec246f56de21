"""One home for results: their columns, units, keys and checks, and how they are read and written."""
