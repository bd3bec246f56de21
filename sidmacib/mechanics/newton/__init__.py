"""Newton's method on contact nodes, compiled: the contact law, faces, elimination, equilibria."""
