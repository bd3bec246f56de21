"""Answers: which meshes a model is solved on, and which of its loads counts, for every door."""
