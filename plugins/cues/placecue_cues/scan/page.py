"""The page of the documentation that lists the laser features.

``python -m placecue_cues.scan.page > docs/laser_features.md`` writes it anew.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

from placecue_cues.laser import LaserGeometry

from .families import Family

_INTRODUCTION = """\
# Laser features

The cue `laser` turns a 2D laser scan into a vector of geometric features. This page is made from
the code: `python -m placecue_cues.scan.page > docs/laser_features.md`. In Python,
`LaserGeometry(preset).feature_names`, `.feature_units` and `.families` list every column.

Beams without a valid measurement (NaN, infinite, or outside the scanner's limits) first take the
scanner's maximum range. No input gives NaN: a ratio to nothing is 0.

Features that say much the same are in one *family*. In the distance between two scans, on which an
SVM decides, 99 Fourier descriptors outvote everything else, so the default scaling (`families`)
gives every family the same weight: it maps each feature to its training quantiles and divides it by
the square root of the family's size. `cues.laser.classifier.scaling=quantiles` does without,
`'cues.laser.classifier.scaling.weights={fourier: 0.5}'` halves a family's part of the distance.
What it brings stands in [laser.md](laser.md).
"""

_PRESETS = {
    "group": """\
The features that the paper's group fed to its laser SVM, made for scanners of 180°. Pairs of beams
are cyclic, the polygon joins the beams' end points and nothing is clipped. Counts depend on the
number of beams, so train and run with the same scanner.
""",
    "full": """\
Everything in the papers of Martínez Mozos et al. (ICRA 2005, RAS 2007), for any field of view.
Scans are first resampled to a fixed angular step (0.5°), on straight surfaces between neighbouring
beams except where the range jumps, so the number of beams does not matter. A full turn is a closed
polygon with cyclic pairs; a smaller field of view is closed by the scanner's position. The clips,
thresholds and the number of Fourier descriptors are parameters; these are the defaults.
""",
}


def page() -> str:
    """Return the page, Markdown."""
    return "\n".join([_INTRODUCTION, *(_section(preset) for preset in _PRESETS)])


def _section(preset: str) -> str:
    families = LaserGeometry(preset).feature_families()
    total = sum(len(family.names) for family in families)
    head = f"## Preset `{preset}`: {total} features\n\n{_PRESETS[preset]}\n"
    table = "| column | name | family | unit | what it is |\n|---|---|---|---|---|\n"
    return head + table + "".join(_rows(families))


def _rows(families: tuple[Family, ...]) -> Iterator[str]:
    column = 0
    for family in families:
        last = column + len(family.names) - 1
        columns = f"{column}" if last == column else f"{column} to {last}"
        column = last + 1
        what = f"`{family.name}` | {family.unit} | {family.meaning}"
        yield f"| {columns} | {_names(family.names)} | {what} |\n"


def _names(names: tuple[str, ...]) -> str:
    quoted = [f"`{name}`" for name in names]
    return ", ".join(quoted if len(quoted) <= 20 else [*quoted[:3], "…", quoted[-1]])


if __name__ == "__main__":
    sys.stdout.write(page())
