"""From messages to observations: topics, clocks, frames, labels."""
