from __future__ import annotations

import contextlib
import gzip
import logging
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue.errors import DataError, UsageError
from placecue.logs import McapLog
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage, Observation
from placecue_sources.stamps import nanoseconds
from placecue_sources.table import Table
from recordings import DATA, needs_data, packed, picture, same, write


def ranges_seen(observation: Observation) -> list[float]:
    assert observation.scan is not None
    return observation.scan.ranges.tolist()


def full(root: Path) -> Path:
    """A table with every part, its columns called like the keys."""
    for number in range(3):
        write(root / "images" / f"{number}.png", picture(number))
    return write(
        root / "drive.csv",
        "stamp,image,scan,x,y,theta,label,note\n"
        '10.5,images/0.png,"1 2 3",1,2,0.5,office,a\n'
        '10.7,images/1.png,"1.5,2.5,3.5",1.5,2,0.6,office,"b, c"\n'
        '10.9,images/2.png,"4;5;6",2,2,0.7,corridor,\n',
    )


def test_columns_called_like_the_keys(tmp_path: Path) -> None:
    source = Table(str(full(tmp_path)), conditions={"run": "1"})
    found = list(source)
    assert [o.stamp for o in found] == [10_500_000_000, 10_700_000_000, 10_900_000_000]
    assert [o.label for o in found] == ["office", "office", "corridor"]
    assert [ranges_seen(o) for o in found] == [[1, 2, 3], [1.5, 2.5, 3.5], [4, 5, 6]]
    poses = [(o.pose.x, o.pose.y, o.pose.theta, o.pose.frame) for o in found if o.pose]
    assert poses == [(1, 2, 0.5, "map"), (1.5, 2, 0.6, "map"), (2, 2, 0.7, "map")]
    scan = found[0].scan
    assert scan is not None
    np.testing.assert_allclose(np.rad2deg(scan.angles), [-90, 0, 90])
    assert [o.image_source.data for o in found if isinstance(o.image_source, EncodedImage)] == [
        picture(k) for k in range(3)
    ]
    assert source.count() == 3
    assert source.metadata == {"run": "1"}


def test_columns_can_be_mapped(tmp_path: Path) -> None:
    path = write(tmp_path / "a.tsv", "t\tyaw\tpx\tpy\troom\n1500\t90\t1\t2\thall\n")
    source = Table(
        str(path),
        columns={"stamp": "t", "theta": "yaw", "x": "px", "y": "py", "label": "room"},
        delimiter="\t",
        stamp_unit="ms",
        angle_unit="deg",
        frame="odom",
    )
    (seen,) = source
    assert (seen.stamp, seen.label, seen.scene) == (1_500_000_000, "hall", None)
    assert seen.pose is not None
    assert seen.pose.theta == pytest.approx(np.pi / 2)
    assert seen.pose.frame == "odom"


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("1700000000.123456789", "s", 1_700_000_000_123_456_789),
        ("1700000000123.5", "ms", 1_700_000_000_123_500_000),
        ("1700000000123456", "us", 1_700_000_000_123_456_000),
        ("1700000000123456789", "ns", 1_700_000_000_123_456_789),
        ("1.7e9", "s", 1_700_000_000_000_000_000),
        ("2023-11-14T22:13:20.5Z", "iso", 1_700_000_000_500_000_000),
        ("2023-11-14 23:13:20+01:00", "iso", 1_700_000_000_000_000_000),
        ("2023-11-14T22:13:20", "iso", 1_700_000_000_000_000_000),
    ],
)
def test_units_of_time(text: str, unit: str, expected: int) -> None:
    assert nanoseconds(text, unit) == expected


@pytest.mark.parametrize("text", ["", "x", "-1", "nan", "inf", "1e300", "1e999999999"])
def test_no_time(text: str) -> None:
    with pytest.raises(ValueError, match="time"):
        nanoseconds(text, "s")


def test_rows_without_times_are_numbered(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "x,y\n1,2\n3,4\n")
    found = list(Table(str(path), rate=4))
    assert [o.stamp for o in found] == [250_000_000, 500_000_000]
    assert [o.pose.theta for o in found if o.pose] == [0, 0]
    path = write(tmp_path / "b.csv", "stamp,x,y\nfirst,1,2\nsecond,3,4\n")
    assert [o.stamp for o in Table(str(path), stamp_unit="none", rate=4)] == [
        250_000_000,
        500_000_000,
    ]


def test_scans_in_files(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.array([[1.0, 2.0, 3.0]], dtype=np.float32))
    write(tmp_path / "b.csv", "4,5,6\n")
    write(tmp_path / "c.txt", "7\n8\n9\n")
    table = write(
        tmp_path / "t" / "t.csv", "stamp,scan\n1,a.npy\n2,b.csv\n3,c.txt\n4,\n5,1 nan inf"
    )
    found = list(Table(str(table), root=str(tmp_path)))
    assert [ranges_seen(o) for o in found[:3]] == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert found[3].scan is not None
    assert found[3].scan.valid().tolist() == [True, False, False]
    assert [o.stamp // 10**9 for o in found] == [1, 2, 3, 5]


def test_the_scanner_can_be_described(tmp_path: Path) -> None:
    table = write(tmp_path / "t.csv", "stamp,scan\n1,1 2 3 4\n")
    source = Table(str(table), field_of_view=360, clockwise=True, range_min=1.5, range_max=3.5)
    scan = next(iter(source)).scan
    assert scan is not None
    np.testing.assert_allclose(np.rad2deg(scan.angles), [-90, 0, 90, 180])
    # The first beam was at 180 degrees to the left, the others follow clockwise.
    assert scan.ranges.tolist() == [4, 3, 2, 1]
    assert scan.valid().tolist() == [False, True, True, False]


def test_gzip_quotes_and_marks(tmp_path: Path) -> None:
    text = '\ufeffstamp, label ,x,y\r\n1,"living\nroom",0,0\r\n2," bed ",0,0\r\n'
    path = write(tmp_path / "a.csv.gz", gzip.compress(text.encode()))
    assert [o.label for o in Table(str(path))] == ["living\nroom", "bed"]


def test_what_is_wrong_is_counted_and_said_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write(tmp_path / "0.png", picture(0))
    write(tmp_path / "empty.png", b"")
    rows = [
        "1,0.png,1 2 3,0,0,0",
        "3,gone.png,1 2 3,0,0,0",
        "2,empty.png,1 2 3,0,0,0",
        "4,0.png,1 2,0,0,0",
        "4,0.png,1 two 3,0,0,0",
        "5,0.png,gone.npy,0,0,0",
        "6,0.png,1 2 3,0,north,0",
        "7,0.png,1 2 3,0,nan,0",
        "7,0.png,1 2 3,0,1e300,0",
        "8,0.png,1 2 3,0,0,90",
        "soon,0.png,1 2 3,0,0,0",
        ",0.png,1 2 3,0,0,0",
        "8,0.png,1 2 3",
        "9,0.png,1 2 3,0,0,0,0",
        "10,gone.png,,,,",
        "1,0.png,1 2 3,0,0,0",
    ]
    table = write(tmp_path / "t.csv", "\n".join(["stamp,image,scan,x,y,theta", *rows]))
    with caplog.at_level(logging.WARNING):
        found = list(Table(str(table), reorder=3))
    assert [o.stamp // 10**9 for o in found] == [1, 2, 3, 4, 4, 5, 6, 7, 7, 8]
    assert len(caplog.records) == 1
    for words in (
        "4 rows do not parse and were left out (the first: line 12: 'soon' is not a time in s)",
        "3 images cannot be read",
        "3 scans cannot be read (the first: line 5: 2 beams where 3 are due)",
        "3 poses do not parse",
        "1 headings are more than a whole turn: if they are degrees, angle_unit=deg",
        "2 rows have the time of another",
        "1 rows hold no image, scan or pose",
        "1 rows are too far out of order",
    ):
        assert words in caplog.text, words


@settings(max_examples=60, deadline=None)
@given(garbage=st.binary(max_size=200))
def test_no_garbage_gives_another_error(
    tmp_path_factory: pytest.TempPathFactory, garbage: bytes
) -> None:
    path = tmp_path_factory.mktemp("garbage") / "t.csv"
    path.write_bytes(b"stamp,x,y,scan\n1,2,3,4 5\n" + garbage + b"\n2,3,4,5 6\n")
    assert next(iter(Table(str(path)))).stamp >= 0
    path.write_bytes(garbage)
    with contextlib.suppress(DataError, UsageError):
        list(Table(str(path)))


def named(root: Path) -> Path:
    folder = root / "set"
    for number, stamp in enumerate((7.5, 8.25, 6.5)):
        label = ("office", "hall")[number % 2]
        write(folder / label / f"cam_{stamp}_x{number}_y-{number}.png", picture(number))
    write(folder / "readme.txt", "x")
    return folder


NAMES = r"(?P<label>[^/]+)/cam_(?P<stamp>[0-9.]+)_x(?P<x>[-0-9.]+)_y(?P<y>[-0-9.]+)[.]png$"


def test_names_of_files_can_tell_it_all(tmp_path: Path) -> None:
    folder = named(tmp_path)
    source = Table(str(folder), pattern=NAMES)
    found = list(source)
    assert [o.stamp for o in found] == [6_500_000_000, 7_500_000_000, 8_250_000_000]
    assert [o.label for o in found] == ["office", "office", "hall"]
    assert [(o.pose.x, o.pose.y) for o in found if o.pose] == [(2, -2), (0, 0), (1, -1)]
    assert [o.image.mean() for o in found if o.image is not None] == [2, 0, 1]
    assert source.count() == 3
    tar = Table(str(packed(folder, tmp_path / "set.tar", shuffled=True)), pattern=NAMES)
    same(tar, source)


def test_names_without_times_come_in_natural_order(tmp_path: Path) -> None:
    for number in (1, 2, 10):
        np.save(write(tmp_path / f"s{number}.npy", b""), np.full(4, float(number)))
    found = list(Table(str(tmp_path), pattern=r"s\d+", columns={}))
    assert [ranges_seen(o)[0] for o in found] == [1, 2, 10]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"pattern": "("}, "no regular expression"),
        ({"pattern": "(?P<room>.)"}, "names none of stamp"),
        ({"pattern": "(?P<label>.)", "columns": {"label": "lbel"}}, "did you mean 'label'"),
        ({"columns": {"lable": "label"}}, "did you mean 'label'"),
        ({"columns": {"label": "rooom"}}, "available: image, label"),
        ({"stamp_unit": "h"}, "available: iso, ms, none, ns, s, us"),
        ({"angle_unit": "grad"}, "available: deg, rad"),
        ({"rate": 0}, "above 0"),
        ({"range_min": 5, "range_max": 5}, "above 5"),
        ({"parts": ["sound"]}, "available"),
        ({"delimiter": ""}, "one character"),
        ({"beams": 0}, "at least 1"),
    ],
)
def test_wrong_parameters_are_usage_errors(
    tmp_path: Path, parameters: dict[str, object], message: str
) -> None:
    path = full(tmp_path)
    with pytest.raises(UsageError, match=message) as caught:
        list(Table(str(tmp_path if "pattern" in parameters else path), **parameters))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_nothing_of_use_is_a_data_error(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "stamp,image\n1,gone.png\n")
    with pytest.raises(DataError, match="gives no observation: 1 images cannot be read"):
        list(Table(str(path)))
    with pytest.raises(DataError, match="it is empty"):
        list(Table(str(write(tmp_path / "b.csv", "stamp,image\n"))))
    with pytest.raises(DataError, match="fits the pattern"):
        list(Table(str(tmp_path), pattern="(?P<label>cat)"))
    with pytest.raises(UsageError, match="no file"):
        list(Table(str(tmp_path / "none.csv")))
    with pytest.raises(UsageError, match="separated by ';', give delimiter=';'"):
        list(Table(str(write(tmp_path / "d.csv", "stamp;x;y\n1;2;3\n"))))
    with pytest.raises(UsageError, match=r"names none of stamp.* but nothing"):
        list(Table(str(write(tmp_path / "c.csv", ""))))


def test_the_digest_follows_the_files_that_are_named(tmp_path: Path) -> None:
    path = full(tmp_path)
    digest = Table(str(path)).digest()
    assert digest == Table(str(path)).digest()
    assert digest != Table(str(path), field_of_view=90).digest()
    write(tmp_path / "images" / "1.png", picture(99))
    assert digest != Table(str(path)).digest()


def test_a_converted_table_is_the_same_log(tmp_path: Path) -> None:
    source = Table(str(full(tmp_path)))
    with McapWriter(tmp_path / "a.mcap", metadata=source.metadata) as writer:
        assert copy(source, writer) == 3
    for read, first in zip(McapLog(str(tmp_path / "a.mcap")), source, strict=True):
        assert (read.stamp, read.label) == (first.stamp, first.label)
        assert read.pose is not None
        assert first.pose is not None
        assert (read.pose.x, read.pose.y) == (first.pose.x, first.pose.y)
        assert read.pose.theta == pytest.approx(first.pose.theta)
        np.testing.assert_allclose(ranges_seen(read), ranges_seen(first))


def test_rows_can_be_chosen_by_a_column(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "stamp,x,y,run\n1,1,1,a\n3,2,2, b\n2,3,3,b\n")
    assert [o.stamp // 10**9 for o in Table(str(path), where={"run": "b"})] == [2, 3]
    with pytest.raises(UsageError, match="has no 'rum'; did you mean 'run'"):
        list(Table(str(path), where={"rum": "b"}))
    folder = named(tmp_path)
    assert Table(str(folder), pattern=NAMES, where={"label": "hall"}).count() == 1


@needs_data
def test_recorded_annotations_as_they_are() -> None:
    """The annotations of IDOL2 are a table; the counts are those given with them."""
    path = f"{DATA}/idol2/poses.csv.gz"
    runs = {f"dum_{light}{run}" for light in ("cloudy", "night", "sunny") for run in (1, 2, 3, 4)}
    assert sum(Table(path, where={"sequence": run}).count() for run in runs) == 11_440
    found = list(Table(path, where={"sequence": "dum_cloudy1"}))
    assert {o.label for o in found} == {"BO", "CR", "EO", "KT", "PA"}
    assert found[0].stamp == 1138915484_666_746_000
    # The rule that comes with the data: the printer area lies below y = 8.65.
    assert all((o.label == "PA") == (o.pose.y < 8.65) for o in found if o.pose)


@needs_data
def test_nyu_rooms_by_name(tmp_path: Path) -> None:
    """The images of the Kinect set, told by their names, come in the order of their numbers."""
    folder = Path(str(DATA)) / "nyuv2" / "rgb"
    source = Table(str(folder), pattern=r"\d+", columns={}, parts=["image"])
    assert source.count() == 504
    first = next(iter(source))
    assert first.image is not None
    assert first.image.shape == (480, 640, 3)
