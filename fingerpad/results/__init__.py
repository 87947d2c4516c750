"""What goes in and comes out of a run besides its scene: options, folder, tables, pictures, results, signals."""
