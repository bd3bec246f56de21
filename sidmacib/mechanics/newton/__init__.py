"""Newton's method on contact nodes, compiled: faces, elimination, equilibria."""
