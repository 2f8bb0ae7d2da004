"""Logs: MCAP in, MCAP out."""
