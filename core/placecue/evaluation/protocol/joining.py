"""A task: fit an integrator on what single-cue models say, and let it decide on tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.errors import DataError, PlacecueError
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.counted import CountedEvidence
from placecue.evaluation.protocol.methods import Joined
from placecue.evaluation.protocol.scores_store import Said, ScoresStore
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.store import ResultStore
from placecue.evidence import StoredEvidence
from placecue.folds import FoldScheme
from placecue.held_out import HeldOut
from placecue.integrator import Integrator
from placecue.schemes import Schemes
from placecue.scores import Scores

#: Digests of what each single-cue model says, by the model's name.
OfModels = Mapping[str, str]


@dataclass(frozen=True)
class JoinedTask:
    """One method, for the models of one training part.

    Parameters
    ----------
    bench : Bench
    method : Joined
    fitted_on : tuple of mapping of str to str
        What the integrator is fitted on: by model the digests of scores, of every part.
    of_partner : bool
        Whether these are of models of another recording, whose outputs are brought to one scale.
    tests : mapping of Pair to (mapping of str to str, str)
        What each pair is decided on, and the digest of its result.
    """

    bench: Bench
    method: Joined
    fitted_on: tuple[OfModels, ...]
    of_partner: bool
    tests: Mapping[Pair, tuple[OfModels, str]]

    def __str__(self) -> str:
        pair = next(iter(self.tests))
        where = f"{pair.world}: " if pair.world else ""
        return f"{where}{self.method.name} on {' + '.join(pair.train)}"


def fit_and_decide(task: JoinedTask) -> dict[Pair, str]:
    """Fit the integrator of a task and keep its results.

    Returns
    -------
    dict of Pair to str
        Why a pair has no result; empty where all went well.
    """
    registry = current_plugins().registry
    store = ScoresStore(task.bench.folder, registry)
    results = ResultStore(task.bench.folder)
    integrator: Integrator = build(task.method.integrator, "integrator", registry, task.method.name)
    models = task.method.models
    tested, wrong = _tested(task, store)
    began = perf_counter()
    try:
        fitting = _held_out(
            [_loaded(store, each, models, task.of_partner) for each in task.fitted_on],
            task.bench.scheme,
        )
        whole = all(each.evidence.known().all() for each in tested.values())
        schemes = Schemes.fit(integrator, replace(fitting, whole=bool(whole)))
    except PlacecueError as error:
        return dict.fromkeys(task.tests, f"{task.method.name}: {error}")
    seconds = perf_counter() - began
    for pair, joined in tested.items():
        try:
            results.save(_decided(task, pair, schemes, joined, seconds))
        except PlacecueError as error:
            wrong[pair] = f"{task.method.name} on {pair.test}: {error}"
    return wrong


def _tested(task: JoinedTask, store: ScoresStore) -> tuple[dict[Pair, Aligned], dict[Pair, str]]:
    """Return what the models say of each test, and why that of some is not there."""
    found: dict[Pair, Aligned] = {}
    wrong = {}
    for pair, (digests, _) in task.tests.items():
        try:
            found[pair] = align(_loaded(store, digests, task.method.models, task.of_partner))
        except PlacecueError as error:
            wrong[pair] = f"{task.method.name} on {pair.test}: {error}"
    return found, wrong


def _loaded(
    store: ScoresStore, digests: OfModels, models: Sequence[str], one_scale: bool
) -> dict[str, Said]:
    lacking = [model for model in models if digests[model] not in store]
    if lacking:
        raise DataError(f"model {lacking[0]} says nothing of a recording that is needed")
    loaded = {model: store.load(digests[model]) for model in models}
    return {m: said.of_one_scale() if one_scale else said for m, said in loaded.items()}


def _decided(
    task: JoinedTask, pair: Pair, schemes: Schemes, joined: Aligned, seconds: float
) -> Result:
    _, digest = task.tests[pair]
    evidence = CountedEvidence(joined.evidence)
    began = perf_counter()
    scores, _ = schemes.integrate(evidence, skip=task.bench.skip)
    if task.bench.accumulators:
        told = Said(scores, joined.labels, joined.stamps, joined.positions, joined.groups)
        ScoresStore(task.bench.folder, current_plugins().registry).save(digest, told)
    result = result_of(pair, task.method.name, scores, joined.labels, joined.stamps, digest)
    return replace(
        result,
        groups=scenes(joined.groups),
        used=evidence.asked,
        seconds={"fitting": seconds, "deciding": perf_counter() - began},
        settings={"integrator": words} if (words := schemes.full.summary()) else {},
    )


@dataclass(frozen=True)
class Aligned:
    """What several models say of the same n samples, as far as each has them."""

    evidence: StoredEvidence
    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]
    groups: NDArray[np.int64] | None
    costs: Mapping[str, float]
    positions: NDArray[np.int64]


def align(said: Mapping[str, Said]) -> Aligned:
    """Return what several models say, sample by sample; NaN where one lacks the sample.

    Raises
    ------
    DataError
        If they disagree on the class of a sample.
    """
    every = np.unique(np.concatenate([each.positions for each in said.values()]))
    n, scores = len(every), {}
    widest = max(each.labels.dtype.itemsize // 4 for each in said.values())
    labels, stamps = np.full(n, "", f"U{max(1, widest)}"), np.zeros(n, np.int64)
    groups: NDArray[np.int64] | None = None
    for model, each in said.items():
        rows = np.searchsorted(every, each.positions)
        known = labels[rows] != ""
        if (labels[rows][known] != each.labels[known]).any():
            raise DataError(f"model {model} has other labels than the other models")
        labels[rows], stamps[rows] = each.labels, each.stamps
        scores[model] = each.scores.spread(rows, n)
        if each.groups is not None:
            if groups is None:
                groups = np.zeros((n, *each.groups.shape[1:]), np.int64)
            groups[rows] = each.groups
    costs = {model: each.cost for model, each in said.items()}
    return Aligned(StoredEvidence(scores), labels, stamps, groups, costs, every)


def _held_out(parts: Sequence[Mapping[str, Said]], folds: FoldScheme) -> HeldOut:
    """Return what an integrator is fitted on: what models say of several parts, one after another.

    Folds keep what is of one part together with what stands beside it there.
    """
    aligned = [align(part) for part in parts]
    evidence = _concatenated([each.evidence for each in aligned])
    labels = np.concatenate([each.labels for each in aligned])
    stamps = np.concatenate([each.stamps for each in aligned])
    if len(aligned) == 1:
        groups = aligned[0].groups
    else:
        groups = np.repeat(np.arange(len(aligned)), [len(each.labels) for each in aligned])
    costs = aligned[0].costs
    known = not any(np.isnan(list(costs.values())))
    held_out = HeldOut(
        evidence, labels, stamps, groups, folds, part=True, costs=costs if known else None
    )
    there = np.flatnonzero(evidence.known().any(axis=1))
    classes = evidence.layout(evidence.cues[0]).classes
    return held_out.take(there).parted(classes)[0]


def _concatenated(parts: Sequence[StoredEvidence]) -> StoredEvidence:
    from placecue.evidence import concatenate

    return parts[0] if len(parts) == 1 else concatenate(parts)


def result_of(
    pair: Pair,
    method: str,
    scores: Scores,
    labels: NDArray[np.str_],
    stamps: NDArray[np.int64],
    digest: str,
) -> Result:
    """Return the result of n samples with their scores, shape (n, V)."""
    there = np.flatnonzero(scores.available())
    classes = tuple(sorted({*scores.layout.classes, *labels.tolist()}))
    number = {name: at for at, name in enumerate(classes)}
    decided = np.full(len(labels), -1, dtype=np.int16)
    confidence = np.full(len(labels), np.nan, dtype=np.float32)
    if there.size:
        decision = scores[there].decide()
        decided[there] = [number[str(name)] for name in decision.labels]
        confidence[there] = decision.confidence
    truth = np.array([number[name] for name in labels.tolist()], dtype=np.int16)
    return Result(
        pair, method, classes, truth, decided, confidence, np.asarray(stamps), digest=digest
    )


def scenes(groups: NDArray[np.int64] | None) -> NDArray[np.int64]:
    """Return the scene of each sample, or else its log; empty where neither is known."""
    if groups is None:
        return np.empty(0, dtype=np.int64)
    return np.asarray(groups if groups.ndim < 2 else groups[:, -1], dtype=np.int64)
