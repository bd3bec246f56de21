"""Blocks that bend: elastic pieces, from soft to rigid."""
