"""Results in a folder, a file each, from which tables and figures are made without computing.

``FOLDER/results/DIGEST.npz`` is the result with that digest. Files are written whole, so that a
killed run leaves what is finished, and hold arrays and JSON only.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.evaluation.results.result import Pair, Result
from placecue.storage.arrays import read_arrays, write_arrays

FOLDER = "results"
#: Of the files; results of another are refused.
FORMAT = 1


class ResultStore:
    """The results in a folder.

    Parameters
    ----------
    folder : Path
        That of the run; results are in ``results`` in it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder / FOLDER

    def path(self, digest: str) -> Path:
        """Return the file of a result."""
        return self.folder / f"{digest}.npz"

    def __contains__(self, digest: str) -> bool:
        return self.path(digest).is_file()

    def save(self, result: Result) -> None:
        """Keep a result under its digest."""
        about = {
            "format": FORMAT,
            "pair": list(result.pair),
            "method": result.method,
            "classes": list(result.classes),
            "seconds": dict(result.seconds),
            "settings": dict(result.settings),
            "error": result.error,
            "used": list(result.used),
        }
        arrays: dict[str, NDArray[Any]] = {
            "about": np.frombuffer(json.dumps(about).encode(), np.uint8),
            "truth": result.truth,
            "decided": result.decided,
            "confidence": result.confidence,
            "stamps": result.stamps,
            "groups": result.groups,
            "used": np.array(list(result.used.values()), dtype=bool).reshape(-1, len(result)),
        }
        write_arrays(self.path(result.digest), arrays)

    def load(self, digest: str) -> Result:
        """Return the result with a digest.

        Raises
        ------
        DataError
            If it is damaged, or of another version.
        """
        path = self.path(digest)
        arrays = read_arrays(path)
        try:
            about = json.loads(arrays["about"].tobytes())
            if about["format"] != FORMAT:
                raise DataError(
                    f"{path} is a result of format {about['format']}, this placecue reads "
                    f"{FORMAT}: give another out=, or evaluate anew with overwrite=true"
                )
            experiment, world, train, test = about["pair"]
            return Result(
                Pair(experiment, world, tuple(train), test),
                about["method"],
                tuple(about["classes"]),
                arrays["truth"],
                arrays["decided"],
                arrays["confidence"],
                arrays["stamps"],
                arrays["groups"],
                dict(zip(about["used"], arrays["used"], strict=True)),
                about["seconds"],
                about["settings"],
                about["error"],
                digest,
            )
        except (ValueError, LookupError, TypeError) as error:
            raise DataError(f"{path} is no result ({error}): remove it, and evaluate again") from (
                error
            )

    def __iter__(self) -> Iterator[Result]:
        """Yield every result there is, in the order of their digests."""
        for path in sorted(self.folder.glob("*.npz")):
            yield self.load(path.stem)
