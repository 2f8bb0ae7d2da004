"""Runs an experiment: records, extracts, trains, integrates, and keeps every result."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any, Protocol, TypeVar

from placecue.components.build import build
from placecue.components.registry import Registry
from placecue.errors import DataError, PlacecueError, UsageError
from placecue.evaluation.protocol.accumulating import accumulated
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.joining import fit_and_decide, result_of, scenes
from placecue.evaluation.protocol.methods import Methods
from placecue.evaluation.protocol.pairs import Part, Split, splits_of
from placecue.evaluation.protocol.plan import Plan
from placecue.evaluation.protocol.plan import Protocol as Fitting
from placecue.evaluation.protocol.preparing import (
    Contents,
    ExtractionTask,
    contents_of,
    extracted,
    recorded,
)
from placecue.evaluation.protocol.recordings import Recorded, derived
from placecue.evaluation.protocol.scores_store import ScoresStore
from placecue.evaluation.protocol.single_cue import SingleCueTask, train_and_score
from placecue.evaluation.results.about import Recording
from placecue.evaluation.results.areas import AreaStore
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.store import ResultStore

T = TypeVar("T")
log = logging.getLogger(__name__)


class Outcome(Protocol):
    """What came of a task: a value, or why there is none."""

    task: Any
    value: Any
    error: PlacecueError | None


class Runs(Protocol):
    """Runs tasks, several at a time."""

    def map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Iterator[Any]:
        """Yield the outcome of each task as it finishes."""


class Board(Protocol):
    """Is told how far a run is."""

    def step(self, name: str, done: int = 0, total: int = 0) -> None:
        """Say what comes before the pairs, and how far it is; the empty name: it is done."""

    def add(self, experiment: str, total: int, done: int = 0) -> None:
        """Put up an experiment; so many of its results are there already."""

    def done(self, experiment: str, failed: bool = False) -> None:
        """Note that a result is there, or will not be."""


@dataclass
class Evaluation:
    """An experiment, as it is run.

    Parameters
    ----------
    bench : Bench
        Its recordings know the metadata that their names and the experiment tell.
    pairs : object
        What picks pairs; see :func:`splits_of`.
    methods : Methods
    fitting : Protocol
        How models and integrators are fitted.
    derive : mapping
        What follows from metadata.
    registry : Registry

    Attributes
    ----------
    seconds : dict of str to float
        What each step took, in all processes together.
    wrong : list of Result
        Results that came to nothing, with why.
    """

    bench: Bench
    pairs: Any
    methods: Methods
    fitting: Fitting
    derive: Mapping[str, Any]
    registry: Registry
    seconds: dict[str, float] = field(default_factory=dict)
    wrong: list[Result] = field(default_factory=list)

    def run(self, executor: Runs, board: Board, tell: Callable[[Result], None]) -> Plan:
        """Plan, and compute what is not there yet; see :meth:`prepare` and :meth:`compute`."""
        self.prepare(executor, board)
        self.compute(executor, board, tell)
        return self.plan

    def prepare(self, executor: Runs, board: Board) -> Plan:
        """Make the recordings that are not there yet, and find out what there is to compute.

        Raises
        ------
        PlacecueError
            If the experiment makes no sense, or a recording cannot be made or read at all.
        """
        self.store = ResultStore(self.bench.folder)
        self.scores = ScoresStore(self.bench.folder, self.registry)
        self._record(executor, board)
        self.contents = contents = self._contents(board)
        self.recordings = {
            "/".join(filter(None, each.key)): Recording(
                each.log, contents[each.key].digest, dict(each.metadata), {}, dict(each.source)
            )
            for each in self.bench.recordings
        }
        splits = splits_of(self.pairs, self.bench.recordings, self.bench.scheme.n_folds)
        self.plan = Plan(
            self.bench,
            splits,
            self.methods,
            self.fitting,
            {key: each.digest for key, each in contents.items()},
            self.registry,
            self._wants_costs(),
        )
        self._check_whole_tests(splits)
        self.areas = [d for task in self.plan.areas_tasks() for d in task.digests.values()]
        self.digests = {
            (method, split.pair): self.plan.result_digest(split, method)
            for method in self.methods.names
            for split in splits
        }
        return self.plan

    def compute(self, executor: Runs, board: Board, tell: Callable[[Result], None]) -> None:
        """Compute what is not there yet.

        Parameters
        ----------
        executor : Executor
        board : Board
        tell : callable
            Is told of each result as it is kept.
        """
        self._announce(board)
        self._extract(executor, board)
        board.step("")
        self._tell_classes(self.plan.splits)
        told = _Told(self, board, tell)
        self._single_cues(executor, told)
        self._joined(executor, told)
        self._areas(executor)

    # ------------------------------------------------------------------ before pairs

    def _record(self, executor: Runs, board: Board) -> None:
        """Make the recordings that are not there yet."""
        to_make = [each for each in self.bench.recordings if each.origin is not None]
        if to_make:
            board.step("recordings made", 0, len(to_make))
        for number, outcome in enumerate(executor.map(recorded, to_make), start=1):
            board.step("recordings made", number, len(to_make))
            if outcome.error is not None:
                raise outcome.error
            self._spent("recording", outcome.value or 0.0)

    def _contents(self, board: Board) -> dict[tuple[str, str], Contents]:
        """Open every recording; set its metadata, and return what it is."""
        contents: dict[tuple[str, str], Contents] = {}
        known = []
        for number, each in enumerate(self.bench.recordings):
            board.step("recordings opened", number, len(self.bench.recordings))
            found = contents_of(each, self.bench.labels, self.bench.every)
            told = {**found.metadata, **each.metadata}
            known.append(replace(each, metadata=derived(told, self.derive)))
            _check_other(each, found, contents)
            contents[each.key] = found
        self.bench = replace(self.bench, recordings=tuple(known))
        return contents

    def _check_whole_tests(self, splits: Sequence[Split]) -> None:
        if self.bench.accumulators and any(split.test.fold is not None for split in splits):
            raise UsageError(
                "accumulators label whole recordings, and the pairs test on parts of one: give "
                "pairs of recordings, or accumulators=null"
            )

    def _wants_costs(self) -> bool:
        built = (
            build(each.integrator, "integrator", self.registry, each.name)
            for each in self.methods.joined.values()
        )
        return any(each.wants_costs for each in built)

    def _announce(self, board: Board) -> None:
        totals = Counter(pair.experiment for _, pair in self.digests)
        there = Counter(
            pair.experiment for (_, pair), digest in self.digests.items() if digest in self.store
        )
        for experiment, total in totals.items():
            board.add(experiment, total, there[experiment])

    # ------------------------------------------------------------------ the three stages

    def _extract(self, executor: Runs, board: Board) -> None:
        """Extract the cues of every recording into the cache; note what classes it has."""
        specs: dict[str, Mapping[str, Any]] = {}
        for model in self.methods.models.values():
            specs.setdefault(repr(sorted(model.cue.items())), model.cue)
        cues = tuple(specs.values())
        began = perf_counter()
        tasks = [ExtractionTask(self.bench, each, cues) for each in self.bench.recordings]
        board.step("recordings with their cues extracted", 0, len(tasks))
        for number, outcome in enumerate(executor.map(extracted, tasks), start=1):
            board.step("recordings with their cues extracted", number, len(tasks))
            each, classes = outcome.task.recording, outcome.value or {}
            if outcome.error is not None:
                log.warning(f"{each.name}: {outcome.error}")
            name = "/".join(filter(None, each.key))
            self.recordings[name] = replace(self.recordings[name], classes=classes)
        self._spent("extracting cues", perf_counter() - began)

    def _tell_classes(self, splits: Sequence[Split]) -> None:
        """Say which classes tests lack, and which of theirs no model was trained on."""
        lines: dict[str, None] = {}
        for split in splits:
            if split.test.fold is not None:
                continue  # parts of one recording
            trained = {c for part in split.train for c in self._classes(split.world, part)}
            tested = set(self._classes(split.world, split.test))
            if not trained or not tested:
                continue  # it could not be read, which is told
            train = " + ".join(map(str, split.train))
            if lacking := sorted(trained - tested):
                lines[f"{split.test} has no sample of {', '.join(lacking)}: recall left out"] = None
            if unknown := sorted(tested - trained):
                what = f"{split.test} has samples of {', '.join(unknown)}, which {train} has not"
                lines[f"{what}: models never say so, and they count as not recognised"] = None
        for line in lines:
            log.warning(line)

    def _classes(self, world: str, part: Part) -> Mapping[str, int]:
        return self.recordings["/".join(filter(None, (world, part.recording)))].classes

    def _single_cues(self, executor: Runs, told: _Told) -> None:
        began = perf_counter()
        lacking = []
        for task in self.plan.single_cue_tasks():
            if all(digest in self.scores for digest in task.digests.values()):
                told.of_scores(task, {})
            else:
                lacking.append(task)
        for outcome in executor.map(train_and_score, lacking):
            wrong = outcome.value or {}
            if outcome.error is not None:
                wrong = dict.fromkeys(outcome.task.digests, str(outcome.error))
            told.of_scores(outcome.task, wrong)
        self._spent("single-cue models", perf_counter() - began)

    def _joined(self, executor: Runs, told: _Told) -> None:
        began = perf_counter()
        lacking = {}
        for (method, pair), digest in self.digests.items():
            if method not in self.methods.joined:
                continue
            if digest in self.store and (not self.areas or digest in self.scores):
                told.kept(self.store.load(digest), fresh=False)
            elif (reason := told.why_not(method, pair)) is not None:
                told.failed(method, pair, reason)
            else:
                lacking[method, pair] = digest
        for outcome in executor.map(fit_and_decide, self.plan.joined_tasks(lacking)):
            task, wrong = outcome.task, outcome.value or {}
            if outcome.error is not None:
                wrong = dict.fromkeys(task.tests, str(outcome.error))
            for pair, (_, digest) in task.tests.items():
                if pair in wrong:
                    told.failed(task.method.name, pair, wrong[pair])
                else:
                    told.kept(self.store.load(digest))
        self._spent("integration", perf_counter() - began)

    def _areas(self, executor: Runs) -> None:
        """Label the areas of every test by every accumulator."""
        if not self.areas:
            return
        began, store = perf_counter(), AreaStore(self.bench.folder)
        failed = {(each.method, each.pair) for each in self.wrong}
        lacking = [
            replace(task, digests=missing)
            for task in self.plan.areas_tasks()
            if (task.method, task.pair) not in failed
            and (missing := {n: d for n, d in task.digests.items() if d not in store})
        ]
        for outcome in executor.map(accumulated, lacking):
            task, wrong = outcome.task, outcome.value or {}
            if outcome.error is not None:
                wrong = dict.fromkeys(task.digests, str(outcome.error))
            for name, why in wrong.items():
                log.warning(why)
                self.wrong.append(Result.failed(task.pair, f"{task.method}, {name}", why))
        self._spent("accumulation", perf_counter() - began)

    def _spent(self, step: str, seconds: float) -> None:
        self.seconds[step] = self.seconds.get(step, 0.0) + seconds


def _check_other(
    each: Recorded, found: Contents, others: Mapping[tuple[str, str], Contents]
) -> None:
    """Refuse a recording that is in the experiment already, under another name."""
    for (world, name), other in others.items():
        if world == each.world and other.digest == found.digest:
            raise UsageError(
                f"{name} and {each.name} are one recording, so that one would be tested on what it "
                "was trained on: leave one of them out"
            )


class _Told:
    """Turns what tasks say into results, and passes them on."""

    def __init__(self, run: Evaluation, board: Board, tell: Callable[[Result], None]) -> None:
        self.run, self.board, self.tell = run, board, tell
        #: Why a model says nothing of a test, by world, training part, model and test.
        self.silent: dict[tuple[str, str, str, str], str] = {}
        self.reasons: set[str] = set()

    def of_scores(self, task: SingleCueTask, wrong: Mapping[tuple[str, str], str]) -> None:
        """Make the results of a task's single-cue models."""
        train = " + ".join(map(str, task.train))
        for (name, test), why in wrong.items():
            self.silent[task.world, train, name, test] = why
        for split in self.run.plan.splits:
            if (split.world, split.train) != (task.world, task.train):
                continue
            for model in task.models:
                reason = wrong.get((model.name, str(split.test)))
                if reason is not None:
                    self.failed(model.name, split.pair, reason)
                else:
                    self._single(task, split, model.name)

    def _single(self, task: SingleCueTask, split: Split, model: str) -> None:
        digest = self.run.digests[model, split.pair]
        if digest in self.run.store:
            self.kept(self.run.store.load(digest), fresh=False)
            return
        said = self.run.scores.load(task.digests[model, str(split.test)])
        result = result_of(split.pair, model, said.scores, said.labels, said.stamps, digest)
        result = replace(
            result, groups=scenes(said.groups), seconds=said.seconds, settings=said.settings
        )
        self.run.store.save(result)
        self.kept(result)

    def why_not(self, method: str, pair: Pair) -> str | None:
        """Return why a joined method cannot say anything of a pair; None where it can."""
        train = " + ".join(pair.train)
        for model in self.run.methods.joined[method].models:
            for test in (pair.test, "held out"):
                reason = self.silent.get((pair.world, train, model, test))
                if reason is not None:
                    return reason
        return None

    def kept(self, result: Result, *, fresh: bool = True) -> None:
        """Pass on a result that is there, computed just now or in an earlier run."""
        if fresh:
            self.board.done(result.pair.experiment)
        self.tell(result)

    def failed(self, method: str, pair: Pair, reason: str) -> None:
        """Pass on that there is none."""
        reason = " ".join(reason.split())
        if reason not in self.reasons:  # it may be that of many pairs
            self.reasons.add(reason)
            log.warning(f"{method}, {pair}: {reason}")
        self.run.wrong.append(Result.failed(pair, method, reason))
        self.board.done(pair.experiment, failed=True)


def check_some(results: Sequence[Result], wrong: Sequence[Result]) -> None:
    """Raise DataError where nothing came of an experiment."""
    if not results:
        reason = wrong[0].error if wrong else "there are no pairs"
        raise DataError(f"none of {len(wrong)} results could be made: {reason}")
