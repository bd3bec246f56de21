"""How many locks work: the chain of springs in closed form, a law, and a safe rule."""
