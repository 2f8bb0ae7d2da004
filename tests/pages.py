"""Reads HTML pages with nothing of placecue's."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

#: Elements that are never closed.
VOID = {"meta", "link", "img", "br", "input", "hr"}


class HtmlPage(HTMLParser):
    """The elements of a page, its text, and whether all that opens is closed.

    Attributes
    ----------
    elements : list of (str, dict)
        Each start tag with its attributes.
    text : str
        All text outside style and script.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(path.read_text(encoding="utf-8"))
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> without <{tag}>"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"script", "style"} & {*self.open}:
            self.text += data

    def of(self, tag: str) -> list[dict[str, str | None]]:
        """Return the attributes of all elements of a name."""
        return [attributes for name, attributes in self.elements if name == tag]

    def addresses(self) -> list[str]:
        """Return whatever would be fetched or followed."""
        names = ("src", "href", "xlink:href", "action", "srcset", "data")
        return [value for _, attributes in self.elements for name in names
                if (value := attributes.get(name))]  # fmt: skip
