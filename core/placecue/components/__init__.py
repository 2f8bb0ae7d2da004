"""How plugins are found: hook specifications, our loader, the registry."""
