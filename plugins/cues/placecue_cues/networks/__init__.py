"""Image networks: read, built, run."""
