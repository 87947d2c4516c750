"""Where the solver converges, and at what cost."""
