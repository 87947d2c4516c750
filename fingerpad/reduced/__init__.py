"""Cheaper models of the same scene: charged cylinders, and a smooth finger with the law of one ridge."""
