"""Messages of every schema, decoded."""
