"""Features in parts: batches of them, what is checked of them, and how they are kept."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from placecue import DescriptorSets, FeatureKind, FeatureParts, UsageError, contracts
from placecue.features import form, join, kind_of, n_samples, single, spoilt_rows, stack, take
from placecue.storage.arrays import from_parts, parts_of

DENSE = np.arange(6.0).reshape(3, 2)
SPARSE = sparse.csr_array([[0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
SETS = DescriptorSets(np.arange(8, dtype=np.float32).reshape(4, 2), np.array([0, 1, 1, 4]))
BATCH = FeatureParts({"vector": DENSE, "histogram": SPARSE, "points": SETS})


def rows_of(batch: FeatureParts) -> list[object]:
    """What the parts of a batch hold, as plain lists."""
    sets = batch.parts["points"]
    assert isinstance(sets, DescriptorSets)
    return [
        batch.parts["vector"].tolist(),
        batch.parts["histogram"].toarray().tolist(),
        sets.values.tolist(),
        sets.offsets.tolist(),
    ]


def test_a_batch_knows_what_it_is() -> None:
    assert (kind_of(BATCH), n_samples(BATCH), len(BATCH)) == (FeatureKind.PARTS, 3, 3)
    assert BATCH.shape == (3, 2 + 3 + 2)
    assert form(BATCH) == (
        "a sparse histogram of width 3 as histogram with a set of local descriptors of width 2 as "
        "points with a dense vector of width 2 as vector"
    )


@pytest.mark.parametrize("rows", [np.array([2, 0]), np.array([True, False, True])])
def test_rows_are_taken_of_every_part(rows: np.ndarray) -> None:
    order = np.arange(3)[rows].tolist()
    expected = {
        (2, 0): [
            [[4, 5], [0, 1]],
            [[0, 0, 0], [0, 1, 0]],
            [[2, 3], [4, 5], [6, 7], [0, 1]],
            [0, 3, 4],
        ],
        (0, 2): [
            [[0, 1], [4, 5]],
            [[0, 1, 0], [0, 0, 0]],
            [[0, 1], [2, 3], [4, 5], [6, 7]],
            [0, 1, 4],
        ],
    }
    taken = take(BATCH, rows)
    assert isinstance(taken, FeatureParts)
    assert rows_of(taken) == expected[tuple(order)]
    assert sparse.issparse(taken.parts["histogram"])


def test_single_samples_stack_to_the_batch_they_came_from() -> None:
    stacked = stack([single(BATCH, row) for row in range(3)])
    assert isinstance(stacked, FeatureParts)
    assert rows_of(stacked) == rows_of(BATCH)
    halves = join([take(BATCH, np.array([0])), take(BATCH, np.array([1, 2]))])
    assert isinstance(halves, FeatureParts)
    assert rows_of(halves) == rows_of(BATCH)


def test_a_copy_is_its_own() -> None:
    copy = BATCH.copy()
    copy.parts["vector"][:] = -1  # type: ignore[index]
    assert DENSE[0].tolist() == [0, 1]


def test_spoilt_rows_are_those_of_any_part() -> None:
    dense, histogram = DENSE.copy(), SPARSE.copy()
    dense[2, 0], histogram.data[0] = np.nan, np.inf
    spoilt = FeatureParts({"vector": dense, "histogram": histogram, "points": SETS})
    assert spoilt_rows(spoilt).tolist() == [0, 2]
    assert spoilt_rows(BATCH).tolist() == []
    assert contracts.finite(spoilt) == "returned NaN or infinite numbers"
    assert contracts.finite(BATCH) is None


@pytest.mark.parametrize(
    "other",
    [
        FeatureParts({"vector": DENSE[:1]}),
        FeatureParts({"vector": DENSE[:1], "histogram": SPARSE[[0]], "dots": SETS[[0]]}),
        FeatureParts({"vector": DENSE[:1, :1], "histogram": SPARSE[[0]], "points": SETS[[0]]}),
    ],
)
def test_other_parts_are_not_stacked(other: FeatureParts) -> None:
    with pytest.raises(UsageError, match=r"different shapes in one batch: a .* as "):
        stack([single(BATCH, 0), other])
    said = contracts.batch(other, 1, BATCH)
    assert said is not None
    assert said.startswith("returned a ")
    assert "where training had a sparse histogram of width 3 as histogram with" in said


BAD = [
    (FeatureParts({}), 3, "in parts without a part"),
    (FeatureParts({"a": DENSE, "b": SPARSE[[0]]}), 3, "1 row for 3 samples, in part 'b'"),
    (FeatureParts({"a": DENSE, "b": BATCH}), 3, "parts of its own, in part 'b'"),
    (FeatureParts({"a": DENSE.astype(object)}), 3, "of object, not of real numbers, in part 'a'"),
    (FeatureParts({"a": DENSE[0]}), 1, r"an array of shape \(2,\), in part 'a'"),
    (FeatureParts({7: DENSE}), 3, "a part whose name is no text, in part 7"),  # type: ignore[dict-item]
]


@pytest.mark.parametrize(("made", "n", "said"), BAD)
def test_a_cue_that_makes_nonsense_is_told(made: FeatureParts, n: int, said: str) -> None:
    assert contracts.batch(BATCH, 3) is None
    with pytest.raises(AssertionError, match=said):
        raise AssertionError(contracts.batch(made, n))


def test_one_observation_s_features_are_a_batch_of_one() -> None:
    assert contracts.features(single(BATCH, 1)) is None
    assert contracts.features(BATCH) == "returned 3 rows for 1 sample, in part 'vector'"


def test_they_are_kept_as_plain_arrays() -> None:
    taken_apart = parts_of(BATCH)
    assert taken_apart is not None
    what, arrays = taken_apart
    assert all(type(each) is np.ndarray for each in arrays.values())
    back = from_parts(what, arrays)
    assert list(back.parts) == list(BATCH.parts)
    assert rows_of(back) == rows_of(BATCH)
    assert back.parts["points"].values.dtype == np.float32
    assert back.parts["histogram"].nnz == 2
    assert parts_of(FeatureParts({"a": DENSE.astype(object)})) is None


def damaged(**changes: object) -> tuple[dict[str, object], dict[str, np.ndarray]]:
    """What is kept of a batch, with something else in its description."""
    taken_apart = parts_of(FeatureParts({"a": DENSE, "b": SPARSE}))
    assert taken_apart is not None
    return {**taken_apart[0], **changes}, taken_apart[1]


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"names": ["a", "a"]}, "parts called"),
        ({"names": []}, "parts called"),
        ({"names": ["a", 1]}, "parts called"),
        ({"names": ["a"]}, "argument 2 is longer"),
        ({"of": [{"@": "array"}, {"@": "parts"}]}, "part 'b' is itself in parts"),
    ],
)
def test_what_does_not_fit_together_is_damaged(changes: dict[str, object], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        from_parts(*damaged(**changes))


@pytest.mark.parametrize(
    ("value", "error"), [(DENSE[0], "no batch of features"), (DENSE[:2], "different numbers")]
)
def test_parts_of_other_shapes_are_damaged(value: np.ndarray, error: str) -> None:
    what, arrays = damaged()
    with pytest.raises(ValueError, match=error):
        from_parts(what, {**arrays, "0.value": value})
