"""Which mistakes are chosen, and what each tells."""

from __future__ import annotations

from collections import Counter

import numpy as np

from made_results import METHODS, START, Made
from placecue.evaluation.report.mistakes import Mistakes, find_mistakes
from placecue.evaluation.report.scan_drawing import draw_scan
from placecue.evaluation.report.views import encoded, with_views
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results

PAIR = Pair("Exp 1", "", ("a",), "b")
CLASSES = ("hall", "kitchen", "lab", "office")


def result(method: str, decided: list[int], confidence: list[float]) -> Result:
    n = len(decided)
    return Result(
        PAIR,
        method,
        CLASSES,
        (np.arange(n) % 4).astype(np.int16),
        np.array(decided, dtype=np.int16),
        np.array(confidence, dtype=np.float32),
        np.arange(n) * 10,
    )


def by_hand() -> Results:
    # Truth is 0 1 2 3; the laser is wrong at 1, the camera at 1 and 3, where it says nothing.
    camera = result("crfh", [0, 2, 2, -1], [0.5, 1.0, 4.0, float("nan")])
    laser = result("laser", [0, 0, 2, 3], [1.0, 0.25, 1.0, 2.0])
    return Results([camera, laser])


def test_what_each_tells() -> None:
    found = find_mistakes(by_hand(), METHODS)
    assert (found.total, found.samples) == (3, 2)
    kitchen, office = found.shown
    assert (kitchen.truth, kitchen.decided, kitchen.stamp) == ("kitchen", "lab", 10)
    assert (kitchen.method, kitchen.pair, kitchen.recording) == ("crfh", "a → b", "b")
    assert kitchen.said == {"lab": ["crfh"], "hall": ["laser"]}
    assert (list(kitchen.right), kitchen.wrong) == ([], ["crfh", "laser"])
    assert (office.truth, office.decided) == ("office", "")
    assert np.isnan(office.confidence)
    assert list(office.right) == ["laser"]
    [bars] = kitchen.scores
    assert [(bar.name, bar.share, bar.right) for bar in bars.bars] == [
        ("crfh: lab", 0.25, False),
        ("laser: hall", 0.125, False),
    ]


def test_the_surest_first() -> None:
    decided, sure = [1, 1, 1, 1] * 3, [1, 0, 5, 1, 3, 0, 2, 1, 2, 0, 9, 1]
    found = find_mistakes(Results([result("crfh", decided, [float(s) for s in sure])]))
    of_lab = [each.stamp for each in found.shown if each.truth == "lab"]
    assert of_lab == [100, 20, 60]


def test_they_are_spread_and_always_the_same() -> None:
    made = Made(24, 60)
    found = find_mistakes(made.results(), made.methods, most=90)
    assert len(found.shown) == 90
    counts = Counter(each.truth for each in found.shown)
    assert set(counts.values()) == {18}
    pairs = Counter(each.pair for each in found.shown)
    assert len(pairs) == 24
    assert max(pairs.values()) - min(pairs.values()) <= 3
    methods = Counter(each.method for each in found.shown)
    assert max(methods.values()) - min(methods.values()) <= 12
    assert len({(each.pair, each.stamp) for each in found.shown}) == 90
    again = find_mistakes(made.results(), made.methods, most=90)
    assert [(e.pair, e.stamp, e.method) for e in again.shown] == [
        (e.pair, e.stamp, e.method) for e in found.shown
    ]


def test_all_are_found_where_there_is_room() -> None:
    results = Made(6, 40).results()
    wrong = {
        (str(each.pair), int(stamp))
        for each in results
        for stamp in each.stamps[each.decided != each.truth]
    }
    found = find_mistakes(results, most=10_000)
    assert {(each.pair, each.stamp) for each in found.shown} == wrong
    assert found.samples == len(wrong)


def test_bytes_bound_them() -> None:
    made = Made(4, 40)
    found = with_views(find_mistakes(made.results()), made.open_recording)
    kept = found.within(30_000)
    assert 0 < len(kept.shown) < len(found.shown)
    assert kept.shown == found.shown[: len(kept.shown)]
    assert sum(each.size for each in kept.shown) <= 30_000
    assert (kept.total, kept.samples) == (found.total, found.samples)
    assert found.within(0).shown == []


def test_views_are_those_of_the_samples() -> None:
    made = Made(2, 20)
    found = with_views(find_mistakes(made.results()), made.open_recording)
    assert found.shown
    for each in found.shown:
        number = (each.stamp - START) // 200_000_000
        of_log = list(made.open_recording(each.recording))[number]
        assert of_log.scan is not None
        assert np.array_equal(each.scan, of_log.scan.points())
        assert each.image == encoded(of_log.image)
        assert each.image.startswith(b"\xff\xd8")


def test_a_scan_from_above() -> None:
    # 4 m ahead, 2 m to the left, 1 m to the right: up, left and right in a square of ±60.
    path, reach = draw_scan(np.array([[0.0, -1.0], [4.0, 0.0], [0.0, 2.0]]))
    assert reach == 4
    assert path == "M0 0L15 0 0 -60 -30 0Z"


def test_far_beams_are_cut_at_the_border_and_there_are_few() -> None:
    path, reach = draw_scan(np.column_stack([np.full(1000, 80.0), np.linspace(-3, 3, 1000)]))
    assert reach == 10
    assert path.count(" ") <= 250
    assert len(path) < 1500


def test_pictures_of_any_kind() -> None:
    grey = np.zeros((30, 40), np.uint8)
    assert encoded(grey).startswith(b"\xff\xd8")
    assert encoded(np.zeros((4, 4), np.float64).astype(np.uint16)) == b""
    assert encoded(np.zeros((0, 4), np.uint8)) == b""
    assert Mistakes([], 0).methods == []
