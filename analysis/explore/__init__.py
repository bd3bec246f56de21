"""A page to play with a joint: `make explore`."""
