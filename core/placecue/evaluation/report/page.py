"""One HTML page of sections and parts, with its style and its script inside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Protocol

from placecue.atomic import write_text

if TYPE_CHECKING:
    from jinja2 import Environment

REPORT = "report.html"


class Part(Protocol):
    """Something on a page, drawn by a template of its own, in which it is called ``part``."""

    template: ClassVar[str]


@dataclass(frozen=True)
class Section:
    """A heading, and what stands under it.

    Parameters
    ----------
    title : str
        The heading; unique on a page, as links go by it.
    parts : sequence of Part
        What stands under it; a section without any is left out.
    note : str
        A sentence before them.
    """

    title: str
    parts: Sequence[Part]
    note: str = ""

    @property
    def anchor(self) -> str:
        """What links to it name."""
        return "".join(c if c.isalnum() else "-" for c in self.title.lower())


@dataclass(frozen=True)
class Page:
    """A report.

    Parameters
    ----------
    title : str
        Its heading.
    sections : sequence of Section
        In reading order.
    lead : str
        A sentence under the heading.
    """

    title: str
    sections: Sequence[Section]
    lead: str = ""

    def render(self) -> str:
        """Return the page as HTML; all text in it is escaped."""
        shown = [section for section in self.sections if section.parts]
        return _environment().get_template("page.html.j2").render(page=self, sections=shown)

    def write(self, folder: Path) -> Path:
        """Write it as ``report.html`` into a folder, whole or not at all."""
        # Names of files may hold bytes that are no text.
        text = self.render().encode("utf-8", "replace").decode("utf-8")
        return write_text(folder / REPORT, text)


@cache
def _environment() -> Environment:
    # Takes a while to import, and most commands write no page.
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("placecue.evaluation.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
