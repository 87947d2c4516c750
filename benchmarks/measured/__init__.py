"""Measured fingers beside this model, row by row; written to ``docs/measured.md``."""
