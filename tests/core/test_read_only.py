"""Observations are read-only: what one component writes, another would see."""

import copy
import pickle
from collections.abc import Callable

import cv2
import numpy as np
import pytest

from placecue import EncodedImage, LaserScan, Observation, Pose2D, UnusableObservation
from placecue.observation import Origin, Recording
from placecue.read_only import read_only


def _image() -> np.ndarray:
    return np.arange(60, dtype=np.uint8).reshape(4, 5, 3)


def _scan() -> LaserScan:
    return LaserScan(np.linspace(-1, 1, 4), np.array([1.0, 2.0, 3.0, 4.0]), 0.0, 10.0)


def _observed() -> Observation:
    return Observation(
        5,
        image=_image(),
        scan=_scan(),
        pose=Pose2D(0, 0, 0),
        label="lab",
        origin=Origin(Recording("a", "1a"), 1),
    )


def _encoded() -> EncodedImage:
    return EncodedImage(cv2.imencode(".png", _image())[1].tobytes(), "png")


MAKERS: dict[str, Callable[[], Observation]] = {
    "as made": _observed,
    "relabelled": lambda: _observed().relabelled("office"),
    "with an origin": lambda: _observed().of_log("b"),
    "altered image": lambda: _observed().altered("darker", image=_image() // 2),
    "altered scan": lambda: _observed().altered("larger", scan=_scan().scaled(2.0)),
    "decoded": lambda: Observation(5, image=_encoded(), scan=_scan()),
    "decoded by anybody": lambda: Observation(5, image=_image, scan=_scan()),
    "copied": lambda: copy.copy(_observed()),
    "deeply copied": lambda: copy.deepcopy(_observed()),
    "from another process": lambda: pickle.loads(pickle.dumps(_observed())),
    "decoded, from another process": lambda: pickle.loads(
        pickle.dumps(Observation(5, image=_encoded(), scan=_scan()))
    ),
}


def _writes(array: np.ndarray) -> None:
    array[...] = 0


def _forces(array: np.ndarray) -> None:
    array.flags.writeable = True


def _forces_a_view(array: np.ndarray) -> None:
    array.view().setflags(write=True)


def _forces_a_part(array: np.ndarray) -> None:
    array[1:].flags.writeable = True


def _changes_in_place(array: np.ndarray) -> None:
    np.add(array, 1, out=array, casting="unsafe")


@pytest.mark.parametrize("attempt", [_writes, _forces, _forces_a_view, _forces_a_part])
@pytest.mark.parametrize("made", MAKERS)
def test_nothing_can_be_written_into_an_observation(
    made: str, attempt: Callable[[np.ndarray], None]
) -> None:
    observation = MAKERS[made]()
    assert observation.image is not None
    assert observation.scan is not None
    before = [observation.image.copy(), observation.scan.ranges.copy()]
    for array in (observation.image, observation.scan.angles, observation.scan.ranges):
        with pytest.raises(ValueError, match=r"read-only|WRITEABLE"):
            attempt(array)
    assert (observation.image == before[0]).all()
    assert (observation.scan.ranges == before[1]).all()


def test_nor_in_place() -> None:
    with pytest.raises(ValueError, match="read-only"):
        _changes_in_place(_observed().image)


def test_opencv_does_not_draw_into_it() -> None:
    with pytest.raises(cv2.error, match="readonly"):
        cv2.line(_observed().image, (0, 0), (3, 3), (255, 0, 0))


@pytest.mark.parametrize(
    "part", ["stamp", "image", "image_source", "scan", "pose", "label", "origin", "anything"]
)
def test_no_part_can_be_replaced(part: str) -> None:
    with pytest.raises(AttributeError, match=f"read-only, so {part} cannot be set"):
        setattr(_observed(), part, None)
    with pytest.raises(AttributeError, match=f"read-only, so {part} cannot be deleted"):
        delattr(_observed(), part)


def test_no_part_of_a_scan_can_be_replaced() -> None:
    with pytest.raises(AttributeError, match="cannot assign to field 'ranges'"):
        _observed().scan.ranges = np.zeros(4)


def test_one_s_own_arrays_stay_one_s_own() -> None:
    image, angles, ranges = _image(), np.linspace(-1, 1, 4), np.ones(4)
    observation = Observation(0, image=image, scan=LaserScan(angles, ranges, 0.0, 9.0))
    assert np.shares_memory(observation.image, image)
    assert np.shares_memory(observation.scan.ranges, ranges)
    image[0, 0] = (7, 8, 9)
    ranges[2] = 5.0
    assert observation.image[0, 0].tolist() == [7, 8, 9]
    assert observation.scan.ranges[2] == 5.0
    assert image.flags.writeable
    assert angles.flags.writeable


def test_copies_hold_the_same() -> None:
    for name in ("copied", "deeply copied", "from another process"):
        observation, made = _observed(), MAKERS[name]()
        assert (made.image == observation.image).all()
        assert (made.scan.ranges == observation.scan.ranges).all()
        parts = ("stamp", "label", "pose", "origin", "log_name")
        assert [getattr(made, part) for part in parts] == [
            getattr(observation, part) for part in parts
        ]


@pytest.mark.parametrize(
    "array",
    [
        np.arange(12.0).reshape(3, 4)[::-1, ::2],
        np.arange(24, dtype=">u2").reshape(2, 3, 4).transpose(2, 0, 1),
        np.broadcast_to(np.uint8(3), (4, 5, 3)),
        np.zeros((0, 5), np.float32),
        np.array(["2020-01-01"], dtype="datetime64[D]"),  # has no buffer to show
        np.frombuffer(b"abcd", np.uint8),
    ],
)
def test_any_array_is_shown_as_it_is(array: np.ndarray) -> None:
    shown = read_only(array)
    assert (shown.shape, shown.dtype) == (array.shape, array.dtype)
    assert shown.strides == array.strides or array.size == 0
    assert (shown == array).all()
    assert not shown.flags.writeable
    assert read_only(shown) is shown or array.dtype.kind == "M"


# ---------------------------------------------------------------------- what decodes wrongly


def test_what_an_image_raises_makes_the_observation_unusable() -> None:
    def broken() -> np.ndarray:
        raise OSError("disk\ngone")

    observation = Observation(7, image=broken).of_log("run1.mcap")
    with pytest.raises(UnusableObservation) as caught:
        _ = observation.image
    assert str(caught.value) == (
        "the image at stamp 7 of run1.mcap does not decode: OSError: disk gone"
    )


def test_an_image_that_is_none_makes_the_observation_unusable() -> None:
    with pytest.raises(UnusableObservation, match="the image at stamp 7 is a list, not an array"):
        _ = Observation(7, image=lambda: [1, 2]).image
