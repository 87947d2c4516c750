"""Materials: strain energy densities, one a file, and the stresses that follow from them."""
