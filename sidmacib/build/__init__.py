"""Blocks with their locks as solids: shapes, files for printers and mills, drawings."""
