"""The full model of a scene: its options, the path of its loads, and the checks on the way."""
