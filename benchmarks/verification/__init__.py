"""Cases with a known answer, by area; ``python3 -m benchmarks.verification`` runs them all."""
