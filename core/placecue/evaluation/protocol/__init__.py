"""An experiment: recordings, pairs of them, methods, and what computes their results."""
