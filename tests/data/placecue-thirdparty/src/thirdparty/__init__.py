"""A plugin as a third party would write it: two cues, one with an option file."""

from placecue import Component, hookimpl


@hookimpl
def placecue_components():
    return [
        Component("cue", "spread", "thirdparty.cues:Spread", "Spread of the ranges", ("scan",)),
        Component("cue", "nearest", "thirdparty.cues:Nearest", "Nearest beams", ("scan",)),
    ]


@hookimpl
def placecue_config_paths():
    return ["pkg://thirdparty.conf"]
