"""A simulated office floor with camera and laser."""

from __future__ import annotations

from placecue_sources.office.simulator import Office

__all__ = ["Office"]
