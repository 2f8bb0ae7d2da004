"""Pictures and scans of mistakes, read again from the recordings that they are of."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from placecue.errors import FOREIGN, PlacecueError, UnusableObservation, told
from placecue.evaluation.report.mistakes import Mistake, Mistakes
from placecue.observation import Image, Observation

#: Width of a picture, pixels, and the quality of its JPEG.
WIDTH, QUALITY = 160, 62

OpenRecording = Callable[[str], Iterable[Observation]]
View = tuple[bytes, NDArray[np.float64] | None]


def with_views(
    mistakes: Mistakes, open_recording: OpenRecording, recordings: Mapping[str, str] | None = None
) -> Mistakes:
    """Return the mistakes with their pictures and scans.

    Recordings are read one after the other, each as far as the last mistake in it. One that
    cannot be read is told in the notes, and its mistakes stay without.

    Parameters
    ----------
    mistakes : Mistakes
        Without.
    open_recording : callable
        Takes the name of a recording, gives its observations.
    recordings : mapping of str to str, optional
        What a recording is to be opened as, by pair, where that is not its name in the pair.
    """
    named = recordings or {}
    wanted: dict[str, set[int]] = defaultdict(set)
    for each in mistakes.shown:
        wanted[named.get(each.pair, each.recording)].add(each.stamp)
    notes, views = list(mistakes.notes), {}
    for name, stamps in wanted.items():
        try:
            views[name] = _views(open_recording(name), stamps)
        except FOREIGN as error:
            reason = str(error) if isinstance(error, PlacecueError) else told(error)
            notes.append(f"No pictures and scans of {name}: {reason}")
    shown = [
        _with_view(each, views.get(named.get(each.pair, each.recording), {}))
        for each in mistakes.shown
    ]
    return replace(mistakes, shown=shown, notes=notes)


def view(observation: Observation) -> View:
    """Return the picture of an observation as a small JPEG, and the points of its scan."""
    try:
        image = observation.image
    except UnusableObservation:
        image = None
    scan = observation.scan
    return (
        b"" if image is None else encoded(image),
        None if scan is None else scan.points(),
    )


def encoded(image: Image) -> bytes:
    """Return an image as a small JPEG; empty where it cannot be one."""
    import cv2

    if image.dtype != np.uint8 or image.size == 0 or image.ndim not in (2, 3):
        return b""
    height = max(1, round(image.shape[0] * WIDTH / image.shape[1]))
    small = cv2.resize(image, (WIDTH, min(height, 2 * WIDTH)), interpolation=cv2.INTER_AREA)
    if small.ndim == 3:
        small = cv2.cvtColor(small, cv2.COLOR_RGB2BGR)
    done, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return data.tobytes() if done else b""


def _views(observations: Iterable[Observation], stamps: set[int]) -> dict[int, View]:
    found: dict[int, View] = {}
    for observation in observations:
        if observation.stamp in stamps:
            found[observation.stamp] = view(observation)
            if len(found) == len(stamps):
                break
    return found


def _with_view(mistake: Mistake, views: Mapping[int, View]) -> Mistake:
    image, scan = views.get(mistake.stamp, (b"", None))
    return replace(mistake, image=image, scan=scan)
