"""Training: samples, held-out scores, and the threshold for "unknown"."""
