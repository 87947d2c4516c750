"""What Forsbach, Heß and Papangelo (2023) report, by this model; ``python3 -m benchmarks.paper`` runs it."""
