"""Drawn floor plans: a generator of offices and homes for the source ``plans``."""
