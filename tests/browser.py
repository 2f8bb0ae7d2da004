"""A real browser without a window, where one is installed."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"),
    *("--allow-file-access-from-files", "--enable-logging=stderr", "--window-size=1280,900"),
    # Nothing outside is reached, whatever a page or the browser itself asks for.
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--disable-background-networking"),
    "--virtual-time-budget=3000",
)


def browser() -> str:
    """Return the browser, or skip the test."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"no browser is installed; looked for {', '.join(NAMES)}")
    return found


def ran(page: Path, script: str, folder: Path, state: str = "") -> tuple[Any, list[str]]:
    """Open a page and run a script in it.

    Parameters
    ----------
    page : Path
        It stays as it is; a copy with the script is opened.
    script : str
        The body of a function; what it returns is handed back.
    folder : Path
        For the copy, and for what the browser writes.
    state : str
        What stands behind ``#`` in the address.

    Returns
    -------
    object
        What the script returned.
    list of str
        Whatever the page told on its console.
    """
    copy = folder / "opened.html"
    copy.write_text(
        page.read_text(encoding="utf-8").replace(
            "</body>",
            f"<script>addEventListener('load', () => {{ const told = (() => {{{script}}})();"
            "document.body.innerHTML = ''; const pre = document.createElement('pre');"
            "pre.id = 'told'; pre.textContent = JSON.stringify(told);"
            "document.body.append(pre); })</script></body>",
        ),
        encoding="utf-8",
    )
    done = subprocess.run(
        [browser(), *FLAGS, f"--user-data-dir={folder / 'profile'}", "--dump-dom",
         f"{copy.as_uri()}#{state}"],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )  # fmt: skip
    told = re.search(r'<pre id="told">(.*?)</pre>', done.stdout, re.DOTALL)
    assert told, done.stderr
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return json.loads(unescape(told[1])), console
