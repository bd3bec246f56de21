"""Joints that were measured, and what a test would have to measure."""
