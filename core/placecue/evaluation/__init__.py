"""How well it works: metrics, tables, figures."""
