"""``python -m placecue``."""

from placecue.cli import main

main()
