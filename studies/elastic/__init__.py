"""Elastic blocks, from soft to rigid."""
