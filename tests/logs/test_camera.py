"""The camera is written beside each image, as other readers expect it."""

import json
import math
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from mcap_logs import START, jpeg
from placecue import EncodedImage, Observation, PinholeCamera
from placecue.logs import open_log
from placecue.logs.writing.writer import McapWriter
from placecue_office.simulator import Office

CAMERA = PinholeCamera(320, 240, 200.0, 210.0, 159.5, 119.5)
#: Of ROS's own documentation: rows of [fx 0 cx; 0 fy cy; 0 0 1], and the same with a zero column.
K = [200.0, 0.0, 159.5, 0.0, 210.0, 119.5, 0.0, 0.0, 1.0]
P = [200.0, 0.0, 159.5, 0.0, 0.0, 210.0, 119.5, 0.0, 0.0, 0.0, 1.0, 0.0]


def recorded(path: Path, encoding: str, camera: PinholeCamera | None) -> Path:
    with McapWriter(path, encoding=encoding, camera=camera) as writer:
        for number in range(3):
            writer.write(Observation(START + number, image=EncodedImage(jpeg(number))))
    return path


def test_ros_2(tmp_path: Path) -> None:
    with recorded(tmp_path / "a.mcap", "cdr", CAMERA).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [each[3] for each in reader.iter_decoded_messages(["/camera/camera_info"])]
    assert len(found) == 3
    info = found[1]
    assert (info.width, info.height, info.distortion_model) == (320, 240, "plumb_bob")
    assert list(info.k) == K
    assert list(info.p) == P
    assert list(info.r) == [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    assert list(info.d) == [0.0] * 5
    assert (info.binning_x, info.roi.width, info.roi.do_rectify) == (0, 0, False)
    assert info.header.stamp.nanosec == START % 1_000_000_000 + 1


def test_foxglove(tmp_path: Path) -> None:
    with recorded(tmp_path / "a.mcap", "json", CAMERA).open("rb") as file:
        messages = list(make_reader(file).iter_messages(["/camera/camera_info"]))
    assert [schema.name for schema, _, _ in messages] == ["foxglove.CameraCalibration"] * 3
    assert json.loads(messages[0][2].data)["K"] == K
    assert json.loads(messages[0][2].data)["P"] == P


@pytest.mark.parametrize("encoding", ["cdr", "json"])
def test_it_is_not_taken_for_an_image(tmp_path: Path, encoding: str) -> None:
    log = open_log(recorded(tmp_path / "a.mcap", encoding, CAMERA))
    assert len(list(log)) == 3
    assert recorded(tmp_path / "b.mcap", encoding, None).stat().st_size > 0


def test_the_office_has_one() -> None:
    camera = Office().camera
    assert (camera.width, camera.height, camera.cx, camera.cy) == (320, 240, 160, 120)
    assert camera.fx == pytest.approx(160 / math.tan(math.radians(34)))
    assert camera.fx == camera.fy
