"""Runs put together, what accumulators could not label included."""

from evaluated import CLASSES, result
from placecue.evaluation.results.about import About, Method
from placecue.evaluation.results.kept import merged
from placecue.evaluation.results.result import Pair
from placecue.evaluation.results.store import ResultStore


def run(folder, experiment):
    pair, digest = Pair(experiment, "", ("a",), "b"), f"{experiment}-digest"
    found = result(pair, "laser", 0.9, classes=CLASSES)
    ResultStore(folder).save(found.__class__(**{**vars(found), "digest": digest}))
    why = {"method": "laser, hmm", "pair": list(pair), "error": "no poses"}
    about = About("t", {}, {"laser": Method(["laser"])}, {experiment: 1}, [digest], failures=[why])
    about.save(folder)
    return folder


def test_failures_of_accumulators_come_last(tmp_path):
    about, results = merged([run(tmp_path / name, name) for name in ("day", "night")])
    assert [(each.method, each.pair.experiment) for each in results] == [
        ("laser", "day"), ("laser", "night"), ("laser, hmm", "day"), ("laser, hmm", "night"),
    ]  # fmt: skip
    assert len(about.failures) == 2
