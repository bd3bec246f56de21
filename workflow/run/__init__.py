"""A run of a study: its process, results folder, jobs and progress output."""
