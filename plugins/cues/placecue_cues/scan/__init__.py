"""Geometry of laser scans: the parts that the laser cue's features are made of."""
