"""What a run has come to, as one HTML page that needs nothing beside it."""
