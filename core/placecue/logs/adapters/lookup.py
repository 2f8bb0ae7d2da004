"""Which adapter reads the messages of a schema."""

from __future__ import annotations

import logging
from collections import defaultdict
from functools import cache
from itertools import product

from placecue.components.manager import current_plugins
from placecue.components.registry import Provided, Registry
from placecue.errors import PluginError
from placecue.logs.adapters.base import Adapter

log = logging.getLogger(__name__)

#: Adapters, with who brought them, by message encoding and name of the schema.
Table = dict[tuple[str, str], list[tuple[Adapter, Provided]]]


def adapter_for(encoding: str, schema: str, registry: Registry | None = None) -> Adapter | None:
    """Return the adapter for messages of a schema, or None.

    Parameters
    ----------
    encoding : str
        Message encoding of the channel.
    schema : str
        Name of its schema.
    registry : Registry, optional
        What there is; by default what is installed.

    Raises
    ------
    PluginError
        If two adapters claim the schema.
    """
    key = encoding, schema.replace("/msg/", "/")
    claims = _table(registry or current_plugins().registry).get(key, [])
    if len(claims) > 1:
        owners = " and ".join(f"'{p.component.name}' of {p.distribution}" for _, p in claims)
        raise PluginError(
            f"{encoding} messages of {schema} are claimed by the adapters {owners}: uninstall one "
            "of them, or run with --no-plugins to use the built-ins alone"
        )
    return claims[0][0] if claims else None


@cache
def _table(registry: Registry) -> Table:
    table: Table = defaultdict(list)
    for provided in registry:
        if provided.component.kind != "adapter":
            continue
        try:
            adapter: Adapter = registry.load("adapter", provided.component.name)()
            for key in product(adapter.encodings, adapter.schemas):
                table[key].append((adapter, provided))
        except Exception as error:  # logs of all other schemas can still be read
            log.warning(
                f"adapter '{provided.component.name}' of {provided.distribution} "
                f"{provided.version} is not used: {type(error).__name__}: {error}"
            )
    return table
