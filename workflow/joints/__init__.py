"""A joint in a study: its case, the problem that it poses, samplings of joints."""
