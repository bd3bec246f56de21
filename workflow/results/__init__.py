"""Results: columns, units, keys and checks; reading and writing."""
