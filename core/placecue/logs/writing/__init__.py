"""What placecue writes: logs, annotated logs, scenes."""
