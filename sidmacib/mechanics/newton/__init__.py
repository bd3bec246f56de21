"""Newton's method on contact nodes, compiled: faces, equilibria, and rounds where it gives up."""
