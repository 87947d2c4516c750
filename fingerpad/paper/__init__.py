"""The figures of Forsbach, Heß and Papangelo (2023), computed by this model: ``fingerpad paper``."""
