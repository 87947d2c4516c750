"""One scene by any model, many scenes, and models side by side."""
