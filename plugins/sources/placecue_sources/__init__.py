"""The built-in sources, besides MCAP."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


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
            recognise="placecue_sources.recognise:carmen",
        ),
        Component(
            kind="source",
            name="cold",
            factory="placecue_sources.cold:Cold",
            summary="Sequence of the COLD database, folder or tar",
            requires=("path",),
            recognise="placecue_sources.recognise:cold",
        ),
        Component(
            kind="source",
            name="cold_meta",
            factory="placecue_sources.cold_meta:ColdMeta",
            summary="Sequence of COLD-Meta: scans, poses and labels without images",
            requires=("path",),
            recognise="placecue_sources.recognise:cold_meta",
        ),
        Component(
            kind="source",
            name="floorplan",
            factory="placecue_sources.floorplan:FloorPlan",
            summary="Scans ray-cast in labelled floor plans",
            requires=("path",),
            recognise="placecue_sources.recognise:floorplan",
        ),
        Component(
            kind="source",
            name="idol2",
            factory="placecue_sources.idol2:Idol2",
            summary="Sequence of the IDOL2 database, folder or tar",
            requires=("path",),
            recognise="placecue_sources.recognise:idol2",
        ),
        Component(
            kind="source",
            name="image_folder",
            factory="placecue_sources.image_folder:ImageFolder",
            summary="Images in one folder a class",
            requires=("path",),
            recognise="placecue_sources.recognise:image_folder",
        ),
        Component(
            kind="source",
            name="plans",
            factory="placecue_sources.plans.source:Plans",
            summary="Scans ray-cast in offices and homes that a seed draws",
        ),
        Component(
            kind="source",
            name="rgbd",
            factory="placecue_sources.rgbd:RGBD",
            summary="Colour and depth images, with a virtual laser scan cut from the depth",
            requires=("path",),
            recognise="placecue_sources.recognise:rgbd",
        ),
        Component(
            kind="source",
            name="table",
            factory="placecue_sources.table:Table",
            summary="Any data set: a CSV, or files whose names tell it",
            requires=("path",),
            recognise="placecue_sources.recognise:table",
        ),
    ]
