"""A page for a browser that shows the map growing: served here, with nothing from elsewhere."""

from __future__ import annotations

import hashlib
import json
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, urlsplit

from placecue.errors import UsageError
from placecue.free_space import Grid
from placecue.logs.writing.scene import palette
from placecue.semantic_map import SemanticMap
from placecue.serving.onlooker import Moment
from placecue.serving.page_state import map_told, moment_told

#: Names of this machine, by which a page may ask for it.
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
#: How soon it is heard that there is to be no more, s.
POLL = 0.1
HTML, JSON = "text/html; charset=utf-8", "application/json"


class Page:
    """Serves a page with the map, the current room and the confidence of each cue; an onlooker.

    The page asks for the state a few times a second, and for the map when there is a new one. A
    request that names another host than this one is refused: pages of others must not read it.

    Parameters
    ----------
    title : str
        What is labelled.
    classes : sequence of str
        The classes that labels come from, for their colours.
    host : str
        The address to listen at.
    port : int
        The port; 0 takes a free one.
    more : callable
        Gives what else the page shows: numbers by name.

    Attributes
    ----------
    url : str
        Where the page is.

    Raises
    ------
    UsageError
        If nothing can be served there.
    """

    def __init__(
        self,
        title: str,
        classes: Sequence[str],
        host: str = "127.0.0.1",
        port: int = 8767,
        more: Callable[[], Mapping[str, Any]] = dict,
    ) -> None:
        colours = {name: _css(colour) for name, colour in palette(classes).items()}
        self.html = _page({"title": title, "colours": colours})
        self.host = host
        self.more = more
        self.ended = False
        self._moment: Moment | None = None
        self._map: dict[str, Any] | None = None
        self._version = 0
        try:
            self._server = ThreadingHTTPServer((host, port), partial(_Handler, self))
        except OSError as error:
            raise UsageError(
                f"cannot serve a page at {host}:{port} ({error.strerror}): give another "
                "view_port=, or view=false"
            ) from error
        self.url = f"http://{host}:{self._server.server_address[1]}/"
        self._server.daemon_threads = True
        Thread(
            target=self._server.serve_forever, args=(0.1,), name="placecue page", daemon=True
        ).start()

    def moment(self, moment: Moment) -> None:
        """Show a moment to who asks next."""
        self._moment = moment

    def map(self, stamp: int, semantic_map: SemanticMap, grid: Grid | None) -> None:
        """Show a map to who asks next."""
        self._map = map_told(semantic_map, grid)
        self._version += 1

    def end(self) -> None:
        """Let the page say that there is nothing more to come."""
        self.ended = True

    def close(self) -> None:
        """Serve no more."""
        self._server.shutdown()
        self._server.server_close()

    def state(self, has: int) -> bytes:
        """Return what is to be shown now, as JSON; with the map unless the page has it."""
        moment, version = self._moment, self._version
        told: dict[str, Any] = {"version": version, "ended": self.ended, "more": self.more()}
        if moment is not None:
            told |= moment_told(moment)
        if version != has:
            told["map"] = self._map
        return json.dumps(told, allow_nan=False).encode()

    def serves(self, host: str) -> bool:
        """Tell whether a request that names a host is meant for this page."""
        if self.host not in LOOPBACK:
            return True
        try:
            return urlsplit(f"//{host}").hostname in LOOPBACK
        except ValueError:
            return False


class _Handler(BaseHTTPRequestHandler):
    def __init__(self, page: Page, *arguments: Any) -> None:
        self.page = page
        super().__init__(*arguments)

    def do_GET(self) -> None:
        asked = urlsplit(self.path)
        if not self.page.serves(self.headers.get("Host", "")):
            self.send_error(403, "this page is for this machine alone")
        elif asked.path == "/":
            self._answer(self.page.html.text, HTML, self.page.html.policy)
        elif asked.path == "/state":
            has = parse_qs(asked.query).get("map", ["0"])[0]
            self._answer(self.page.state(int(has) if has.isdecimal() else 0), JSON)
        else:
            self.send_error(404)

    def _answer(self, content: bytes, kind: str, policy: str = "default-src 'none'") -> None:
        self.send_response(200)
        headers = {
            "Content-Type": kind,
            "Content-Length": str(len(content)),
            "Content-Security-Policy": policy,
            "X-Content-Type-Options": "nosniff",
            "Cache-Control": "no-store",
        }
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Say nothing of requests."""


class _Html:
    """A page, and what a browser may do with it."""

    def __init__(self, text: str, script: str, style: str) -> None:
        self.text = text.encode()
        self.policy = (
            f"default-src 'none'; img-src data:; connect-src 'self'; base-uri 'none'; "
            f"script-src '{_digest(script)}'; style-src '{_digest(style)}'"
        )


def _page(about: Mapping[str, Any]) -> _Html:
    files = resources.files("placecue.serving")
    style = files.joinpath("page.css").read_text("utf-8")
    # No "</script>" may stand in a script, whatever a class or a server is called.
    data = json.dumps(about).replace("<", "\\u003c")
    script = f"const ABOUT = {data};\n{files.joinpath('page.js').read_text('utf-8')}"
    text = files.joinpath("page.html").read_text("utf-8")
    return _Html(text.replace("/*STYLE*/", style).replace("/*SCRIPT*/", script), script, style)


def _digest(text: str) -> str:
    return f"sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _css(colour: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour)
