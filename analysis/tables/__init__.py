"""The steps that make the tables of a study."""
