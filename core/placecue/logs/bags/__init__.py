"""Rosbags as they are recorded: their containers, cuts and definitions."""
