"""Answers about structures: tilts, mesh errors, forces of interfaces, effects of vertices."""
