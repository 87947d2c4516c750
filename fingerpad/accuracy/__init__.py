"""Discretisation errors of a run, estimated and refined until they are within what a scene asks for."""
