"""How data sets are known, by what is in a file or what lies in a folder; imports nothing heavy."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Sequence

from placecue import Found

IMAGES = (".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm", ".tif", ".tiff", ".webp")
#: A time and a pose in the name of an image; IDOL2 puts the room between them.
TIMED = re.compile(r"t\d+(\.\d+)?(?P<room>_r[^_]+)?_x[^_]+_y[^_]+_a[^_]+\.(png|jpe?g)")
CARMEN = re.compile(
    rb"^(# CARMEN Logfile|(PARAM|FLASER|RLASER|RAWLASER\d|ROBOTLASER\d|ODOM|TRUEPOS|SYNC) )", re.M
)
#: Columns that a table of observations has one of at least.
COLUMNS = {"stamp", "time", "timestamp", "image", "scan", "ranges", "label", "file", "filename"}


def carmen(found: Found) -> int:
    """Tell whether this is a CARMEN log."""
    return Found.BY_CONTENT if not found.names and CARMEN.search(found.head) else Found.NOT_AT_ALL


def idol2(found: Found) -> int:
    """Tell whether this is a sequence of IDOL2: images whose names hold time, room and pose."""
    timed = (TIMED.fullmatch(posixpath.basename(name)) for name in found.names)
    return Found.BY_CONTENT if any(match and match["room"] for match in timed) else Found.NOT_AT_ALL


def cold(found: Found) -> int:
    """Tell whether this is a sequence of COLD: images with time and pose beside places.lst."""
    base = [posixpath.basename(name) for name in found.names]
    timed = any(match and not match["room"] for match in map(TIMED.fullmatch, base))
    return Found.BY_CONTENT if timed or "places.lst" in base else Found.NOT_AT_ALL


def cold_meta(found: Found) -> int:
    """Tell whether this is a sequence of COLD-Meta: scans.dat beside labels.dat."""
    base = {posixpath.basename(name) for name in found.names}
    return Found.BY_CONTENT if {"scans.dat", "labels.dat"} <= base else Found.NOT_AT_ALL


def rgbd(found: Found) -> int:
    """Tell whether this is a folder of colour and of depth images."""
    folders = {posixpath.dirname(name) for name in _images(found.names)}
    both = {"rgb", "depth"} <= folders
    return Found.BY_CONTENT if both and found.path.is_dir() else Found.NOT_AT_ALL


def image_folder(found: Found) -> int:
    """Tell whether this is a folder, or a tar, with images in folders."""
    return Found.BY_SHAPE if any("/" in name for name in _images(found.names)) else Found.NOT_AT_ALL


def floorplan(found: Found) -> int:
    """Tell whether this is a picture, or polygons, of a floor."""
    plan = found.head.startswith(b"\x89PNG") or (
        found.suffix == ".geojson" and found.head.lstrip(b"\xef\xbb\xbf \r\n").startswith(b"{")
    )
    return Found.BY_SHAPE if plan else Found.NOT_AT_ALL


def table(found: Found) -> int:
    """Tell whether this is a table of observations: text in columns, whose names may tell."""
    if found.names or b"\0" in found.head or found.suffix not in (".csv", ".tsv", ".txt"):
        return Found.NOT_AT_ALL
    first = found.head.split(b"\n", 1)[0].decode("utf-8-sig", "replace")
    cells = [cell.strip().strip('"').lower() for cell in re.split(r"[,;\t]", first)]
    return (
        (Found.BY_CONTENT if COLUMNS & set(cells) else Found.BY_SHAPE)
        if len(cells) > 1
        else Found.NOT_AT_ALL
    )


def _images(names: Sequence[str]) -> list[str]:
    return [name for name in names if name.lower().endswith(IMAGES)]
