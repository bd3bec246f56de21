"""The joint: its definition and parameters, its pieces and loads, what follows from them."""
