"""What a run believes while it goes on, for those who look on: viewers and browsers."""
