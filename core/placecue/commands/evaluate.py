"""``placecue evaluate``: an experiment -> results, tables, figures, a report."""

from __future__ import annotations

import fcntl
import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from time import perf_counter
from typing import Any

import numpy as np
from hydra import compose
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser

from placecue.atomic import made
from placecue.board import Board, shown_board
from placecue.checks import check_flag, check_whole
from placecue.commands import files, report, tables
from placecue.commands.features import cache_of
from placecue.commands.label_names import with_names
from placecue.commands.logs import on_error_of
from placecue.commands.paths import path_of
from placecue.commands.reporting import command_line
from placecue.components.build import build, plain
from placecue.components.manager import Plugins, current_plugins
from placecue.components.searches import opened
from placecue.errors import DataError, UsageError
from placecue.evaluation.executors.backends import executor_of
from placecue.evaluation.figures.spec import of_methods
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.edges import at_edges
from placecue.evaluation.protocol.evaluation import Evaluation, check_some
from placecue.evaluation.protocol.methods import Methods, methods_of, specs_of_words, split
from placecue.evaluation.protocol.plan import Protocol
from placecue.evaluation.protocol.recordings import Recorded, recordings_of
from placecue.evaluation.results import about as abouts
from placecue.evaluation.results.about import About, Method
from placecue.evaluation.results.areas import AreaStore
from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.store import ResultStore
from placecue.evaluation.writing import check_figures
from placecue.observation import PARTS, Part

WRITES = files.EVALUATED
#: A folder that holds this is an older run's, which is gone on with.
RESUMES = abouts.FILE

LOCK = ".evaluate.lock"

log = logging.getLogger("placecue")


def run(config: dict[str, Any]) -> None:
    """Evaluate, and write what came out."""
    began, out = perf_counter(), path_of(config, "out")
    check_flag("json", config.get("json", False))
    plugins, methods = current_plugins(), methods_in(config)
    bench = bench_of(config, out, methods, plugins)
    with _alone(out):
        about, results, wrong = evaluate(config, bench, methods, plugins)
        about = replace(about, seconds={**about.seconds, "all": perf_counter() - began})
        about.save(out)
        written = report.write(config, out, about, Results([*results, *wrong]))
    tables.written(written)
    plugins.tell("run_finished", command="evaluate", out=out)
    if config.get("json"):
        print(json.dumps({"out": str(out), **summary(about, results, wrong)}))
    if wrong:
        raise DataError(
            f"{len(wrong)} of {len(wrong) + len(results)} results could not be made, such as "
            f"{wrong[0].method} on {wrong[0].pair}: {wrong[0].error}; all others are in {out}"
        )


def evaluate(
    config: Mapping[str, Any], bench: Bench, methods: Methods, plugins: Plugins
) -> tuple[About, list[Result], list[Result]]:
    """Compute the results of an experiment that are not there yet.

    Returns
    -------
    About
        What was evaluated.
    list of Result
        All results, methods and pairs in the order of the experiment.
    list of Result
        Those that came to nothing.
    """
    began = datetime.now().astimezone().isoformat(timespec="seconds")
    run = Evaluation(
        bench,
        config["pairs"],
        methods,
        Protocol(config["partner"], config["chosen_on"], config["one_scale"], config["fitted_on"]),
        config["conditions"].get("derive") or {},
        plugins.registry,
    )
    results: dict[tuple[str, Any], Result] = {}

    def tell(result: Result) -> None:
        results[result.method, result.pair] = result
        plugins.tell("pair_evaluated", result=result)

    if not (bench.folder / abouts.FILE).exists():  # what stands there may be an older run's
        About(_title(config, methods), {}, _told(methods), {}, began=began).save(bench.folder)
    warnings = _Warnings()
    board = Board()
    with warnings.kept(), shown_board(board), executor_of(config) as executor:
        run.prepare(executor, board)
        about = _about(config, run, plugins, began)
        check_figures(about)
        if config.get("overwrite"):
            _forget(bench.folder)
        about.save(bench.folder)  # so that what is there can be reported on at any moment
        run.compute(executor, board, tell)
    ordered = [results[key] for key in run.digests if key in results]
    check_some(ordered, run.wrong)
    about = replace(
        about,
        recordings=run.recordings,
        seconds=run.seconds,
        warnings=[*warnings.lines, *at_edges(methods.models, ordered)],
        failures=[
            {"method": each.method, "pair": list(each.pair), "error": each.error}
            for each in run.wrong
        ],
    )
    return about, ordered, run.wrong


def _about(config: Mapping[str, Any], run: Evaluation, plugins: Plugins, began: str) -> About:
    """Return what is known of an evaluation before anything is computed."""
    return About(
        title=_title(config, run.methods),
        recordings=run.recordings,
        methods=_told(run.methods),
        experiments=_counts(run),
        digests=list(run.digests.values()),
        areas=run.areas,
        figures=_drawn(config, "figures", run.methods),
        tables=_drawn(config, "tables", run.methods),
        paper=config["paper"] or {},
        versions=versions(plugins),
        command=command_line(),
        began=began,
    )


def _drawn(config: Mapping[str, Any], key: str, methods: Methods) -> Sequence[Mapping[str, Any]]:
    """Return what the experiment draws; of some methods only where ``only`` picks them."""
    asked = config[key] or []
    if not isinstance(asked, list) or not all(isinstance(each, Mapping) for each in asked):
        raise UsageError(f"{key} must list mappings, [{{name: F, kind: bars}}], got {asked!r}")
    return of_methods(asked, methods.names) if config["only"] else asked


def _title(config: Mapping[str, Any], methods: Methods) -> str:
    return str(config["title"] or f"{len(methods.names)} methods")


def bench_of(config: Mapping[str, Any], out: Path, methods: Methods, plugins: Plugins) -> Bench:
    """Return what every task of an experiment reads.

    Raises
    ------
    UsageError
        If there are no recordings, or a word makes no sense.
    """
    check_whole("every", config["every"], least=1)
    folder, _ = cache_of(config)
    named = with_names(config)
    accumulators = accumulators_in(config)
    poses = bool(config.get("rooms") or accumulators)
    needed = parts_needed(methods, plugins, poses=poses, scans=bool(accumulators))
    return Bench(
        str(out.absolute()),
        str((folder if folder is not None else out / "cache").absolute()),
        tuple(_reading(each, needed) for each in recordings_of(config)),
        config["every"],
        config["folds"],
        {key: named.get(key) for key in ("rooms", "label_map", "unmapped_labels")},
        on_error_of(config) == "skip",
        accumulators,
    )


def parts_needed(
    methods: Methods, plugins: Plugins, *, poses: bool, scans: bool = False
) -> list[Part]:
    """Return the parts of an observation that any of the cues needs, labels, and what is asked."""
    needed = {"label", *(("pose",) if poses else ()), *(("scan",) if scans else ())}
    for model in methods.models.values():
        needed |= set(build(model.cue, "cue", plugins.registry, model.name).requires)
    return [part for part in PARTS if part in needed]


def _reading(recorded: Recorded, parts: Sequence[Part]) -> Recorded:
    """Return a recording of which a source that lets one choose reads the given parts only."""
    source = dict(recorded.source)
    if recorded.origin is not None or ("parts" in source and source["parts"] is None):
        source["parts"] = list(parts)
    return replace(recorded, source=source)


def methods_in(config: Mapping[str, Any]) -> Methods:
    """Return the methods that a config names, or its cues and integrators."""
    models, methods = config["models"], config["methods"]
    if models is None:
        words = list(HydraConfig.get().overrides.task)
        integrators = options_in(words, "integrator") or ["svm_das"]
        models, methods = specs_of_words(
            options_in(words, "cue") or list(config["cues"]),
            [name for name in integrators if name != "none"],
            words,
        )
    found, only = methods_of(models, methods, composed), config.get("only")
    if not only:
        return found
    return found.only([str(each) for each in (only if isinstance(only, list) else [only])])


def accumulators_in(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the configs of the accumulators that a config names, by name.

    Raises
    ------
    UsageError
        If they are neither named in a list nor words by name.
    """
    given = config.get("accumulators") or {}
    if isinstance(given, list):
        given = {str(each): f"accumulator={each}" for each in given}
    if not isinstance(given, Mapping):
        raise UsageError(
            "accumulators must be a list such as [spatiotemporal,hmm], or a mapping of names to "
            f"words after placecue label, got {given!r}"
        )
    return {
        name: plain(compose("label", opened(split(str(words), name)))["accumulator"])
        for name, words in given.items()
    }


def composed(words: Sequence[str]) -> Mapping[str, Any]:
    """Return the config of ``placecue train`` for some words, without what is around a run."""
    config = compose("train", opened(words))
    return {key: plain(config[key]) for key in ("cues", "integrator")}


def options_in(words: Sequence[str], group: str) -> list[str]:
    """Return the options of a group that words choose, ``group=a`` or ``group=[a,b]``."""
    parser, found = OverridesParser.create(), list[str]()
    for override in parser.parse_overrides(list(words)):
        if override.key_or_group == group and override.package is None:
            value = override.value()
            found = [str(each) for each in (value if isinstance(value, list) else [value])]
    return found


def _told(methods: Methods) -> dict[str, Method]:
    singles = {n: Method([n], "", each.words) for n, each in methods.models.items()}
    joined = {
        n: Method(list(each.models), each.words, each.words) for n, each in methods.joined.items()
    }
    return {**singles, **joined}


def _counts(run: Evaluation) -> dict[str, int]:
    experiments = [pair.experiment for pair in run.plan.pairs]
    return {name: experiments.count(name) for name in dict.fromkeys(experiments)}


def versions(plugins: Plugins) -> dict[str, str]:
    """Return the versions of what decides results."""
    packages = ("placecue", "numpy", "scipy", "scikit-learn", "opencv-contrib-python-headless")
    found = {name: version(name) for name in packages}
    found |= {each.distribution: each.version for each in plugins.registry}
    return {"python": python_version(), **found}


class _Warnings(logging.Handler):
    """Keeps what is told meanwhile, each line once."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        line = record.getMessage()
        if line not in self.lines:
            self.lines.append(line)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Listen in a ``with`` block."""
        log.addHandler(self)
        try:
            yield
        finally:
            log.removeHandler(self)


@contextmanager
def _alone(out: Path) -> Iterator[None]:
    """Let no other run write into a folder at the same time.

    Raises
    ------
    UsageError
        If one does already.
    """
    made(out)
    with (out / LOCK).open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UsageError(
                f"another run is writing into out={out}: wait for it, or give another out="
            ) from error
        except OSError:
            pass  # a file system without locks
        yield


def _forget(out: Path) -> None:
    """Remove what an older run has computed, for it to be computed anew."""
    for folder in (ResultStore(out).folder, out / "scores", AreaStore(out).folder):
        for path in (*folder.glob("*.npz"), *folder.glob("*.json")):
            path.unlink(missing_ok=True)


def summary(about: About, results: Sequence[Result], wrong: Sequence[Result]) -> dict[str, Any]:
    """Return what came out as plain data: mean balanced accuracy by method and experiment."""
    found = Results(results)
    return {
        "title": about.title,
        "results": len(results),
        "failed": len(wrong),
        "balanced_accuracy": {
            method: {
                experiment: float(np.mean(list(scores.values())))
                for experiment in found.experiments
                if (scores := found.scores(method, experiment))
            }
            for method in found.methods
        },
        "seconds": dict(about.seconds),
    }
