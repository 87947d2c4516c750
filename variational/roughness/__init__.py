"""Microscale closures: from a ridge's mean contact pressure to its equivalent air gap. No dolfinx in here."""
