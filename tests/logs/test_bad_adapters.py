"""Adapters as anybody may have written them."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

from mcap_logs import SECOND, START
from misbehaving import MISDEEDS, interrupt
from placecue.errors import ContractError, Interrupted, UnusableObservation
from placecue.logs import open_log
from placecue.logs.adapters.base import Adapter
from placecue.logs.adapters.lookup import adapter_for
from placecue.observation import LaserScan, Pose2D

#: The third message of each topic.
THIRD = START + 2 * SECOND


class Odd(Adapter):
    """Takes a part out of messages of our own; answers for one of them what it was given."""

    def __init__(self, role: str, **answers: Any) -> None:
        self.role = role  # type: ignore[misc, assignment]
        self.answers = answers

    def stamp(self, message: Any) -> Any:
        return self._answer("stamp", message, message["stamp"])

    def value(self, message: Any, origin: str) -> Any:
        sound = {
            "image": lambda: np.zeros((4, 5, 3), np.uint8),
            "scan": LaserScan(np.zeros(3), np.ones(3), 0.0, 5.0),
            "pose": Pose2D(0.0, 0.0, 0.0),
            "label": "office",
            "transform": [],
        }
        return self._answer("value", message, sound[self.role])

    def frame(self, message: Any) -> Any:
        return self._answer("frame", message, "odom" if self.role == "pose" else "laser")

    def pixels(self, message: Any) -> Any:
        return self._answer("pixels", message, "rgb8")

    def _answer(self, method: str, message: Any, sound: Any) -> Any:
        if method in self.answers and message["stamp"] in (THIRD, START):
            if method in ("stamp", "value") and message["stamp"] == START:
                return sound
            return self.answers[method]()
        return sound


@pytest.fixture
def read(as_json: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Read five messages of one role by an odd adapter, beside five sound scans."""

    def read(odd: Odd) -> list[Any]:
        def found(encoding: str, schema: str) -> Adapter | None:
            return odd if schema == "odd.Thing" else adapter_for(encoding, schema)

        for module in ("items", "topics", "depth"):
            monkeypatch.setattr(f"placecue.logs.joining.{module}.adapter_for", found)
        log = as_json()
        for number in range(5):
            log.put("/odd", "odd.Thing", {"stamp": START + number * SECOND}, float(number))
            if odd.role != "scan":
                log.scan(float(number), [1.0, 2.0, 3.0])
        return list(open_log(log.close()))

    return read


@pytest.mark.parametrize("role", ["image", "scan", "pose", "label", "transform"])
def test_a_sound_one_of_each_role(read: Any, role: str) -> None:
    assert len(read(Odd(role))) == 5


@pytest.mark.parametrize("misdeed", MISDEEDS)
@pytest.mark.parametrize("method", ["stamp", "value"])
def test_a_message_that_it_fails_on_is_passed_over_and_counted(
    read: Any, caplog: pytest.LogCaptureFixture, method: str, misdeed: str
) -> None:
    deed, told = MISDEEDS[misdeed]
    with caplog.at_level(logging.WARNING):
        stamps = [each.stamp for each in read(Odd("scan", **{method: deed}))]
    assert stamps == [START + number * SECOND for number in (0, 1, 3, 4)]
    [line] = [each.getMessage() for each in caplog.records]
    who = f"adapter Odd ({__name__}): {method} failed: {told}"
    assert f"1 messages could not be used (the first: a message of /odd at {THIRD} does" in line
    assert f"not decode as odd.Thing: {who}" in line
    assert "\n" not in line


@pytest.mark.parametrize("method", ["stamp", "value"])
def test_an_interrupt_names_it(read: Any, method: str) -> None:
    said = rf"^interrupted in {method} of adapter Odd \({__name__}\)"
    with pytest.raises(Interrupted, match=said):
        read(Odd("scan", **{method: interrupt}))


@pytest.mark.parametrize(
    ("role", "method", "answer", "said"),
    [
        ("scan", "stamp", "soon", "stamp returned 'soon', not a whole number of ns"),
        ("scan", "stamp", 1.5, "stamp returned 1.5, not a whole number of ns"),
        ("scan", "value", [1.0], "value returned a list, not a LaserScan"),
        ("pose", "value", (0.0, 0.0), "value returned a tuple, not a Pose2D"),
        ("label", "value", 3, "value returned an int, not a text"),
        ("image", "value", np.zeros((2, 2)), "value returned a ndarray, not what decodes an image"),
        ("transform", "value", None, "value returned None, not a list of Transform"),
        ("transform", "value", ["base"], "value returned a list with a str in it"),
        ("scan", "frame", None, "frame returned None, not a text"),
        ("image", "pixels", 8, "pixels returned an int, not a text"),
    ],
)
def test_what_it_returns_wrongly_is_one_line(
    read: Any, role: str, method: str, answer: Any, said: str
) -> None:
    with pytest.raises(ContractError, match=rf"^adapter Odd \({__name__}\): {said}"):
        read(Odd(role, **{method: lambda: answer}))


def test_a_stamp_of_more_than_64_bits_is_damage(
    read: Any, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        assert len(read(Odd("scan", stamp=lambda: 10**30))) == 4
    assert f"a stamp of {10**30} ns" in caplog.text


def test_what_decodes_an_image_may_fail_too(read: Any) -> None:
    def decode() -> Any:
        raise ValueError("two\nlines")

    *_, observation = read(Odd("image", value=lambda: decode))[:3]
    said = f"^the image at stamp {THIRD} does not decode: ValueError: two lines$"
    with pytest.raises(UnusableObservation, match=said):
        _ = observation.image
