"""What the methods of components promise to return.

Each function returns None, or what is wrong, such as ``returned 1 row for 3 samples``: a check for
:func:`placecue.guard.call`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from numbers import Integral, Real
from typing import Any

import numpy as np
from scipy import sparse

from placecue.accumulator import AreaUpdate
from placecue.camera import PinholeCamera
from placecue.errors import described
from placecue.features import DescriptorSets, FeatureBatch, kind_of
from placecue.observation import LaserScan, Observation, Pose2D
from placecue.scores import Layout, Scores
from placecue.semantic_map import Area, Node, SemanticMap

#: What fits a stamp.
_STAMPS = np.iinfo(np.int64)


def itself(made: object, component: object) -> str | None:
    """Check what ``fit`` returns: the component."""
    return None if made is component else f"returned {described(made)}, not the component itself"


# ---------------------------------------------------------------------- features


def features(made: Any) -> str | None:
    """Check the features of one observation: a vector, a CSR row or local descriptors, of numbers.

    Whether they are finite is :func:`finite`.
    """
    if sparse.issparse(made):
        return _csr(made, 1)
    if not isinstance(made, np.ndarray):
        return f"returned {described(made)}, not a vector, a CSR row or descriptors"
    if made.ndim not in (1, 2) or made.shape[-1] == 0:
        return f"returned an array of shape {made.shape}, not a vector (d,) or descriptors (k, d)"
    return _numbers(made)


def batch(made: Any, n: int, like: FeatureBatch | None = None) -> str | None:
    """Check the features of n observations, and that they are as those seen in training.

    Parameters
    ----------
    made : object
        What came.
    n : int
        How many samples were asked for.
    like : batch, optional
        Features that these must fit: of the same kind and width.
    """
    if isinstance(made, DescriptorSets):
        wrong = _descriptors(made)
    elif sparse.issparse(made):
        wrong = _csr(made, n)
    elif isinstance(made, np.ndarray):
        wrong = _numbers(made) if made.ndim == 2 else f"returned an array of shape {made.shape}"
    else:
        wrong = f"returned {described(made)}, not a batch of features"
    return wrong or _rows(made, n) or (None if like is None else _unlike(made, like))


def finite(made: Any) -> str | None:
    """Check that numbers (features of any kind, or an array) are finite."""
    if isinstance(made, DescriptorSets):
        made = made.values
    values = made.data if sparse.issparse(made) else made
    return None if _all_finite(values) else "returned NaN or infinite numbers"


def _csr(made: Any, n: int) -> str | None:
    if made.format != "csr" or made.ndim != 2 or made.shape[1] == 0:
        return f"returned {described(made)} of shape {made.shape}, not a CSR array of ({n}, bins)"
    return _rows(made, n) or _numbers(made.data)


def _descriptors(made: DescriptorSets) -> str | None:
    values, offsets = made.values, made.offsets
    if not isinstance(values, np.ndarray) or values.ndim != 2 or values.shape[1] == 0:
        return "returned descriptor sets whose values are no array (total, d)"
    steps = np.diff(offsets) if isinstance(offsets, np.ndarray) and offsets.ndim == 1 else ()
    whole = len(steps) and offsets.dtype.kind == "i" and offsets[0] == 0
    if not whole or offsets[-1] != len(values) or np.min(steps) < 0:
        return f"returned descriptor sets whose offsets do not part {len(values)} descriptors"
    return _numbers(values)


def _numbers(values: np.ndarray[Any, Any]) -> str | None:
    if values.dtype.kind in "fiub":
        return None
    return f"returned an array of {values.dtype}, not of real numbers"


def _rows(made: Any, n: int) -> str | None:
    rows = made.shape[0]
    return None if rows == n else f"returned {_count(rows, 'row')} for {_count(n, 'sample')}"


def _unlike(made: FeatureBatch, like: FeatureBatch) -> str | None:
    if kind_of(made) is not kind_of(like):
        return f"returned a {kind_of(made)} where training had a {kind_of(like)}"
    if made.shape[1] != like.shape[1]:
        return f"returned features of width {made.shape[1]} where training had {like.shape[1]}"
    return None


# ---------------------------------------------------------------------- numbers


def gram(made: Any, n: int, m: int) -> str | None:
    """Check a Gram block between n and m samples."""
    wrong = _floats(made, (n, m))
    if wrong is None and not _all_finite(made):
        wrong = "returned NaN or infinite numbers: are the features very large?"
    return wrong


def scaled(made: Any, shape: tuple[int, ...]) -> str | None:
    """Check scaled features: floats of the same shape."""
    return _floats(made, shape)


def scores(made: Any, n: int, layout: Layout | None = None, *, gaps: bool = False) -> str | None:
    """Check the scores of n samples.

    Parameters
    ----------
    made : object
        What came.
    n : int
        How many samples were asked for.
    layout : Layout, optional
        The one that they must have.
    gaps : bool
        Whether there may be NaN.
    """
    if not isinstance(made, Scores):
        return f"returned {described(made)}, not Scores"
    of: Any = made.layout
    if not isinstance(of, Layout):
        return f"returned scores whose layout is {described(of)}"
    if layout is not None and made.layout is not layout and made.layout != layout:
        return f"returned scores of layout {_layout(made.layout)}, not of {_layout(layout)}"
    if isinstance(made.values, np.ndarray) and made.values.ndim == 2:
        wrong = _rows(made.values, n)
        if wrong:
            return wrong
    wrong = _floats(made.values, (n, len(made.layout.columns)), "scores that are ")
    if wrong is None and not _all_finite(made.values):
        kept = np.isnan(made.values) if gaps else False
        if not np.all(np.isfinite(made.values) | kept):
            wrong = f"returned {'infinite' if gaps else 'NaN or infinite'} scores"
    return wrong


def folds(made: Any, n: int, n_folds: int) -> str | None:
    """Check the fold of each of n samples: -1 (never held out) to ``n_folds`` - 1."""
    if not isinstance(made, np.ndarray) or made.dtype.kind not in "iu":
        return f"returned {_array(made)}, not whole numbers, shape ({n},)"
    if made.shape != (n,):
        return f"returned an array of shape {made.shape}, not ({n},)"
    if n and (made.min() < -1 or made.max() >= n_folds):
        return f"returned folds {made.min()} to {made.max()}, not -1 to {n_folds - 1}"
    return None


def _floats(made: Any, shape: tuple[int, ...], what: str = "") -> str | None:
    if not isinstance(made, np.ndarray) or made.dtype.kind != "f":
        return f"returned {what}{_array(made)}, not an array of floats"
    if made.shape != shape:
        return f"returned {what}an array of shape {made.shape}, not {shape}"
    return None


def _all_finite(values: Any) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        # One sum costs less than looking at every number, and seldom overflows.
        return bool(np.isfinite(values.sum())) or bool(np.isfinite(values).all())


def _array(made: object) -> str:
    return f"an array of {made.dtype}" if isinstance(made, np.ndarray) else described(made)


def _layout(layout: Layout) -> str:
    return f"{getattr(layout, 'name', type(layout).__name__)} ({', '.join(layout.classes)})"


# ---------------------------------------------------------------------- space


def area_update(made: Any) -> str | None:
    """Check what ``Accumulator.update`` returns."""
    if made is None:
        return None
    if not isinstance(made, AreaUpdate):
        return f"returned {described(made)}, not an AreaUpdate or None"
    return _fields(
        "an AreaUpdate",
        ("area", made.area, _whole(made.area), "a whole number"),
        ("label", made.label, isinstance(made.label, str), "a text"),
        ("confidence", made.confidence, _number(made.confidence), "a finite number"),
        ("finished", made.finished, isinstance(made.finished, (bool, np.bool_)), "true or false"),
    )


def crossing(made: Any) -> str | None:
    """Check what ``Boundary.update`` returns."""
    if made is None:
        return None
    if not isinstance(made, Pose2D):
        return f"returned {described(made)}, not a Pose2D or None"
    return _fields("a Pose2D", *_pose(made))


def semantic_map(made: Any) -> str | None:
    """Check what ``Accumulator.semantic_map`` returns, and that its parts refer to one another."""
    if not isinstance(made, SemanticMap):
        return f"returned {described(made)}, not a SemanticMap"
    for name, kind in (("areas", Area), ("nodes", Node)):
        for each in getattr(made, name):
            if not isinstance(each, kind):
                return f"returned a map with {described(each)} among its {name}"
    areas, nodes = {area.id for area in made.areas}, {node.id for node in made.nodes}
    lost = next((node for node in made.nodes if node.area not in areas), None)
    if lost is not None:
        return f"returned a map whose node {lost.id} is in area {lost.area}, which it has not"
    loose = next((edge for edge in made.edges if not nodes.issuperset(edge)), None)
    return None if loose is None else f"returned a map with an edge {loose} between no two nodes"


# ---------------------------------------------------------------------- observations


def text(made: Any) -> str | None:
    """Check a name or a digest."""
    return None if isinstance(made, str) and made else f"is {_shown(made)}, not a text"


def count(made: Any) -> str | None:
    """Check how many observations a source says to have."""
    right = made is None or (_whole(made) and made >= 0)
    return None if right else f"returned {_shown(made)}, not a number of observations or None"


def metadata(made: Any) -> str | None:
    """Check the conditions of a recording: texts by name."""
    if not isinstance(made, Mapping):
        return f"is {described(made)}, not a mapping of texts"
    wrong = next(
        (k for k, v in made.items() if not (isinstance(k, str) and isinstance(v, str))), None
    )
    return None if wrong is None else f"holds {described(made[wrong])} under {wrong!r}, not a text"


def camera(made: Any) -> str | None:
    """Check the camera of a source."""
    if made is None or isinstance(made, PinholeCamera):
        return None
    return f"is {_shown(made)}, not a PinholeCamera or None"


def observation(made: Any) -> str | None:
    """Check what comes out of a source: an Observation with parts of the right types."""
    if not isinstance(made, Observation):
        return f"returned {described(made)}, not an Observation"
    wrong = _fields(
        "an Observation",
        ("stamp", made.stamp, _whole(made.stamp) and fits(made.stamp), "a whole number of ns"),
        ("label", made.label, _optional(made.label, str), "a text or None"),
        ("pose", made.pose, _optional(made.pose, Pose2D), "a Pose2D or None"),
        ("scan", made.scan, _optional(made.scan, LaserScan), "a LaserScan or None"),
    )
    if wrong is None and made.scan is not None:
        wrong = scan(made.scan)
    return wrong or image(made.image_source)


def image(made: Any) -> str | None:
    """Check an image that an observation is made with: an array of pixels, or what decodes one."""
    if made is None or callable(made):
        return None
    if not isinstance(made, np.ndarray):
        return f"returned an Observation whose image is {described(made)}, not an array"
    colours = made.shape[2:] == (3,)
    if made.dtype.kind != "u" or not (made.ndim == 2 or colours):
        text = f"returned an Observation whose image is of {made.dtype}, shape {made.shape}"
        return f"{text}, not of uint8, (H, W, 3) or (H, W)"
    return None


def stamp(made: Any) -> str | None:
    """Check a time in ns, which may be too large for 64 bits."""
    return None if _whole(made) else f"returned {_shown(made)}, not a whole number of ns"


def fits(stamp: int) -> bool:
    """Tell whether a stamp fits 64 bits, as arrays of stamps hold it."""
    return _STAMPS.min <= stamp <= _STAMPS.max


def scan(made: Any) -> str | None:
    """Check a laser scan: as many angles as ranges, both floats."""
    if not isinstance(made, LaserScan):
        return f"returned {described(made)}, not a LaserScan"
    for name in ("angles", "ranges"):
        values = getattr(made, name)
        if not isinstance(values, np.ndarray) or values.dtype.kind != "f" or values.ndim != 1:
            return f"returned a LaserScan whose {name} are {_array(values)}, not (n,) floats"
    if made.angles.shape != made.ranges.shape:
        return f"returned a LaserScan of {made.angles.size} angles and {made.ranges.size} ranges"
    return None


def pose(made: Any) -> str | None:
    """Check a pose; NaN is left to who uses it."""
    if not isinstance(made, Pose2D):
        return f"returned {described(made)}, not a Pose2D"
    numbers = ((name, getattr(made, name)) for name in ("x", "y", "theta"))
    return _fields("a Pose2D", *((n, v, isinstance(v, Real), "a number") for n, v in numbers))


def _pose(made: Pose2D) -> Sequence[tuple[str, Any, bool, str]]:
    numbers = ((name, getattr(made, name)) for name in ("x", "y", "theta"))
    return [(name, value, _number(value), "a finite number") for name, value in numbers]


def _fields(what: str, *fields: tuple[str, Any, bool, str]) -> str | None:
    """Return the first field that is not what it should be: (name, value, whether it is, what)."""
    for name, value, right, wanted in fields:
        if not right:
            return f"returned {what} whose {name} is {_shown(value)}, not {wanted}"
    return None


def _optional(value: object, kind: type) -> bool:
    return value is None or isinstance(value, kind)


def _whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


def _number(value: Any) -> bool:
    return isinstance(value, Real) and isfinite(value)


def _shown(value: object) -> str:
    return repr(value) if isinstance(value, (int, float, str)) else described(value)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
