"""Help that people read: examples, then every key with a sentence; no Hydra is imported for it."""
