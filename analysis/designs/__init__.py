"""Designed studies of many joints: what the law and the rules are worth."""
