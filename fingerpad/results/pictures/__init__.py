"""Pictures of results by Matplotlib: curves, fingers, whole fingers, spikes and animations, in one style."""
