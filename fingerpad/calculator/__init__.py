"""The calculator: the closed form of :mod:`fingerpad.reduced.cylinders` as one HTML page that needs no Python."""
