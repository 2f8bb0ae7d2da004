"""A component that fails at some observations: the run stops, or goes on without them."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

from placecue import (
    Classifier,
    Cue,
    DataError,
    Evidence,
    Integrator,
    Observation,
    OneAgainstAll,
    Pipeline,
    Scores,
    UnusableObservation,
)
from placecue.errors import ComponentError, ContractError, UsageError
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Brightness, Walk

#: Observations at which something fails, by number; two in a batch of 16, one in the next.
BAD = (5, 11, 30)
STAMPS = [number * 200_000_000 for number in BAD]
BATCHES = pytest.mark.parametrize("batch", [1, 16])


class Distance(Beams):
    """The first beam, which alone tells the four places apart; the stamp behind it."""

    def extract(self, observation: Observation) -> np.ndarray:
        return np.array([observation.scan.filled()[0], float(observation.stamp)])


class Nearest(Classifier):
    """Scores by the distance from each place's own first beam; fails at bad stamps."""

    def __init__(self, deed: Any = None) -> None:
        self.deed = deed

    def fit(self, features: Any, labels: Any, stamps: Any = None) -> Nearest:
        self.layout_ = OneAgainstAll(PLACES)
        return self

    def scores(self, features: Any) -> Scores:
        wrong = np.isin(features[:, 1], STAMPS)
        values = -np.abs(features[:, :1] - np.arange(2.0, 6.0))
        return Scores(values if self.deed is None else self.deed(wrong, values), self.layout_)


class Passing(Integrator):
    """The scores of the first cue; fails at bad stamps."""

    def __init__(self, deed: Any = None) -> None:
        self.deed = deed

    def fit(self, evidence: Evidence, labels: Any, stamps: Any = None) -> Passing:
        self.fitted_ = True
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        first = evidence.scores(evidence.cues[0])
        # The second cue is the stamp, in every column.
        wrong = np.isin(evidence.scores("stamp").values[:, 0], STAMPS)
        values = first.values if self.deed is None else self.deed(wrong, first.values)
        return Scores(values, first.layout)


class Stamps(Classifier):
    """Tells the stamp."""

    def fit(self, features: Any, labels: Any, stamps: Any = None) -> Stamps:
        self.layout_ = OneAgainstAll(PLACES)
        return self

    def scores(self, features: Any) -> Scores:
        return Scores(np.repeat(features[:, 1:], 4, axis=1), self.layout_)


class FaultyDistance(Distance):
    """Fails at bad stamps."""

    def __init__(self, deed: Any = None) -> None:
        super().__init__()
        self.deed = deed

    def extract(self, observation: Observation) -> np.ndarray:
        made = super().extract(observation)
        wrong = np.array([observation.stamp in STAMPS])
        return made if self.deed is None else self.deed(wrong, made)


def fails(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    if wrong.any():
        raise ValueError("out of order")
    return values


def leaves(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    if wrong.any():
        raise SystemExit(2)
    return values


def in_company(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Fail at no sample alone."""
    if wrong.any() and len(wrong) > 1:
        raise ValueError("too many")
    return values


def one_row(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    return values[:1] if wrong.any() else values


def another_length(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.zeros((1, 1, 1)) if wrong.any() else values


def pipeline(kind: str, deed: Any, on_error: str = "stop") -> Pipeline:
    """A fitted pipeline whose component of a kind does a deed from now on."""
    made = unfitted(kind).fit(Walk())
    faulty: Any = made.integrator if kind == "integrator" else made.cues["beams"].classifier
    faulty = made.cues["beams"].cue if kind == "cue" else faulty
    faulty.deed = deed
    made.on_error = on_error
    return made


def unfitted(kind: str, deed: Any = None) -> Pipeline:
    cue: Cue = FaultyDistance(deed if kind == "cue" else None)
    classifier = Nearest(deed if kind == "classifier" else None)
    if kind != "integrator":
        return Pipeline({"beams": (cue, classifier)})
    cues = {"beams": (cue, classifier), "stamp": (Distance(), Stamps())}
    return Pipeline(cues, Passing(deed))


KINDS = {"cue": "FaultyDistance", "classifier": "Nearest", "integrator": "Passing"}
METHODS = {"cue": "extract", "classifier": "scores", "integrator": "integrate"}
ALL = pytest.mark.parametrize("kind", KINDS)


@ALL
@BATCHES
@pytest.mark.parametrize("deed", [fails, leaves])
def test_skip_goes_on_without_those_samples_and_counts_them_once(
    kind: str, batch: int, deed: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = Walk(rounds=1)
    sound = dict(enumerate(pipeline(kind, None).beliefs(log)))
    faulty = pipeline(kind, deed, "skip")
    with caplog.at_level(logging.WARNING):
        found = [belief for _, belief in faulty.follow(log, batch)]
    assert [n for n, belief in enumerate(found) if belief is None] == list(BAD)
    for number, belief in enumerate(found):
        if belief is not None:
            assert belief.label == sound[number].label
            np.testing.assert_array_equal(belief.scores.values, sound[number].scores.values)
    (record,) = caplog.records
    who = f"{kind} {KINDS[kind]} ({__name__}): {METHODS[kind]} failed"
    assert record.message.startswith(f"3 of 80 observations passed over; the first: {who}")


@ALL
@BATCHES
def test_stop_is_one_line_that_says_who_and_where(kind: str, batch: int) -> None:
    with pytest.raises(ComponentError) as caught:
        list(pipeline(kind, fails).beliefs(Walk(rounds=1), batch))
    who = f"{kind} {KINDS[kind]} ({__name__}): {METHODS[kind]} failed"
    assert str(caught.value) == (f"{who} at stamp {STAMPS[0]} of walk 0: ValueError: out of order")
    assert isinstance(caught.value.__cause__, ValueError)


@BATCHES
@pytest.mark.parametrize(
    ("kind", "deed", "said"),
    [
        ("cue", another_length, "returned an array of shape"),
        ("classifier", one_row, "returned 1 row for 16 samples"),
        ("integrator", one_row, "returned 1 row for 16 samples"),
    ],
)
def test_a_broken_promise_is_never_skipped(kind: str, deed: Any, said: str, batch: int) -> None:
    def broken(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
        made = deed(wrong, values)
        return made[:0] if batch == 1 and wrong.any() and kind != "cue" else made

    said = said if batch == 16 or kind == "cue" else "returned 0 rows for 1 sample"
    with pytest.raises(ContractError, match=said):
        list(pipeline(kind, broken, "skip").beliefs(Walk(rounds=1), batch))


@pytest.mark.parametrize("kind", ["classifier", "integrator"])
@pytest.mark.parametrize("on_error", ["stop", "skip"])
def test_what_fails_in_company_alone_is_an_error(kind: str, on_error: str) -> None:
    faulty = pipeline(kind, in_company, on_error)
    with pytest.raises(ComponentError, match=f"{METHODS[kind]} failed.*: ValueError: too many"):
        list(faulty.beliefs(Walk(rounds=1), 16))
    assert len(list(faulty.beliefs(Walk(rounds=1), 1))) == 80


@ALL
def test_where_all_fail_nothing_is_usable(kind: str) -> None:
    def always(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
        raise ValueError("never")

    with pytest.raises(DataError, match="no usable observation: 80 of 80 observations passed"):
        list(pipeline(kind, always, "skip").beliefs(Walk(rounds=1), 16))


def test_training_goes_on_without_them(caplog: pytest.LogCaptureFixture) -> None:
    faulty = unfitted("cue", fails)
    with pytest.raises(ComponentError, match=f"extract failed at stamp {STAMPS[0]} of walk 0: "):
        faulty.fit(Walk())
    faulty.on_error = "skip"
    with caplog.at_level(logging.WARNING):
        samples = faulty.collect(Walk())
    assert len(samples) == 320 - len(BAD)
    assert not set(samples.stamps.tolist()) & set(STAMPS)
    assert faulty.fit(Walk()).classes == PLACES
    first = caplog.records[0].message
    assert first.startswith("3 of 320 observations passed over; the first: cue FaultyDistance")


class Colours(Brightness):
    """Learns, and fails at bad stamps once it has."""

    def __init__(self, deed: Any = None) -> None:
        self.deed = deed

    def extract(self, observation: Observation) -> np.ndarray:
        made = super().extract(observation)
        wrong = np.array([observation.stamp in STAMPS])
        return made if self.deed is None else self.deed(wrong, made)


class Negatives(Colours):
    """Training also sees each image as a negative."""

    def augmentations(self) -> list[Any]:
        return [lambda each: each.altered("negative", image=255 - each.image)]


def cannot(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
    if wrong.any():
        raise UnusableObservation("nothing to see")
    return values


def with_one_that_learns(cue: Cue) -> Pipeline:
    cues = {
        "beams": (Beams(), SVM(kernel=RBF(gamma=0.1))),
        "colours": (cue, SVM(kernel=RBF(gamma=0.001))),
    }
    return Pipeline(cues, SVMDAS(SVM(kernel=RBF(gamma=0.3))))


@pytest.mark.parametrize("kind", [Colours, Negatives])
def test_training_goes_on_where_a_cue_that_has_learned_fails(
    kind: type, caplog: pytest.LogCaptureFixture
) -> None:
    faulty = with_one_that_learns(kind(fails))
    with pytest.raises(ComponentError, match=f"^cue {kind.__name__} .* at stamp {STAMPS[0]} of"):
        faulty.fit(Walk())
    faulty.on_error = "skip"
    with caplog.at_level(logging.WARNING):
        faulty.fit(Walk())
    (record,) = caplog.records
    told = f"cue colours: 3 of 320 observations passed over; the first: cue {kind.__name__} "
    assert record.message.startswith(told)
    # The other cue goes on without it.
    assert len(faulty.held_out_) == 320
    known = faulty.held_out_.evidence.known()
    assert known[:, 0].all()
    assert faulty.held_out_.stamps[~known[:, 1]].tolist() == STAMPS
    told = pairs(faulty, Walk(seed=1))
    assert np.mean([belief.label == seen.label for seen, belief in told]) > 0.9
    assert len(told) == 320
    lacking = [seen.stamp for seen, belief in told if belief.cues_missing == ("colours",)]
    assert lacking == STAMPS


def test_so_it_does_on_an_integration_log_and_where_nothing_can_be_seen() -> None:
    faulty = with_one_that_learns(Colours(cannot))  # an unusable observation is never an error
    faulty.fit(Walk(), integration=Walk(seed=1))
    unseen = ~faulty.held_out_.evidence.available("colours")
    assert faulty.held_out_.stamps[unseen].tolist() == STAMPS
    samples = faulty.collect(Walk())
    training = samples.training_set("colours", faulty.cues["colours"].cue)
    assert len(training) == 320 - len(BAD)
    means = np.array([each.image.mean(axis=(0, 1)) for each in Walk() if each.stamp not in STAMPS])
    half = np.arange(0, len(training), 2)
    relearned = training.relearned(half)  # rows of the set, not of the log
    np.testing.assert_allclose(relearned.features, means - means[half].mean(axis=0))
    assert relearned.stamps.tolist() == training.stamps.tolist()


def test_where_a_cue_that_has_learned_always_fails() -> None:
    def always(wrong: np.ndarray, values: np.ndarray) -> np.ndarray:
        raise ValueError("never")

    faulty = with_one_that_learns(Colours(always))
    faulty.on_error = "skip"
    with pytest.raises(DataError, match=r"^cue colours: no usable observation: 320 of 320 "):
        faulty.fit(Walk())


def pairs(fitted: Pipeline, log: Walk) -> list[tuple[Observation, Any]]:
    return [(seen, belief) for seen, belief in fitted.follow(log, 16) if belief is not None]


class Widening(Beams):
    """Returns one number more at bad stamps."""

    def extract(self, observation: Observation) -> np.ndarray:
        return np.ones(4 + (observation.stamp in STAMPS))


@pytest.mark.parametrize("on_error", ["stop", "skip"])
def test_features_of_another_width_break_a_promise(on_error: str) -> None:
    made = Pipeline({"beams": (Widening(), SVM(kernel=RBF()))})
    made.on_error = on_error
    said = "made a dense vector of width 5 after a dense vector of width 4"
    with pytest.raises(ContractError, match=rf"^cue Widening \({__name__}\): {said}"):
        made.fit(Walk())


def test_another_word_is_refused() -> None:
    faulty = unfitted("cue")
    faulty.on_error = "skp"
    with pytest.raises(UsageError, match="on_error is 'skp'; did you mean 'skip'"):
        faulty.fit(Walk())
