"""From an engine's output to weights, fits, tables and figures."""
