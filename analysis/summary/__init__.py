"""A study or a case in words, and whether the study is complete."""
