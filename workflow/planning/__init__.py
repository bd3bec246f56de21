"""What a run has to do: the jobs of a study, and which of them are up to date."""
