"""Search, by an optimiser, for joints whose safe load comes closest to their capacity."""
