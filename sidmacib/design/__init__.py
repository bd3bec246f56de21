"""Design of structures: where locks go, how many, which way they run, and in which order to build."""
