"""How many locks work: the chain of springs, its closed form, and a safe rule."""
