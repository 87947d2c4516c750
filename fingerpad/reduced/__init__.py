"""A cheaper model of the same scene: charged cylinders."""
