"""One home for results: their columns, units, keys and checks, reading and writing."""
