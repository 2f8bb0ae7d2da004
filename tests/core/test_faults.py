"""What was passed over is counted by kind, and said once in one line."""

import logging

import pytest

from placecue import DataError, Faults, UnusableObservation


def test_each_kind_is_counted_with_its_first_example(caplog: pytest.LogCaptureFixture) -> None:
    faults = Faults("run1")
    for name in ("a.png", "b.png"):
        faults.add("images are missing", name)
    faults.add("scans do not parse", ValueError("two\n  lines \udcff"), 3)
    faults.add("labels are late", "none of them", 0)
    told = r"2 images are missing (the first: a.png); "
    told += r"3 scans do not parse (the first: two lines \udcff)"
    assert faults.told() == told
    with caplog.at_level(logging.WARNING):
        faults.report()
    assert [record.message for record in caplog.records] == [f"run1: {told}"]


def test_nothing_is_said_where_all_was_well(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG):
        Faults("run1").report()
        Faults("run1").report_of(0)
    assert Faults("run1").told() == ""
    assert caplog.records == []


@pytest.mark.parametrize(("where", "before"), [("", ""), ("run1", "run1: ")])
def test_observations_passed_over(
    caplog: pytest.LogCaptureFixture, where: str, before: str
) -> None:
    faults = Faults(where)
    first, second = UnusableObservation("no scan at 3"), UnusableObservation("no scan at 4")
    faults.pass_over(first)
    faults.pass_over(second)
    assert faults.passed_over == 2
    told = "2 of {} observations passed over; the first: no scan at 3"
    with caplog.at_level(logging.WARNING):
        faults.report_of(5)
    assert [record.message for record in caplog.records] == [before + told.format(5)]
    with pytest.raises(DataError) as caught:
        faults.report_of(2)
    assert str(caught.value) == f"{before}no usable observation: {told.format(2)}"
    assert caught.value.__cause__ is first
