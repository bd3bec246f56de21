"""What is run: the study's configuration, its cases, and external programs."""
