"""A structure in three dimensions: shapes, loads and forces, drawn in pages and pictures."""
