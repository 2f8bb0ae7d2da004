"""The MCAP container: chunks, records and their index."""
