"""Pairs against the counts of METHODS section 1, and rules that make no sense."""

from collections import Counter
from dataclasses import replace

import pytest
import yaml

from placecue.errors import UsageError
from placecue.evaluation.protocol.pairs import Part, fits, partner_of, splits_of
from placecue.evaluation.protocol.recordings import Recorded, derived, made_by, recordings_of

LIGHTS = ("cloudy", "night", "sunny")


@pytest.fixture(scope="module")
def experiment():
    from importlib.resources import files

    text = (files("placecue_conf") / "experiment" / "office_idol.yaml").read_text()
    return yaml.safe_load(text)


@pytest.fixture(scope="module")
def twelve(experiment):
    make = {**experiment["make"], "worlds": {"seed": 0}}
    derive = experiment["conditions"]["derive"]
    return [replace(each, metadata=derived(each.metadata, derive)) for each in made_by(make)]


@pytest.fixture(scope="module")
def splits(experiment, twelve):
    return splits_of(experiment["pairs"], twelve, 5)


def test_counts_of_ordered_pairs_are_the_papers(splits):
    counts = Counter(split.experiment for split in splits)
    assert counts == {"Exp 1": 12, "Exp 2": 24, "Exp 3": 12, "Exp 4": 24}


def light_and_run(name):
    return name[:-1], int(name[-1])


def expected(train, test):
    """The experiment of two sequences, spelled out from METHODS section 1; None for none."""
    (light, run), (other_light, other_run) = light_and_run(train), light_and_run(test)
    close = {1: 2, 2: 1, 3: 4, 4: 3}
    later = {1: 3, 2: 4, 3: 1, 4: 2}
    if light == other_light:
        if other_run == close[run]:
            return "Exp 1"
        return "Exp 3" if other_run == later[run] else None
    if other_run == run:
        return "Exp 2"
    return "Exp 4" if other_run == later[run] else None


def test_every_ordered_pair_is_in_the_experiment_it_belongs_to(splits, twelve):
    found = {(split.train[0].recording, split.test.recording): split.experiment for split in splits}
    assert len(found) == 72
    names = [each.name for each in twelve]
    for train in names:
        for test in names:
            if train != test:
                assert found.get((train, test)) == expected(train, test)


def test_partners_are_of_like_light_and_close_in_time(experiment, twelve):
    for each in twelve:
        light, run = light_and_run(each.name)
        close = {1: 2, 2: 1, 3: 4, 4: 3}[run]
        partner = partner_of(experiment["partner"], each, twelve)
        assert partner is not None
        assert partner.name == f"{light}{close}"


def test_parameters_are_chosen_on_a_recording_that_no_pair_tests(experiment, twelve, splits):
    for each in twelve:
        chosen_on = partner_of(experiment["chosen_on"], each, twelve)
        tests = {split.test.recording for split in splits if split.train == (Part(each.name),)}
        assert chosen_on is not None
        assert len(tests) == 6
        assert chosen_on.name not in tests
        assert chosen_on.name != each.name


def test_worlds_are_never_mixed(experiment):
    make = {**experiment["make"], "worlds": {"seed": [0, 1]}}
    derive = experiment["conditions"]["derive"]
    known = [replace(each, metadata=derived(each.metadata, derive)) for each in made_by(make)]
    splits = splits_of(experiment["pairs"], known, 5)
    assert Counter(split.world for split in splits) == {"seed 0": 72, "seed 1": 72}
    assert len({each.source["path"] for each in known}) == 24


def recorded(name, **metadata):
    return Recorded(name, "", {"plugin": "mcap", "path": f"{name}.mcap"}, None, metadata)


ABC = [recorded("a", light="day"), recorded("b", light="day"), recorded("c", light="night")]


@pytest.mark.parametrize(
    ("pairs", "expected"),
    [
        ("all", {"a b", "a c", "b a", "b c", "c a", "c b"}),
        ({"same": ["light"]}, {"a b", "b a"}),
        ({"same": "light"}, {"a b", "b a"}),
        ({"differ": ["light"]}, {"a c", "c a", "b c", "c b"}),
        ({"same": ["light"], "where": {"light": "day"}}, {"a b", "b a"}),
        ([["a", "b"], [["a", "b"], "c"]], {"a b", "a+b c"}),
        ("leave_one_out", {"a+b c", "a+c b", "b+c a"}),
        ({"way": "leave_one_out"}, {"a+b c", "a+c b", "b+c a"}),
        ({"way": "all", "where": {"light": "day"}}, {"a b", "b a"}),
        (
            "folds",
            {f"{n} without fold {k} {n} fold {k}" for n in "abc" for k in (1, 2)},
        ),
    ],
)
def test_ways_to_pick_pairs(pairs, expected):
    found = {f"{'+'.join(map(str, s.train))} {s.test}" for s in splits_of(pairs, ABC, 2)}
    assert found == expected


@pytest.mark.parametrize(
    ("pairs", "said"),
    [
        ({"same": ["floor"]}, "asks for 'floor', which a does not tell (it tells light)"),
        ({"same": ["light"], "differ": ["light"]}, "no two of 3 recordings are a pair by"),
        ([["a", "d"]], "names a recording 'd'"),
        ([["a", "a"]], "tests on what it trains on"),
        (["a"], "a pair must be [train, test], got 'a'"),
        ({"way": "every"}, "pairs {way: every} make no sense: way is one of all, leave_one_out"),
        ({"way": "all", "same": ["light"]}, "pairs {way: all, same} make no sense"),
        ({"way": "all", "where": {"light": "dusk"}}, "no two of 3 recordings are a pair by"),
        ("every", "pairs must be a rule, a list, or a word"),
        ({"like": ["light"], "same": []}, "a rule for pairs has no 'like'"),
        ({"where": "day"}, "where is a mapping, {CONDITION: VALUE}, got 'day'"),
        ([[["a", "a"], "b"]], "pair [[a, a], b] trains on one log twice"),
        ([[[], "b"]], "pair [[], b] trains on nothing"),
    ],
)
def test_pairs_that_make_no_sense(pairs, said):
    with pytest.raises(UsageError) as error:
        splits_of(pairs, ABC, 2)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_rule_is_a_mapping():
    with pytest.raises(UsageError, match="a rule for pairs is a mapping"):
        partner_of("light", ABC[0], ABC)


def test_one_recording_makes_no_pair():
    with pytest.raises(UsageError, match=r"one recording \(a\) makes no pair of two"):
        splits_of("all", ABC[:1], 2)


def test_a_rule_asks_for_what_both_tell():
    assert fits({"same": ["light"]}, ABC[0], ABC[1])
    with pytest.raises(UsageError, match="which d does not tell"):
        fits({"same": ["light"]}, ABC[0], recorded("d"))


@pytest.mark.parametrize(
    ("config", "said"),
    [
        ({}, "no recordings to evaluate on"),
        ({"log": ["x/a.mcap", "y/a.mcap"]}, "two recordings are called a"),
        ({"recordings": {"a": {"light": "day"}}}, "names neither log nor source"),
        ({"recordings": ["a.mcap"]}, "recordings must be a mapping, {NAME: FILE}"),
        ({"log": ["a"], "conditions": {"pattern": "("}}, "is no pattern"),
        ({"make": {"source": {}, "vary": {}}}, "make lacks name"),
        (
            {"make": {"source": {}, "vary": {"run": [1]}, "name": "{light}", "path": "x"}},
            "cannot be filled in",
        ),
    ],
)
def test_recordings_that_make_no_sense(config, said):
    with pytest.raises(UsageError) as error:
        recordings_of({"source": {"plugin": "mcap"}, **config})
    assert said in str(error.value)


def test_names_tell_conditions():
    config = {
        "source": {"plugin": "mcap"},
        "log": ["kth/night_2.mcap", "kth/day_1.mcap"],
        "conditions": {"pattern": r"(?P<light>\w+)_(?P<run>\d)"},
    }
    found = recordings_of(config)
    assert [dict(each.metadata) for each in found] == [
        {"light": "night", "run": "2"},
        {"light": "day", "run": "1"},
    ]


def test_derived_conditions_need_a_whole_table():
    assert derived({"run": "3"}, {"half": {"run": {3: "second"}}}) == {"run": "3", "half": "second"}
    with pytest.raises(UsageError, match="says nothing of run '5'"):
        derived({"run": "5"}, {"half": {"run": {3: "second"}}})
