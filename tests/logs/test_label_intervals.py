"""Labels from a CSV beside the log."""

from __future__ import annotations

from pathlib import Path

import pytest

from mcap_logs import START
from placecue.errors import DataError
from placecue.limits import limited
from placecue.logs import open_log
from placecue.logs.joining.labels import Intervals


def write(folder: Path, text: str) -> str:
    path = folder / "labels.csv"
    path.write_text(text)
    return str(path)


def test_seconds_nanoseconds_and_iso_mean_the_same(tmp_path: Path) -> None:
    # 1700000000 s after the epoch is 2023-11-14 22:13:20 UTC.
    path = write(
        tmp_path,
        "start,end,label\n"
        "1700000000.25,1700000001,office\n"
        "1700000001000000000,1700000002000000000,corridor\n"
        "2023-11-14T22:13:22Z,2023-11-14T23:13:23.5+01:00,kitchen\n",
    )
    found = Intervals.from_csv(path)
    assert found.starts == (START + 250_000_000, START + 10**9, START + 2 * 10**9)
    assert found.ends == (START + 10**9, START + 2 * 10**9, START + 3_500_000_000)


def test_the_start_belongs_to_an_interval_and_the_end_does_not(tmp_path: Path) -> None:
    found = Intervals.from_csv(write(tmp_path, "label, start, end\noffice, 1, 2\nlab, 3, 4\n"))
    times = [0.5, 1.0, 1.9, 2.0, 2.5, 3.0, 4.0]
    labels = [found.at(round(t * 10**9)) for t in times]
    assert labels == [None, "office", "office", None, None, "lab", None]


def test_intervals_take_the_place_of_the_label_topic(small_log: str, tmp_path: Path) -> None:
    path = write(tmp_path, "start,end,label\n1700000000.5,1700000001.5,lab\n")
    labels = [each.label for each in open_log(small_log, labels=path)]
    assert labels == [None] * 5 + ["lab"] * 10 + [None] * 5


@pytest.mark.parametrize("cut", [";", "\t"])
def test_tables_of_spreadsheets_with_decimal_commas(tmp_path: Path, cut: str) -> None:
    rows = [["start", "end", "label"], ["1,5", "2,25", "one, two"]]
    found = Intervals.from_csv(write(tmp_path, "\n".join(cut.join(row) for row in rows)))
    assert (found.starts, found.ends) == ((1_500_000_000,), (2_250_000_000,))
    assert found.labels == ("one, two",)


@pytest.mark.parametrize("text", ["start,end,label\n1,2,K\xfcche\n", "\xff\xfes\0t\0"])
def test_text_of_other_encodings_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "labels.csv").write_bytes(text.encode("latin-1"))
    with pytest.raises(DataError, match="save them as UTF-8"):
        Intervals.from_csv(tmp_path / "labels.csv")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must name the columns start,end,label"),
        ("start,stop,label\n1,2,a\n", "it has start,stop,label"),
        ("start,end,label\n", "holds no labels"),
        ("start,end,label\n1,2,a\nsoon,4,b\n", "line 3, start: 'soon' is not a time"),
        ("start,end,label\n1,2,a\n3\n", "line 3, end: '' is not a time"),
        ("start,end,label\n1,2,\n", "line 2: no label"),
        ("start,end,label\n2,2,a\n", "line 2: the interval ends"),
        ("start,end,label\n1,3,a\n2,4,b\n", "line 3: the interval overlaps"),
        ("start,end,label\nnan,3,a\n", "'nan' is not a time"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(DataError) as caught:
        Intervals.from_csv(write(tmp_path, text))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file(small_log: str) -> None:
    with pytest.raises(DataError, match="cannot read the labels"):
        list(open_log(small_log, labels="/nowhere.csv"))


@pytest.mark.parametrize(
    "rows",
    [
        "0,4,office\n4,8,corridor",  # seconds from the beginning
        "1700000000000,1700000004000,office",  # milliseconds
        "1700000000000000,1700000004000000,office",  # microseconds
    ],
)
def test_intervals_of_another_clock_are_refused_with_both_spans(
    small_log: str, tmp_path: Path, rows: str
) -> None:
    path = write(tmp_path, f"start,end,label\n{rows}\n")
    with pytest.raises(DataError, match="never meet the log") as raised:
        list(open_log(small_log, labels=path))
    assert path in str(raised.value)
    assert small_log in str(raised.value)
    assert "1700000000.000 s (2023-11-14 22:13:20 UTC)" in str(raised.value)


def test_intervals_of_another_day_are_told(
    small_log: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write(tmp_path, "start,end,label\n1700090000,1700090060,office\n")
    log = open_log(small_log, labels=path)
    assert {each.label for each in log} == {None}
    list(log)
    (record,) = [each for each in caplog.records if "never meet" in each.message]
    assert "1700090000.000 s" in record.message


@pytest.mark.parametrize("time", ["1e900000", "1e999999", "-1e900000", "9" * 5000])
def test_a_time_of_a_million_digits_is_refused_at_once(tmp_path: Path, time: str) -> None:
    path = write(tmp_path, f"start,end,label\n0,{time},office\n")
    with pytest.raises(DataError, match="line 2, end: ") as raised:
        Intervals.from_csv(path)
    assert len(str(raised.value)) < 300


def test_more_rows_than_the_limit_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, "start,end,label\n0,1,a\n1,2,b\n")
    with limited({"rows": 1}), pytest.raises(DataError, match=r"more than limits\.rows=1"):
        Intervals.from_csv(path)
