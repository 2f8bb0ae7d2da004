"""Passes the steps of a run on to plugins that listen."""

from __future__ import annotations

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.components.manager import Plugins
from placecue.observation import Observation


class PluginListeners:
    """Tells plugins of observations classified and areas labelled; a listener.

    Parameters
    ----------
    plugins : Plugins
        Who is told.
    """

    def __init__(self, plugins: Plugins) -> None:
        self._plugins = plugins

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Tell the plugins of one step."""
        self._plugins.tell("observation_classified", observation=observation, belief=belief)
        if update is not None:
            self._plugins.tell("area_labelled", update=update)
