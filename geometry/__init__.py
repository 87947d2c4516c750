"""Cross-sections of fingertips and of small verification bodies, meshed with gmsh."""
