"""A simulated office floor with camera and laser."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="source",
            name="office",
            factory="placecue_office.simulator:Office",
            summary="Simulated office floor with camera and laser",
            requires=(),
        ),
    ]
