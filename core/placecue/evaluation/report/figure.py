"""A figure inside the page: SVG without anything that acts, fetches, or leaks into the page."""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar
from xml.etree import ElementTree

from placecue.errors import DataError

if TYPE_CHECKING:
    from markupsafe import Markup

#: Elements that act, or say what is said elsewhere.
DROPPED = frozenset({"script", "foreignObject", "metadata", "style", "animate", "set", "title"})
#: matplotlib says this of every element; in a page it would be said of the page's as well.
JOINED = "stroke-linejoin:round;stroke-linecap:butt"
_REFERENCE = re.compile(r"url\(\s*['\"]?([^)'\"]*)['\"]?\s*\)")


@dataclass(frozen=True)
class Figure:
    """A drawing with a caption.

    Parameters
    ----------
    name : str
        What it is called; unique on a page.
    svg : str
        The drawing; empty where there are pixels instead.
    caption : str
        What it shows.
    png : bytes
        The drawing in pixels.
    """

    template: ClassVar[str] = "figure.html.j2"

    name: str
    svg: str
    caption: str = ""
    png: bytes = b""

    @property
    def inline(self) -> Markup:
        """The drawing as it stands in the page.

        Raises
        ------
        DataError
            If it is no SVG.
        """
        from markupsafe import Markup

        prefix = "f" + hashlib.sha256(self.name.encode()).hexdigest()[:8]
        return Markup(inlined(self.svg, prefix, self.name))

    @property
    def source(self) -> str:
        """The pixels as a data URI."""
        return data_uri(self.png, "png")


def data_uri(picture: bytes, kind: str) -> str:
    """Return an encoded picture as an address that needs no network."""
    return f"data:image/{kind};base64,{base64.b64encode(picture).decode()}"


def inlined(svg: str, prefix: str, label: str) -> str:
    """Return an SVG such that it can stand in a page beside others.

    Scripts, styles and addresses outside the page are left out; names get a prefix.

    Parameters
    ----------
    svg : str
        A whole document.
    prefix : str
        Of the names in it.
    label : str
        What it shows, for who cannot see it.

    Raises
    ------
    DataError
        If it is no SVG.
    """
    try:
        root = ElementTree.fromstring(svg)
    except ElementTree.ParseError as error:
        raise DataError(f"figure '{label}' is no SVG ({error}): draw it again") from error
    if _local(root.tag) != "svg":
        raise DataError(f"figure '{label}' is no SVG but <{_local(root.tag)}>: draw it again")
    _strip(root)
    _rename(root, prefix)
    root.attrib |= {"role": "img", "aria-label": label, "style": JOINED}
    return ElementTree.tostring(root, encoding="unicode")


def _strip(element: ElementTree.Element) -> None:
    element.tag = _local(element.tag)
    for name in list(element.attrib):
        value = element.attrib.pop(name)
        if _harmless(_local(name), value):
            element.set(_local(name), value)
    for child in list(element):
        if not isinstance(child.tag, str) or _local(child.tag) in DROPPED:
            element.remove(child)
        else:
            _strip(child)


def _harmless(name: str, value: str) -> bool:
    if name == "href":
        return value.startswith(("#", "data:image/png;", "data:image/jpeg;"))
    targets = _REFERENCE.findall(value)
    return not name.lower().startswith("on") and all(each.startswith("#") for each in targets)


def _rename(root: ElementTree.Element, prefix: str) -> None:
    """Give names that are referred to a prefix, and take away all others."""
    referred = {name for element in root.iter() for name in _referred(element)}
    for element in root.iter():
        name = element.attrib.pop("id", None)
        if name in referred:
            element.set("id", f"{prefix}-{name}")
        for key, value in element.attrib.items():
            if key == "href" and value.startswith("#"):
                element.set(key, f"#{prefix}-{value[1:]}")
            elif "url(" in value:
                element.set(key, _REFERENCE.sub(lambda m: f"url(#{prefix}-{m[1][1:]})", value))


def _referred(element: ElementTree.Element) -> list[str]:
    found = [each for value in element.attrib.values() for each in _REFERENCE.findall(value)]
    return [each[1:] for each in (*found, element.get("href", "")) if each.startswith("#")]


def _local(name: Any) -> str:
    return str(name).rpartition("}")[2]
