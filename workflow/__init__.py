"""The workflow: a study's configuration, its cases, and external programs."""
