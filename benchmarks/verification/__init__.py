"""Cases with a known answer, by area; ``benchmarks/verify.py`` runs them all."""
