"""The built-in sources, besides MCAP."""

from __future__ import annotations

from placecue.discovery.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="source",
            name="carmen",
            factory="placecue_sources.carmen:CarmenLog",
            summary="CARMEN text log: laser scans and odometry, plain or gzip",
            requires=("path",),
        ),
        Component(
            kind="source",
            name="floorplan",
            factory="placecue_sources.floorplan:FloorPlan",
            summary="Scans ray-cast in labelled floor plans",
            requires=("path",),
        ),
        Component(
            kind="source",
            name="office",
            factory="placecue_sources.office:Office",
            summary="Simulated office floor with camera and laser",
            requires=(),
        ),
    ]
