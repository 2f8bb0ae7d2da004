"""What maps are worth that accumulators make of what methods say, kept in the folder of a run."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import mean

from placecue.atomic import made, write_json, write_text
from placecue.errors import DataError
from placecue.evaluation.area_scores import AreaScores
from placecue.evaluation.results.result import Pair
from placecue.evaluation.results.table import Cell, Table

FOLDER, FILE = "areas", "areas.csv"


@dataclass(frozen=True)
class AreaResult:
    """What one accumulator makes of what one method says of a test recording.

    Parameters
    ----------
    pair : Pair
    method, accumulator : str
        Their names in the experiment.
    scores : AreaScores
    """

    pair: Pair
    method: str
    accumulator: str
    scores: AreaScores


class AreaStore:
    """The area results in a folder, a file of JSON each.

    Parameters
    ----------
    folder : Path
        That of the run; they are in ``areas`` in it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder / FOLDER

    def path(self, digest: str) -> Path:
        """Return the file of a result."""
        return self.folder / f"{digest}.json"

    def __contains__(self, digest: str) -> bool:
        return self.path(digest).is_file()

    def save(self, digest: str, result: AreaResult) -> None:
        """Keep a result under its digest."""
        made(self.folder)
        write_json(self.path(digest), asdict(result) | {"pair": list(result.pair)})

    def load(self, digest: str) -> AreaResult:
        """Return the result with a digest.

        Raises
        ------
        DataError
            If it is damaged.
        """
        path = self.path(digest)
        try:
            told = json.loads(path.read_text(encoding="utf-8"))
            experiment, world, train, test = told.pop("pair")
            pair = Pair(experiment, world, tuple(train), test)
            return AreaResult(pair, scores=AreaScores(**told.pop("scores")), **told)
        except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
            raise DataError(f"{path} is no result ({error}): remove it, and evaluate again") from (
                error
            )

    def of(self, digests: Iterable[str]) -> list[AreaResult]:
        """Return those of some results that are there, in their order."""
        return [self.load(digest) for digest in digests if digest in self]

    def take_over(self, folders: Sequence[Path]) -> None:
        """Copy the results of other folders."""
        for path in [path for each in folders for path in AreaStore(each).folder.glob("*.json")]:
            made(self.folder)
            shutil.copyfile(path, self.folder / path.name)


def areas_table(results: Sequence[AreaResult]) -> Table:
    """Return a row an experiment, method and accumulator: means over pairs."""
    groups: dict[tuple[str, str, str], list[AreaScores]] = {}
    for each in results:
        key = each.pair.experiment, each.method, each.accumulator
        groups.setdefault(key, []).append(each.scores)
    columns = ["experiment", "method", "accumulator", "single (%)", "way (%)", "unknown (%)"]
    columns += ["nodes (%)", "areas right (%)", "of more than 10 observations (%)"]
    columns += ["free space (%)", "delay (s)", "never right (%)", "pairs"]
    return Table(columns, [[*key, *_means(found)] for key, found in groups.items()], digits=1)


def write_areas(results: Sequence[AreaResult], folder: Path) -> Path:
    """Write :func:`areas_table` into ``areas.csv`` of a folder."""
    return write_text(folder / FILE, areas_table(results).csv())


def _means(found: Sequence[AreaScores]) -> list[Cell]:
    areas, large = sum(each.areas for each in found), sum(each.large for each in found)
    free = [each.free for each in found if each.free is not None]
    delay = [each.delay for each in found if each.delay is not None]
    return [
        100 * mean(each.single for each in found),
        100 * mean(each.way for each in found),
        100 * mean(each.unknown for each in found),
        100 * mean(each.nodes for each in found),
        100 * sum(each.right for each in found) / areas if areas else None,
        100 * sum(each.large_right for each in found) / large if large else None,
        100 * mean(free) if free else None,
        mean(delay) if delay else None,
        100 * mean(each.never for each in found),
        len(found),
    ]
