"""Measured tables beside the program's results."""
