"""Poses from scans: scans laid on one another, and a graph of poses (``placecue[slam]``)."""
