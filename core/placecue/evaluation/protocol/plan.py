"""What there is to compute, found by digests: what is there already is not computed again."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from placecue import __version__
from placecue.components.pipelines import components_in
from placecue.components.registry import Registry
from placecue.errors import UsageError
from placecue.evaluation.protocol.accumulating import AreasTask
from placecue.evaluation.protocol.bench import Bench, digest_of
from placecue.evaluation.protocol.joining import JoinedTask
from placecue.evaluation.protocol.methods import Methods, SingleCue
from placecue.evaluation.protocol.pairs import Part, Split, partner_of
from placecue.evaluation.protocol.recordings import check_names
from placecue.evaluation.protocol.single_cue import HELD_OUT, SingleCueTask
from placecue.evaluation.results.result import Pair

Trained = tuple[str, tuple[Part, ...]]


@dataclass(frozen=True)
class Protocol:
    """How models and integrators are fitted.

    Parameters
    ----------
    partner : mapping or None
        The rule that gives each training recording a partner: an integrator is fitted on what the
        models of one say of all their tests, and used with those of the other. None: it is fitted
        on out-of-fold scores of the training samples.
    chosen_on : mapping or None
        The rule that gives each training recording another, on which parameters of its
        classifiers are chosen. None: by folds of the training samples.
    one_scale : bool
        Whether outputs of partners' models are brought to one scale.
    fitted_on : sequence of str or None
        Recordings on which integrators are fitted, on what the very models say of them that they
        are used with.
    """

    partner: Mapping[str, Any] | None = None
    chosen_on: Mapping[str, Any] | None = None
    one_scale: bool = True
    fitted_on: Sequence[str] | None = None

    def __post_init__(self) -> None:
        if self.partner and self.fitted_on:
            raise UsageError("give partner= or fitted_on=, not both: integrators are fitted once")


class Plan:
    """The tasks of an experiment.

    Parameters
    ----------
    bench : Bench
    splits : sequence of Split
    methods : Methods
    protocol : Protocol
    digests : mapping of (str, str) to str
        The content of each recording, by world and name.
    registry : Registry
        Tells the versions of components.
    wants_costs : collection of str
        The joined methods whose integrator wants to know what cues cost.
    """

    def __init__(
        self,
        bench: Bench,
        splits: Sequence[Split],
        methods: Methods,
        protocol: Protocol,
        digests: Mapping[tuple[str, str], str],
        registry: Registry,
        wants_costs: bool = False,
    ) -> None:
        self.bench, self.splits, self.methods, self.protocol = bench, splits, methods, protocol
        self.contents, self.registry, self.wants_costs = digests, registry, wants_costs
        self.pairs = [split.pair for split in splits]
        self._versions: dict[str, list[Any]] = {}
        #: Digests of models, which those of all that they say and of all that joins them hold.
        self._of_models: dict[tuple[Trained, str], str] = {}
        self._of_scores: dict[tuple[Trained, str, Part | str], str] = {}

    @cached_property
    def tests(self) -> dict[Trained, list[Part]]:
        """What the models of each training part are tested on, each part once."""
        found: dict[Trained, dict[Part, None]] = {}
        for split in self.splits:
            found.setdefault((split.world, split.train), {})[split.test] = None
        return {trained: list(tests) for trained, tests in found.items()}

    # ------------------------------------------------------------------ digests

    def part_digest(self, world: str, part: Part) -> str:
        """Return the digest of the samples of a part."""
        folds = () if part.fold is None else (self.bench.folds, part.fold, part.held_out)
        return digest_of(self.contents[world, part.recording], folds)

    def model_digest(self, trained: Trained, model: SingleCue) -> str:
        """Return the digest of all that decides a single-cue model."""
        if (trained, model.name) not in self._of_models:
            world, parts = trained
            chosen_on = self.chosen_on(trained)
            self._of_models[trained, model.name] = digest_of(
                __version__,
                [self.part_digest(world, part) for part in parts],
                None if chosen_on is None else self.part_digest(world, chosen_on),
                [model.cue, model.classifier, self._of_spec(model.cue, "cue")],
                self._of_spec(model.classifier, "classifier"),
                [self.bench.folds, self.bench.skip],
            )
        return self._of_models[trained, model.name]

    def scores_digest(self, trained: Trained, model: str, test: Part | str) -> str:
        """Return the digest of what a model says of a part, or of its held-out samples."""
        if (trained, model, test) not in self._of_scores:
            of_test = test if isinstance(test, str) else self.part_digest(trained[0], test)
            of_model = self.model_digest(trained, self.methods.models[model])
            # What cues cost is measured beside them where it is wanted.
            self._of_scores[trained, model, test] = digest_of(of_model, of_test, self.wants_costs)
        return self._of_scores[trained, model, test]

    def result_digest(self, split: Split, method: str) -> str:
        """Return the digest of all that decides the result of a pair."""
        trained, name = (split.world, split.train), list(split.pair)
        if method in self.methods.models:
            return digest_of(name, method, self.scores_digest(trained, method, split.test))
        joined = self.methods.joined[method]
        return digest_of(
            [name, method, joined.integrator, self._of_spec(joined.integrator, "integrator")],
            [[model, self.scores_digest(trained, model, split.test)] for model in joined.models],
            [dict(each) for each in self.fitted_on(trained, joined.models)[0]],
            [self.bench.folds, self.protocol.one_scale],
        )

    def _of_spec(self, spec: Mapping[str, Any], kind: Any) -> list[Any]:
        """Return the versions of a component and of all inside it."""
        key = digest_of(kind, spec)
        if key not in self._versions:
            found = components_in(dict(spec), kind, self.registry)
            self._versions[key] = [
                [kind_, name, str(getattr(self.registry.load(kind_, name), "version", ""))]
                for kind_, name in found
            ]
        return self._versions[key]

    def _version(self, accumulator: Mapping[str, Any]) -> str:
        found = self.registry.load("accumulator", str(accumulator["plugin"]))
        return str(getattr(found, "version", ""))

    # ------------------------------------------------------------------ who goes with whom

    def chosen_on(self, trained: Trained) -> Part | None:
        """Return the recording on which parameters are chosen; None for folds."""
        tested = {part.recording for part in self.tests.get(trained, ())}
        return self._by_rule(self.protocol.chosen_on, trained, "chosen_on", tested)

    def partner(self, trained: Trained) -> Trained | None:
        """Return whose models an integrator is fitted on; None where on held-out samples."""
        found = self._by_rule(self.protocol.partner, trained, "partner")
        if found is None:
            return None
        partner = trained[0], (found,)
        if partner not in self.tests:
            raise UsageError(
                f"partner: no pair trains on {found}, the partner of {trained[1][0]}: integrators "
                "are fitted on what the partner's models say; give pairs that do, or partner=null"
            )
        return partner

    def _fitting_parts(self, trained: Trained) -> list[Part]:
        """Return the recordings that integrators are fitted on by name."""
        given = self.protocol.fitted_on or ()
        names = [str(name) for name in ([given] if isinstance(given, str) else given)]
        of_world = [each.name for each in self.bench.recordings if each.world == trained[0]]
        check_names(names, of_world, "fitted_on")
        seen = {part.recording for part in (*trained[1], *self.tests[trained])}
        for name in names:
            if name in seen:
                raise UsageError(
                    f"fitted_on names {name}, which pairs train or test on: integrators are fitted "
                    "on recordings of their own"
                )
        return [Part(name) for name in names]

    def _by_rule(
        self,
        rule: Mapping[str, Any] | None,
        trained: Trained,
        what: str,
        but: Collection[str] = (),
    ) -> Part | None:
        world, parts = trained
        if not rule:
            return None
        if len(parts) > 1 or parts[0].fold is not None:
            names = " + ".join(map(str, parts))
            raise UsageError(
                f"{what} is of whole recordings, and the pairs train on {names}: give {what}=null"
            )
        recording = self.bench.recording(world, parts[0].recording)
        found = partner_of(rule, recording, self.bench.recordings, but)
        if found is None:
            tested = f" that its pairs do not test ({', '.join(sorted(but))})" if but else ""
            raise UsageError(
                f"{what}: no recording goes with {recording.name} by {dict(rule)}{tested}: give "
                f"another rule, or {what}=null"
            )
        return Part(found.name)

    def fitted_on(
        self, trained: Trained, models: Sequence[str]
    ) -> tuple[tuple[dict[str, str], ...], bool]:
        """Return the digests of the scores that an integrator is fitted on, and if a partner's."""
        others = self._fitting_parts(trained)
        if others:
            own = ({m: self.scores_digest(trained, m, each) for m in models} for each in others)
            return tuple(own), False
        partner = self.partner(trained)
        if partner is None:
            held_out = {m: self.scores_digest(trained, m, HELD_OUT) for m in models}
            return (held_out,), False
        tests = self.tests[partner]
        of_tests = ({m: self.scores_digest(partner, m, t) for m in models} for t in tests)
        return tuple(of_tests), self.protocol.one_scale

    # ------------------------------------------------------------------ tasks

    def areas_tasks(self) -> Iterator[AreasTask]:
        """Yield the tasks of accumulators, one a method and pair."""
        for split in self.splits:
            trained = split.world, split.train
            for method in self.methods.names:
                result = self.result_digest(split, method)
                single = method in self.methods.models
                scores = self.scores_digest(trained, method, split.test) if single else result
                digests = {
                    name: digest_of(result, spec, __version__, self._version(spec))
                    for name, spec in self.bench.accumulators.items()
                }
                yield AreasTask(self.bench, split.pair, method, scores, digests)

    def single_cue_tasks(self) -> Iterator[SingleCueTask]:
        """Yield the tasks of single-cue models, those of one cue after one another."""
        of_cue: dict[str, list[SingleCue]] = defaultdict(list)
        for model in self.methods.models.values():
            of_cue[digest_of(model.cue)].append(model)
        joined = {model for each in self.methods.joined.values() for model in each.models}
        for models in of_cue.values():
            for trained, tested in self.tests.items():
                fitting = self._fitting_parts(trained)
                tests = [*tested, *fitting]
                digests = {
                    (model.name, str(test)): self.scores_digest(trained, model.name, test)
                    for model in models
                    for test in tests
                }
                if not fitting and self.partner(trained) is None:
                    digests |= {
                        (model.name, HELD_OUT): self.scores_digest(trained, model.name, HELD_OUT)
                        for model in models
                        if model.name in joined
                    }
                world, train = trained
                yield SingleCueTask(
                    self.bench,
                    world,
                    train,
                    self.chosen_on(trained),
                    tuple(tests),
                    tuple(models),
                    digests,
                    self.wants_costs,
                )

    def joined_tasks(self, lacking: Mapping[tuple[str, Pair], str]) -> Iterator[JoinedTask]:
        """Yield the tasks of integrators for the pairs that have no result.

        Parameters
        ----------
        lacking : mapping of (str, Pair) to str
            By method and pair the digest of the result to be.
        """
        for joined in self.methods.joined.values():
            of_trained: dict[Trained, dict[Pair, tuple[dict[str, str], str]]] = defaultdict(dict)
            for split, pair in zip(self.splits, self.pairs, strict=True):
                trained = split.world, split.train
                if (joined.name, pair) in lacking:
                    said = {m: self.scores_digest(trained, m, split.test) for m in joined.models}
                    of_trained[trained][pair] = said, lacking[joined.name, pair]
            for trained, tests in of_trained.items():
                fitted_on, of_partner = self.fitted_on(trained, joined.models)
                yield JoinedTask(self.bench, joined, fitted_on, of_partner, tests)
