"""A report of a folder of results, as one HTML file that needs no network: of a run, or of a sweep."""
