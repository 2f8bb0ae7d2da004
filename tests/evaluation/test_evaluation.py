"""The numbers of an experiment against pipelines trained by hand, and runs that are interrupted."""

import multiprocessing
import os
import signal
import time
from dataclasses import replace

import numpy as np
import pytest

import experiments
from experiments import (
    BOTH,
    COLOUR,
    DAS,
    GDAS,
    HISTOGRAM,
    LASER,
    LINEAR,
    RULE,
    SEARCHED,
    evaluation,
    run,
)
from placecue import (
    HeldOut,
    InterleavedChunks,
    Pipeline,
    Schemes,
    Scores,
    StoredEvidence,
)
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.errors import DataError, UsageError
from placecue.evaluation.executors.backends import executor_of
from placecue.evaluation.protocol.methods import Joined, Methods
from placecue.evaluation.protocol.plan import Protocol
from placecue.evaluation.results.store import ResultStore
from placecue.logs import open_log
from rooms import Rooms, write_log


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    return experiments.logs(tmp_path_factory.mktemp("logs"))


@pytest.fixture(scope="module")
def four(paths, tmp_path_factory):
    """All pairs, integrators fitted on out-of-fold scores."""
    each = evaluation(tmp_path_factory.mktemp("all"), paths)
    return each, run(each)


def built(spec, kind):
    return build(spec, kind, current_plugins().registry)


def model(single):
    return built(single.cue, "cue"), built(single.classifier, "classifier")


def pipeline(*singles, integrator=None):
    cues = {single.name: model(single) for single in singles}
    joins = None if integrator is None else built(integrator.integrator, "integrator")
    return Pipeline(cues, joins, InterleavedChunks())


def decided(result):
    return [result.classes[number] for number in result.decided]


def believed(trained, path):
    return [belief.label for belief in trained.beliefs(open_log(path), batch=16)]


def test_single_cues_decide_as_pipelines_do(four, paths):
    _, results = four
    for single in (LASER, COLOUR):
        trained = pipeline(single).fit(open_log(paths[0]))
        for number in (1, 2, 3):
            result = results[single.name, f"log0 → log{number}"]
            assert decided(result) == believed(trained, paths[number])


def test_joined_cues_decide_as_pipelines_do(four, paths):
    _, results = four
    for joined in (GDAS, DAS):
        trained = pipeline(LASER, COLOUR, integrator=joined).fit(open_log(paths[2]))
        result = results[joined.name, "log2 → log1"]
        assert decided(result) == believed(trained, paths[1])


def test_truth_stamps_and_score_are_those_of_the_log(four, paths):
    _, results = four
    result = results["laser", "log0 → log1"]
    known = [(o.stamp, o.label) for o in open_log(paths[1]) if o.label is not None]
    assert result.stamps.tolist() == [stamp for stamp, _ in known]
    truth = [result.classes[number] for number in result.truth]
    assert truth == [label for _, label in known]
    of_class = {name: [] for name in truth}
    for name, said in zip(truth, decided(result), strict=True):
        of_class[name].append(name == said)
    recalls = {name: sum(right) / len(right) for name, right in of_class.items()}
    assert result.recalls == pytest.approx(recalls)
    assert result.score == pytest.approx(sum(recalls.values()) / len(recalls))


def test_an_integrator_is_fitted_on_what_the_partners_models_say_of_all_their_tests(
    paths, tmp_path
):
    protocol = Protocol(partner=RULE, one_scale=False)
    results = run(evaluation(tmp_path, paths, pairs={"differ": ["light"]}, protocol=protocol))
    of_partner = {s.name: pipeline(s).fit(open_log(paths[1])) for s in (LASER, COLOUR)}
    own = {s.name: pipeline(s).fit(open_log(paths[0])) for s in (LASER, COLOUR)}

    def said(trained, path):
        samples = {name: each.collect(open_log(path)) for name, each in trained.items()}
        return samples["laser"].labels, {
            name: each.evidence_of(samples[name]).scores(name) for name, each in trained.items()
        }

    parts = [said(of_partner, paths[number]) for number in (2, 3)]
    labels = np.concatenate([labels for labels, _ in parts])
    scores = {
        name: Scores(np.vstack([each[name].values for _, each in parts]), parts[0][1][name].layout)
        for name in own
    }
    groups = np.repeat([0, 1], [len(each) for each, _ in parts])
    held_out = HeldOut(StoredEvidence(scores), labels, None, groups, InterleavedChunks(), part=True)
    schemes = Schemes.fit(built(GDAS.integrator, "integrator"), held_out)
    for number in (2, 3):
        _, evidence = said(own, paths[number])
        expected = schemes.integrate(StoredEvidence(evidence))[0].decide().labels.tolist()
        assert decided(results[GDAS.name, f"log0 → log{number}"]) == expected


def test_scaling_outputs_of_partners_does_not_change_what_each_cue_decides(paths, tmp_path):
    pairs = {"differ": ["light"]}
    plain = run(evaluation(tmp_path / "a", paths, pairs=pairs,
                           protocol=Protocol(RULE, None, False)))  # fmt: skip
    scaled = run(evaluation(tmp_path / "b", paths, pairs=pairs, protocol=Protocol(RULE)))
    for key, result in plain.items():
        if key[0] in BOTH.models:
            assert decided(scaled[key]) == decided(result)


def test_parameters_are_chosen_on_another_recording(paths, tmp_path):
    searched = replace(LASER, classifier=SEARCHED)
    methods = Methods({"laser": searched}, {})
    protocol = Protocol(chosen_on={"same": ["light"]})
    each = evaluation(tmp_path, paths, methods, {"differ": ["light"]}, protocol)
    results = run(each)

    def score(cost):
        trained = pipeline(replace(LASER, classifier={**LINEAR, "C": cost}))
        said = believed(trained.fit(open_log(paths[0])), paths[1])
        truth = [o.label for o in open_log(paths[1])]
        return np.mean(
            [np.mean([s == t for s, t in zip(said, truth, strict=True) if t == name])
             for name in set(truth)]
        )  # fmt: skip

    best = max([0.1, 1.0, 10.0], key=score)
    result = results["laser", "log0 → log2"]
    assert result.settings == {"C": best}
    trained = pipeline(replace(LASER, classifier={**LINEAR, "C": best})).fit(open_log(paths[0]))
    assert decided(result) == believed(trained, paths[2])


def test_what_is_there_is_not_computed_again(four, paths):
    each, first = four
    before = {p: p.stat().st_mtime_ns for p in each.bench.folder.rglob("*.npz")}
    executor = experiments.Here()
    again = run(evaluation(each.bench.folder, paths), executor)
    assert {p: p.stat().st_mtime_ns for p in each.bench.folder.rglob("*.npz")} == before
    assert set(executor.tasks) == {"extracted"}
    same(first, again)


def same(first, second):
    assert first.keys() == second.keys()
    for key, result in first.items():
        np.testing.assert_array_equal(result.decided, second[key].decided)
        np.testing.assert_array_equal(result.confidence, second[key].confidence)
        assert result.digest == second[key].digest


def test_a_changed_parameter_is_computed_anew_and_nothing_else(four, paths):
    each, _ = four
    executor = experiments.Here()
    other = replace(COLOUR, name="darker", classifier={**HISTOGRAM, "C": 0.01})
    run(evaluation(each.bench.folder, paths, Methods({"laser": LASER, "darker": other}, {})),
        executor)  # fmt: skip
    assert executor.tasks.count("train_and_score") == 4


def test_dask_gives_the_same_to_the_bit(four, paths, tmp_path):
    pytest.importorskip("distributed", reason="placecue[dask] is not installed")
    with executor_of({"executor": {"name": "dask", "workers": 2}}) as executor:
        same(four[1], run(evaluation(tmp_path, paths), executor))


def test_killed_at_random_moments_it_ends_with_the_same_numbers(four, paths, tmp_path):
    fork = multiprocessing.get_context("fork")
    moments = np.random.default_rng(7).uniform(0.02, 0.8, 10)
    killed = 0
    for moment in moments:
        child = fork.Process(target=run, args=(evaluation(tmp_path, paths),))
        child.start()
        time.sleep(moment)
        if child.is_alive():
            os.kill(child.pid, signal.SIGKILL)
            killed += 1
        child.join()
    assert killed
    same(four[1], run(evaluation(tmp_path, paths)))


def test_a_pair_that_fails_is_told_and_the_rest_goes_on(paths, tmp_path, caplog):
    broken = replace(COLOUR, name="broken", classifier={**HISTOGRAM, "kernel": "match"})
    joined = Joined("with broken", ("laser", "broken"), "", GDAS.integrator)
    methods = Methods({"laser": LASER, "broken": broken}, {"with broken": joined})
    each = evaluation(tmp_path, paths[:2], methods)
    results = run(each)
    assert {method for method, _ in results} == {"laser"}
    assert {(r.method, str(r.pair)) for r in each.wrong} == {
        (method, pair)
        for method in ("broken", "with broken")
        for pair in ("log0 → log1", "log1 → log0")
    }
    assert all("kernel Match takes" in r.error and "\n" not in r.error for r in each.wrong)


def test_classes_that_a_test_lacks_are_left_out_and_those_never_trained_count(
    paths, tmp_path, caplog
):
    names = sorted({o.label for o in open_log(paths[0])})
    some = [
        write_log(tmp_path / "0.mcap", _Without(Rooms(seed=0), "lab")),
        write_log(tmp_path / "1.mcap", _Without(Rooms(seed=1), "kitchen")),
    ]
    results = run(evaluation(tmp_path / "out", some, Methods({"laser": LASER}, {})))
    result = results["laser", "0 → 1"]
    assert list(result.classes) == names
    assert result.absent == ("kitchen",)
    assert result.recalls["lab"] == 0.0
    recalls = result.recalls
    assert result.score == pytest.approx((recalls["corridor"] + recalls["office"]) / 3)
    told = caplog.text
    assert "1 has no sample of kitchen: recall left out" in told
    assert "1 has samples of lab, which 0 has not" in told


class _Without(Rooms):
    """A robot that never enters one of the rooms."""

    def __init__(self, rooms, name):
        super().__init__(rooms.rounds, rooms.stay, rooms.seed)
        self.left_out = name

    def __iter__(self):
        return (each for each in super().__iter__() if each.label != self.left_out)


def test_folds_within_a_recording_hold_every_sample_out_once(paths, tmp_path):
    results = run(evaluation(tmp_path, paths[:1], Methods({"laser": LASER}, {}), "folds"))
    stamps = np.concatenate([result.stamps for result in results.values()])
    known = [o.stamp for o in open_log(paths[0])]
    assert sorted(stamps.tolist()) == known


@pytest.mark.parametrize("pairs", ["leave_one_out", [[["log0", "log1"], "log3"]]])
def test_training_on_several_recordings(paths, tmp_path, pairs):
    results = run(evaluation(tmp_path, paths, Methods({"laser": LASER}, {}), pairs))
    assert all(result.score > 0.5 for result in results.values())


@pytest.mark.parametrize(
    ("protocol", "pairs", "said"),
    [
        (Protocol(partner={"differ": ["light"]}), {"same": ["light"],
         "where": {"light": "day"}}, "no pair trains on"),
        (Protocol(partner=RULE), "folds", "is of whole recordings"),
        (Protocol(partner={"same": ["floor"]}), "all", "asks for 'floor'"),
        (Protocol(chosen_on={"same": ["light"]}), "all",
         r"no recording goes with log0 by .* that its pairs do not test \(log1, log2, log3\)"),
        (Protocol(fitted_on="log3"), "all", "fitted_on names log3, which pairs train or test on"),
    ],
)  # fmt: skip
def test_partners_that_make_no_sense(paths, tmp_path, protocol, pairs, said):
    with pytest.raises(UsageError, match=said):
        run(evaluation(tmp_path, paths, protocol=protocol, pairs=pairs))


def test_one_recording_under_two_names_is_refused(paths, tmp_path):
    (tmp_path / "again.mcap").symlink_to(paths[0])
    given = [*paths[:2], tmp_path / "again.mcap"]
    with pytest.raises(UsageError, match="log0 and again are one recording"):
        run(evaluation(tmp_path, given, Methods({"laser": LASER}, {})))


def test_results_of_another_version_are_refused(four, tmp_path):
    each, results = four
    digest = next(iter(results.values())).digest
    store = ResultStore(each.bench.folder)
    other = ResultStore(tmp_path)
    other.path(digest).parent.mkdir()
    spoilt = store.path(digest).read_bytes().replace(b'"format": 1', b'"format": 2')
    other.path(digest).write_bytes(spoilt)
    with pytest.raises(DataError, match="damaged"):
        other.load(digest)
