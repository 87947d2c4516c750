"""The full model of a scene: its options, the path of its loads, and what is watched on the way."""
