"""Where the solver converges, and at what cost: single runs of a layered strip, a cache of them, maps and tables."""
