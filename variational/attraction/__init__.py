"""Electroadhesion: the electrostatic traction across air gap and insulator, and a charged cylinder in closed form."""
