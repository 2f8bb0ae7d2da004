"""A robot's messages as they come, over the WebSocket protocol that Foxglove speaks."""
