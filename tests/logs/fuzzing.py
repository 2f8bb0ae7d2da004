"""Spoils inputs of many kinds and reads them, watching what happens.

``python fuzzing.py COUNT SEED`` prints as JSON what became of COUNT cases: how many of each kind,
how many were refused, every exception that was not placecue's, what took too long, what was lost
before the damage, and what was lost without a word.
"""

from __future__ import annotations

import gzip
import json
import logging
import random
import signal
import sys
import tempfile
from base64 import b64encode
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1]))

from bags import drive
from mcap_logs import START, JsonLog, heading, jpeg
from placecue.errors import PlacecueError
from placecue.labels.rooms import read_rooms
from placecue.logs import open_log
from placecue.logs.bags.bag import BagFile
from placecue.logs.joining.labels import Intervals
from placecue.logs.mcap.container import LogFile
from placecue.logs.rosbag import RosbagLog
from placecue_sources.table import Table

SECONDS = 20
#: What stands where something else is due.
WRONG: tuple[Any, ...] = (
    *(None, True, -1, 0, 3.5, 1e308, 10**400, "", "x", "\ud800", [], [1], [[]], {}, {"x": 1}),
    *(float("nan"), float("inf"), "Infinity", -(2**63), 2**63, "1e900000"),
)
STEPS = 6
Message = tuple[str, str, dict[str, Any], float]


class TooSlow(BaseException):
    """A case took longer than anybody waits."""


class Found(NamedTuple):
    """What became of a case: refused or not, how much was lost, and whether that was said."""

    refused: bool = False
    lost_before: int = 0
    silent: int = 0


@contextmanager
def heard() -> Iterator[list[str]]:
    """Give what is warned of meanwhile."""
    said: list[str] = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("placecue")
    logger.addHandler(handler)
    try:
        yield said
    finally:
        logger.removeHandler(handler)


def whole_log() -> list[Message]:
    """Return the messages of a small log of Foxglove JSON."""
    found: list[Message] = []
    for step in range(STEPS):
        t = 0.1 * step
        stamp = START + round(t * 1e9)
        time = {"sec": stamp // 10**9, "nsec": stamp % 10**9}
        pose = {"position": {"x": t, "y": 0.0, "z": 0.0}, "orientation": heading(0.1)}
        if step % 3 == 0:
            label = {"stamp": stamp, "label": f"room {step}"}
            found.append(("/label", "placecue.Label", label, t))
        placed = {"timestamp": time, "frame_id": "map", "pose": pose}
        found.append(("/pose", "foxglove.PoseInFrame", placed, t))
        scan = {
            **{"timestamp": time, "frame_id": "base_link", "pose": pose, "start_angle": -1.0},
            **{"end_angle": 1.0, "ranges": [1.0, 2.0, 3.0], "intensities": []},
        }
        found.append(("/scan", "foxglove.LaserScan", scan, t))
        data = b64encode(jpeg(10 * step)).decode()
        image = {"timestamp": time, "frame_id": "cam", "format": "jpeg", "data": data}
        found.append(("/image", "foxglove.CompressedImage", image, t))
    return found


def spoilt(value: Any, rng: random.Random) -> Any:
    """Return JSON with something wrong at one place, or missing there."""
    if rng.random() < 0.35 or not isinstance(value, dict | list) or not value:
        return rng.choice(WRONG)
    if isinstance(value, list):
        at = rng.randrange(len(value))
        return [*value[:at], spoilt(value[at], rng), *value[at + 1 :]]
    key = rng.choice(sorted(value))
    if rng.random() < 0.15:
        return {name: each for name, each in value.items() if name != key}
    return {**value, key: spoilt(value[key], rng)}


def use(observations: Any) -> list[tuple[bool, bool, bool, bool]]:
    """Use every part of observations, as commands do; return which are there."""
    found = []
    for each in observations:
        try:
            image = each.image is not None
        except PlacecueError:
            image = False
        scan = each.scan is not None
        if each.scan is not None:
            each.scan.valid()
            each.scan.points()
            each.scan.mount.frame.encode()
        if each.pose is not None:
            each.pose.frame.encode()
        (each.label or "").encode()
        found.append((image, scan, each.pose is not None, each.label is not None))
    return found


def json_case(folder: Path, rng: random.Random) -> Found:
    """One message of a log says something of a wrong type."""
    messages = whole_log()
    at = rng.randrange(len(messages))
    log = JsonLog(folder / "case.mcap")
    for number, (topic, name, message, t) in enumerate(messages):
        log.put(topic, name, spoilt(message, rng) if number == at else message, t)
    path = log.close()
    with heard() as said:
        try:
            found = use(open_log(path))
        except PlacecueError as error:
            assert "\n" not in str(error), error  # noqa: PT017
            return Found(refused=True, lost_before=0 if at < 4 else at)
    missing = STEPS - sum(all(each[1:3]) for each in found)
    # A wrong stamp moves a message elsewhere, so that its neighbours go without it too.
    return Found(lost_before=max(missing - 2, 0), silent=int(missing > 0 and not said))


def bytes_spoilt(data: bytes, rng: random.Random) -> tuple[bytes, int]:
    """Return damaged bytes, and the first that is not as it was."""
    at = rng.randrange(len(data))
    length = min(rng.choice([1, 2, 8, 50, 500]), len(data) - at)
    way = rng.choice(["flip", "cut off", "cut out", "zero"])
    if way == "cut off":
        return data[:at], at
    if way == "cut out":
        return data[:at] + data[at + length :], at
    change = bytes(
        0 if way == "zero" else b ^ rng.randrange(1, 256) for b in data[at : at + length]
    )
    return data[:at] + change + data[at + length :], at


class Written:
    """A log written once, whose bytes are spoilt many times."""

    def __init__(self, path: Path, kind: Callable[[Path], Any], read: Callable[[str], Any]) -> None:
        self.data = path.read_bytes()
        self.suffix = path.suffix
        self.kind = kind
        self.read = read
        file = kind(path)
        self.messages = [each.data for each in file.messages(set(file.contents.channels))]

    def case(self, folder: Path, rng: random.Random) -> Found:
        """Damage some bytes; messages that lie before them in the file must be there."""
        data, first = bytes_spoilt(self.data, rng)
        path = folder / f"case{self.suffix}"
        path.write_bytes(data)
        # Where messages lie compressed they are not found, and nothing is asked of them here.
        due = Counter(m for m in self.messages if 0 <= self.data.find(m) <= first - len(m))
        with heard() as said:
            try:
                file = self.kind(path)
                got = Counter(m.data for m in file.messages(set(file.contents.channels)))
                use(self.read(str(path)))
            except PlacecueError as error:
                assert "\n" not in str(error), error  # noqa: PT017
                return Found(refused=True)
        fewer = len(self.messages) - got.total()
        return Found(lost_before=(due - got).total(), silent=int(fewer > 0 and not said))


def table_case(folder: Path, rng: random.Random) -> Found:
    """A table, or labels, of spoilt text."""
    rows = "".join(f"{i}.5,{i},0,0,1 2 {i}\n" for i in range(1, 8))
    labels = "".join(f"{i},{i}.5,room {i}\n" for i in range(1, 8))
    for name, text in (("t.csv", f"stamp,x,y,theta,scan\n{rows}"), ("l.csv", labels)):
        text = text if name == "t.csv" else f"start,end,label\n{text}"
        cells = text.split(",")
        at = rng.randrange(len(cells))
        cells[at] = str(rng.choice([*WRONG, "1e999999", '"', "\x00", "1;2,3", "1,5"]))
        data = ",".join(cells).encode("utf-8", "surrogatepass")
        if rng.random() < 0.5:
            data, _ = bytes_spoilt(data, rng)
        (folder / name).write_bytes(gzip.compress(data) if rng.random() < 0.1 else data)
    refused = 0
    for read in (
        lambda: use(Table(str(folder / "t.csv"))),
        lambda: Intervals.from_csv(folder / "l.csv"),
    ):
        try:
            read()
        except PlacecueError as error:
            assert "\n" not in str(error), error  # noqa: PT017
            refused += 1
    return Found(refused=refused > 0)


def rooms_case(folder: Path, rng: random.Random) -> Found:
    """Rooms of spoilt GeoJSON."""
    ring = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]
    feature = {
        "type": "Feature",
        "properties": {"class": "hall"},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }
    whole = {"type": "FeatureCollection", "features": [feature, feature]}
    data = json.dumps(spoilt(whole, rng)).encode()
    if rng.random() < 0.3:
        data, _ = bytes_spoilt(data, rng)
    if rng.random() < 0.05:
        data = b"[" * 100_000
    (folder / "r.geojson").write_bytes(data)
    try:
        read_rooms(folder / "r.geojson").at(1.0, 1.0)
    except PlacecueError as error:
        assert "\n" not in str(error), error  # noqa: PT017
        return Found(refused=True)
    return Found()


def kinds(folder: Path) -> dict[str, Callable[[Path, random.Random], Found]]:
    """Return what makes and reads a case, by kind."""
    made = drive(1, images=False)
    made.entries.sort(key=lambda entry: entry[2])
    plain = Written(Path(made.as_ros1(folder / "a.bag", chunk=1500)), BagFile, _bag)
    packed = Written(Path(made.as_ros1(folder / "b.bag", "LZ4", chunk=1500)), BagFile, _bag)
    two = drive(2, images=False)
    mcap = Written(Path(two.as_mcap(folder / "c.mcap")), LogFile, open_log)
    return {
        "json": json_case,
        "mcap": mcap.case,
        "bag": plain.case,
        "packed bag": packed.case,
        "tables": table_case,
        "rooms": rooms_case,
    }


def _bag(path: str) -> RosbagLog:
    return RosbagLog(path)


def _too_slow(*_: Any) -> None:
    raise TooSlow


def run(count: int, seed: int, only: str | None = None) -> dict[str, Any]:
    """Read so many cases and return what became of them."""
    rng = random.Random(seed)
    told: dict[str, Any] = {"cases": Counter(), "refused": Counter()}
    wrong: dict[str, list[str]] = {"foreign": [], "slow": [], "lost before": [], "silent": []}
    signal.signal(signal.SIGALRM, _too_slow)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        makers = kinds(folder)
        names = [only] if only else list(makers)
        for number in range(count):
            kind = names[number % len(names)]
            of_case = random.Random(rng.random())
            signal.alarm(SECONDS)
            try:
                found = makers[kind](folder, of_case)
            except TooSlow:
                wrong["slow"].append(f"{kind} {number}")
            except Exception as error:
                wrong["foreign"].append(f"{kind} {number}: {type(error).__name__}: {error!s:.200}")
            else:
                told["refused"][kind] += found.refused
                if found.lost_before:
                    wrong["lost before"].append(f"{kind} {number}: {found.lost_before}")
                if found.silent:
                    wrong["silent"].append(f"{kind} {number}")
            finally:
                signal.alarm(0)
            told["cases"][kind] += 1
    return {**told, **wrong}


if __name__ == "__main__":
    logging.getLogger("placecue").propagate = False
    print(json.dumps(run(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:4]), indent=1))
