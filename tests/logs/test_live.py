"""A robot that is followed over a socket: both protocols, other speeds, gone and back, silent."""

from __future__ import annotations

from inspect import signature
from pathlib import Path
from threading import Thread

import pytest

from placecue import Observation
from placecue.errors import DataError, UsageError
from placecue.limits import limited
from placecue.logs import open_log
from placecue.logs.live.log import LiveLog
from placecue.logs.writing.writer import McapWriter
from recordings import same
from robots import READ, Follower, OldRobot, Recorded, free_port, recorded, robot, wait_for
from toys import Walk


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("live") / "walk.mcap"
    with McapWriter(path) as writer:
        for number in range(12):  # 2.2 s
            writer.write(Walk(rounds=1, stay=3, seed=1).at(number))
    return path


@pytest.fixture(scope="module")
def log(walk: Path) -> list[Recorded]:
    return recorded(walk)


@pytest.fixture(scope="module")
def read(walk: Path) -> list[Observation]:
    return list(open_log(walk))


def live(url: str, beginning: float = 0.3, **options: float | None) -> LiveLog:
    return LiveLog(url, **{"patience": None, "beginning": beginning, **options})


@pytest.mark.parametrize("speed", [1.0, 10.0])
def test_it_is_as_the_log_that_the_robot_sends(
    log: list[Recorded], read: list[Observation], speed: float
) -> None:
    with robot(log) as sends, Follower(live(sends.url)) as follower:
        sends.wait()
        sends.drive(speed)
        follower.wait(log)
    same(follower.observations, read)
    assert follower.live.dropped == {"observations": 0, "messages": 0}
    assert not follower.live.client.faults.counts


def test_the_older_protocol(log: list[Recorded], read: list[Observation]) -> None:
    sends = OldRobot(log)
    with Follower(live(sends.url)) as follower:
        sends.drive()
        follower.wait(log)
        wait_for(lambda: len(sends.asked) == 2)
    sends.vanish()
    same(follower.observations, read)
    # Once it is known what is read, no more of the rest is asked for.
    topics = list({channel.id: channel.topic for _, channel, _ in log}.values())
    wanted = sends.asked[0]["subscriptions"]
    left = {each["id"] for each in wanted if topics[each["channelId"] - 101] not in READ}
    assert sends.asked[1] == {"op": "unsubscribe", "subscriptionIds": sorted(left)}


def test_a_robot_that_comes_late_goes_and_comes_back(
    log: list[Recorded], read: list[Observation], caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO", "placecue")
    port, half = free_port(), len(log) // 2
    with Follower(live(f"ws://127.0.0.1:{port}", quiet=0.05)) as follower:
        wait_for(lambda: "cannot be reached" in caplog.text)
        with robot(log, port) as sends:
            sends.wait()
            wait_for(lambda: "nothing came for 0.05 s; waiting (it has" in caplog.text)
            sends.drive(part=slice(0, half))
            follower.wait(log[:half])
        wait_for(lambda: "is gone" in caplog.text)
        with robot(log, port) as sends:
            sends.wait(*READ)
            sends.drive(part=slice(half, None))
            follower.wait(log)
    assert "is back" in caplog.text
    assert follower.live.client.connections == 2
    same(follower.observations, read)


def test_what_does_not_keep_up_gets_the_newest(log: list[Recorded]) -> None:
    with robot(log) as sends:
        follows = live(sends.url, patience=0.0)
        sending = Thread(target=lambda: (sends.wait(), sends.drive()))
        sending.start()
        stamps = []
        for observation in follows:
            stamps.append(observation.stamp)
            if len(stamps) == 1:
                sending.join()
                wait_for(lambda: follows.client.received >= 12)
                follows.stop()
        assert stamps[-1] == 11 * 10**9 // 5
        assert stamps == sorted(stamps)
        assert len(stamps) + follows.dropped["observations"] == 12
        assert follows.dropped["observations"] > 0


def test_messages_that_are_too_large_are_refused(
    log: list[Recorded], caplog: pytest.LogCaptureFixture
) -> None:
    """What is larger is not taken in; the connection is given up, and that is said."""
    with limited({"message": 5000}):
        follows = live("ws://127.0.0.1:1")
    sends = OldRobot(log)
    follows.client.url = sends.url
    follows.client.start()
    wait_for(lambda: "too big" in caplog.text or "larger" in caplog.text)
    follows.stop()
    sends.vanish()


def test_it_can_be_stopped_before_anything_came() -> None:
    follows = live(f"ws://127.0.0.1:{free_port()}")
    Thread(target=follows.stop).start()
    with pytest.raises(DataError, match="stopped before there was an image or a scan"):
        next(iter(follows))


@pytest.mark.parametrize("address", ["run.mcap", "http://127.0.0.1", "ws://", "ws:/x"])
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(UsageError, match="is no address of a server"):
        LiveLog(address)


def test_a_stream_has_no_part_to_choose_and_waits_no_negative_time() -> None:
    assert {"start", "end"}.isdisjoint(signature(LiveLog).parameters)
    with pytest.raises(UsageError, match=r"source\.patience is -1"):
        LiveLog("ws://127.0.0.1:1", patience=-1)
