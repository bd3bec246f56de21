"""Design of structures: how many locks each interface gets, which way they run, and the order."""
