"""Labels: rooms that give them, and maps from one name to another."""
