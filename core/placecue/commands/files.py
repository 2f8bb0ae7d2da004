"""The files that commands write into a folder, and how an older run's are known."""

from __future__ import annotations

import json
from pathlib import Path

from placecue.evaluation.report.page import REPORT
from placecue.evaluation.training_report import INTEGRATOR, RELIABILITY, SEARCHES
from placecue.logs.writing.annotated import LAYOUT
from placecue.logs.writing.rerun_log import RECORDING
from placecue.storage import map_files
from placecue.storage.belief_table import COLUMNS
from placecue.storage.manifest import ARRAYS, CONFIG, FORMAT, MANIFEST, STATE
from placecue.storage.scene_graph import SCENE_GRAPH

BELIEFS, BELIEFS_LOG, SCORES = "beliefs.csv", "beliefs.mcap", "metrics.json"
ANNOTATED = "annotated.mcap"
SUGGESTIONS = "suggestions.csv"
MAP, GEOJSON = "semantic_map.json", "semantic_map.geojson"
PICTURE, DRAWING, FILM = "semantic_map.png", "semantic_map.svg", "film.png"
TRAJECTORY = "trajectory.tum"
MODEL, LOGS = "model", ("run1.mcap", "run2.mcap")

EVALUATED = ("experiment.json", "results.csv", REPORT)
TRAINED = (MANIFEST, CONFIG, STATE, ARRAYS, RELIABILITY, REPORT)
CLASSIFIED = (BELIEFS, BELIEFS_LOG, SCORES, REPORT, TRAJECTORY)
SUGGESTED = (SUGGESTIONS, REPORT)
FOR_NAV2 = (map_files.ROUTE_GRAPH, map_files.PICTURE, map_files.ABOUT, map_files.NODES)
MAP_FILES = (MAP, GEOJSON, PICTURE, DRAWING, *FOR_NAV2)
#: Written only where they are asked for.
ON_REQUEST = (FILM, SCENE_GRAPH, RECORDING, TRAJECTORY)
LABELLED = (BELIEFS, ANNOTATED, SCORES, LAYOUT, REPORT, *MAP_FILES)
DEMONSTRATED = (*LABELLED, *LOGS, *(f"{MODEL}/{name}" for name in TRAINED))


def of_older_run(folder: Path) -> list[Path]:
    """Return the files that an older run of placecue has left in a folder, those of logs apart.

    A model is known by its manifest, beliefs by the columns of their table; files beside neither
    may be anybody's. The two logs of a demo stay, as others may have been made of them.
    """
    names: set[str] = set()
    if (cues := _cues_of_model(folder / MANIFEST)) is not None:
        searches = [f"{SEARCHES}/{name}" for name in (*cues, INTEGRATOR)]
        names.update(TRAINED, *((f"{name}.md", f"{name}.png") for name in searches))
    if _is_belief_table(folder / BELIEFS):
        names.update(CLASSIFIED, LABELLED, ON_REQUEST)
    return sorted(path for name in names if (path := folder / name).is_file())


def _cues_of_model(manifest: Path) -> list[str] | None:
    """Return the names of a model's cues; None where there is no model."""
    try:
        told = json.loads(manifest.read_text(encoding="utf-8"))
        cues = list(told["pipeline"]["cues"]) if told["format"] == FORMAT else None
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return None
    return None if cues is None else [name for name in map(str, cues) if Path(name).name == name]


def _is_belief_table(table: Path) -> bool:
    begin = ",".join(COLUMNS).encode()
    try:
        with table.open("rb") as file:
            return file.read(len(begin)) == begin
    except OSError:
        return False
