"""Planning of a run: the jobs of a study, and those that are up to date."""
