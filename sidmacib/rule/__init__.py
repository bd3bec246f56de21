"""Capacity of a joint by the first-failure law and the safe rule; the number of working locks."""
