"""What Forsbach, Heß and Papangelo (2023) report, by our model; ``benchmarks/reproduce.py`` runs it."""
