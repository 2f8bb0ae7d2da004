"""Who looks on while ``placecue live`` runs: viewers of Foxglove's protocol, and a browser."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from ipaddress import ip_address
from typing import Any

from placecue.checks import check_flag, check_number, check_whole
from placecue.serving.foxglove_server import FoxgloveServer
from placecue.serving.onlooker import Onlooker
from placecue.serving.page import Page


def check_onlookers(config: Mapping[str, Any]) -> None:
    """Refuse what cannot be served.

    Raises
    ------
    UsageError
        If an option is no such thing.
    """
    for key in ("serve", "view"):
        check_flag(key, config[key])
    for key in ("port", "view_port"):
        check_whole(key, config[key], least=0, most=65535)
    check_number("map_every", config["map_every"], above=0)


def onlookers_of(
    config: Mapping[str, Any],
    title: str,
    classes: Sequence[str],
    more: Callable[[], Mapping[str, str]],
    stack: ExitStack,
) -> list[Onlooker]:
    """Return who is told of what goes on, and say where.

    Parameters
    ----------
    config : mapping
        With ``serve``, ``view``, ``host``, ``port`` and ``view_port``.
    title : str
        What is labelled.
    classes : sequence of str
        The classes that labels come from.
    more : callable
        Gives what else the page shows.
    stack : ExitStack
        Closes them.
    """
    found: list[Onlooker] = []
    host = config["host"]
    if config["serve"]:
        server = FoxgloveServer(classes, host, config["port"])
        stack.callback(server.close)
        print(f"beliefs and the map are at {server.url} (Foxglove, Lichtblick)", flush=True)
        found.append(server)
    if config["view"]:
        page = Page(title, classes, host, config["view_port"], more)
        stack.callback(page.close)
        print(f"the map is shown at {page.url}", flush=True)
        found.append(page)
    if found and not _is_loopback(host):
        print(f"note: host={host} lets the whole network look on", flush=True)
    return found


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
