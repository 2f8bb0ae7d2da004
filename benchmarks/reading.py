"""Messages a second of processor time read from a log, beside the plain ``mcap`` reader.

``python benchmarks/reading.py [SECONDS_OF_LOG]``
"""

import sys
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from mcap.reader import make_reader
from mcap.records import Schema
from mcap_ros2._dynamic import serialize_dynamic
from mcap_ros2.decoder import DecoderFactory

from placecue.logs import open_log
from placecue.logs.mcap.container import LogFile
from placecue.logs.messages.direct import direct_decoder
from placecue.logs.messages.kinds import Written
from placecue.logs.messages.ros2_messages import Ros2Dialect
from placecue.logs.writing.writer import McapWriter
from placecue.observation import PARTS, EncodedImage, LaserScan, Observation, Pose2D

RATE, BEAMS = 10, 361
#: A JPEG of 320 x 240, and 640 x 480 pixels of bgr8.
IMAGE_BYTES = {"small": 20_000, "large": 921_600}


def recorded(folder: Path, seconds: int, compression: str, size: str) -> Path:
    """Write a log: images that cannot be compressed, scans, odometry, transforms, labels."""
    rng = np.random.default_rng(0)
    path = folder / f"{size}-images-{compression}.mcap"
    angles = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
    with McapWriter(path, compression=compression) as writer:
        for i in range(seconds * RATE):
            scan = LaserScan(angles, rng.uniform(1, 5, BEAMS), 0.0, 30.0)
            image = EncodedImage(rng.bytes(IMAGE_BYTES[size]))
            pose, label = Pose2D(0.01 * i, 0.0, 0.0), f"room {i // 100}"
            stamp = 1_700_000_000_000_000_000 + i * 10**9 // RATE
            writer.write(Observation(stamp, image=image, scan=scan, pose=pose, label=label))
    return path


def plain(path: Path, checksums: bool = False) -> Callable[[], Iterable[object]]:
    def read() -> Iterable[object]:
        with path.open("rb") as file:
            yield from make_reader(file, validate_crcs=checksums).iter_messages()

    return read


def messages(path: Path) -> Callable[[], Iterable[object]]:
    def read() -> Iterable[object]:
        file = LogFile(path)
        return file.messages(file.contents.channels)

    return read


def again(path: Path) -> Callable[[], Iterable[object]]:
    file = LogFile(path)
    return lambda: file.messages(file.contents.channels)


def observations(path: Path, parts: Sequence[str] = PARTS) -> Callable[[], Iterable[object]]:
    log = open_log(path, parts=parts)
    return lambda: log


WAYS: dict[str, Callable[[Path], Callable[[], Iterable[object]]]] = {
    "peer: mcap's reader, no checksums": plain,
    "peer: mcap's reader, checksums": partial(plain, checksums=True),
    "messages, checksums compared": messages,
    "messages, in a later pass": again,
    "images and labels": partial(observations, parts=("image", "label")),
    "scans, poses and labels": partial(observations, parts=("scan", "pose", "label")),
    "all of every observation": observations,
}


def took(way: str, path: Path, repeats: int = 7) -> float:
    """Return the median time of reading, s; run in a process of its own, as memory is reused."""
    read = WAYS[way](path)
    times = []
    for _ in range(repeats):
        start = process_time()
        deque(read(), maxlen=0)
        times.append(process_time() - start)
    return float(np.median(times))


def reading(path: Path) -> None:
    count = LogFile(path).contents.counts.total()  # type: ignore[union-attr]
    print(f"{path.name}: {count} messages, {path.stat().st_size / 1e6:.0f} MB")
    peer = None
    for way in WAYS:
        with get_context("fork").Pool(1) as pool:
            own = pool.apply(took, (way, path))
        peer = peer or own
        print(f"  {way:<34} {count / own:9.0f} messages a second, {peer / own:.2f}x")


def microseconds(call: Callable[[], object], repeats: int = 2000) -> float:
    start = process_time()
    for _ in range(repeats):
        call()
    return 1e6 * (process_time() - start) / repeats


def coding() -> None:
    """One message at a time, against mcap_ros2's decoder and encoder."""
    scan = LaserScan(np.linspace(-1.5, 1.5, BEAMS), np.full(BEAMS, 2.5), 0.0, 30.0)
    dialect = Ros2Dialect()
    compare(dialect.scan(10**18, scan), ranges=[2.5] * BEAMS)
    compare(dialect.pose(10**18, Pose2D(1, 2, 3)))


def compare(written: Written, **lists: list[float]) -> None:
    name, text = written.type.name, written.type.schema
    schema = Schema(data=text, encoding="ros2msg", id=1, name=name)
    data = written.type.serialise(written.message)
    decode, direct = DecoderFactory().decoder_for("cdr", schema), direct_decoder("cdr", schema)
    encode = serialize_dynamic(name, text.decode())[name]
    assert decode is not None
    assert direct is not None
    for what, peer, own in (
        ("decode", lambda: decode(data), lambda: direct(data)),
        (
            "encode",
            lambda: encode({**written.message, **lists}),
            lambda: written.type.serialise(written.message),
        ),
    ):
        theirs, mine = microseconds(peer), microseconds(own)
        print(f"{name}: {what} mcap_ros2 {theirs:6.1f} us, placecue {mine:5.1f} us")


def main() -> None:
    length = int(sys.argv[1]) if len(sys.argv) > 1 else 120
    with TemporaryDirectory() as folder:
        for size, seconds in (("small", length), ("large", max(length // 10, 1))):
            for compression in ("none", "lz4", "zstd"):
                path = recorded(Path(folder), seconds, compression, size)
                reading(path)
                path.unlink()
    coding()


if __name__ == "__main__":
    main()
