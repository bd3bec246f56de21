"""A run of a study: its process, its results folder, its jobs and what it shows."""
