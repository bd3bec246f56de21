"""What a joint carries by the first-failure law and the safe rule, and how many locks work."""
