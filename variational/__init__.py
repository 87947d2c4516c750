"""Finite-strain contact, friction and electroadhesion of soft layered bodies on a rigid screen, in UFL.

Importing this package imports nothing heavy: :mod:`variational.roughness` works without dolfinx.
"""
