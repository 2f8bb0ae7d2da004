"""What is told of progress, by a clock that the tests set."""

from __future__ import annotations

import threading
from collections.abc import Iterable

import pytest
from rich.console import Console

from placecue.board import Board, duration, telling
from placecue.plain_progress import PlainLines


class Clock:
    """A clock that stands still until it is told to go on."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def run(items: Iterable[int], seconds: float, total: int | None = None) -> list[str]:
    clock, said = Clock(), list[str]()
    for _ in PlainLines(said.append, clock)(items, "classifying", total):
        clock.now += seconds
    return said


def test_a_line_every_ten_seconds() -> None:
    assert run(range(12), 2.5) == [
        "classifying 4 of 12 (10 s)",
        "classifying 8 of 12 (20 s)",
        "classifying 12 of 12 (30 s)",
    ]
    assert run((i for i in range(2)), 60) == ["classifying 1 (60 s)", "classifying 2 (120 s)"]
    assert run((i for i in range(2)), 30, total=9)[1] == "classifying 2 of 9 (60 s)"


def test_nothing_for_what_ends_sooner() -> None:
    assert run(range(9), 1.1) == []


def test_loops_within_loops_share_the_lines() -> None:
    clock, said = Clock(), list[str]()
    lines = PlainLines(said.append, clock)
    for cue in lines(["crfh", "laser"], "training", None):
        for _ in lines(range(3 if cue == "crfh" else 2), "searching", None):
            clock.now += 4 if cue == "crfh" else 15
    # The second search is told of only once it has lasted long enough by itself.
    assert said == [
        "training 0 of 2, searching 3 of 3 (12 s)",
        "training 1 of 2, searching 1 of 2 (27 s)",
        "training 1 of 2, searching 2 of 2 (42 s)",
    ]


def test_a_board_by_hand() -> None:
    clock = Clock()
    board = Board(clock)
    board.add("Exp 1", 10, done=4)
    board.add("Exp 2", 4)
    assert board.left() is None
    for seconds in (2, 4):
        clock.now += seconds
        board.done("Exp 1", failed=seconds == 4)
    assert board.left() is None  # two are too few
    clock.now += 6
    board.done("Exp 1")
    # 3 of Exp 1 are left and 4 of Exp 2, of which only the mean of all, 4 s, is known.
    assert board.left("Exp 1") == pytest.approx(12)
    assert board.left("Exp 2") is None
    assert board.left() == pytest.approx(28)
    assert board.line() == "Exp 1 7 of 10 (1 failed), Exp 2 0 of 4 (12 s, about 28 s left)"
    for _ in range(3):
        clock.now += 20
        board.done("Exp 2")
    # Each experiment by its own: 3 of 4 s, 1 of 20 s.
    assert board.left() == pytest.approx(32)
    clock.now += 5
    assert board.left() == pytest.approx(27)
    clock.now += 1000  # stuck: the estimate goes no further down than by a mean one, 12 s
    assert board.left() == pytest.approx(20)


def test_a_board_before_its_pairs() -> None:
    clock = Clock()
    board = Board(clock)
    assert board.line() == "preparing (0 s)"
    board.step("recordings made", 3, 12)
    board.add("Exp 1", 3, done=1)
    clock.now += 20
    assert board.line() == "recordings made 3 of 12 (20 s)"
    board.step("")
    clock.now += 4
    board.done("Exp 1")
    # What went before the pairs is no measure of them.
    assert board.rows["Exp 1"].spans == [4]
    assert board.line() == "Exp 1 2 of 3 (24 s)"


def test_a_board_that_is_full() -> None:
    board = Board(Clock())
    board.add("Exp 1", 1)
    board.done("Exp 1")
    assert board.left() == 0
    assert board.line() == "Exp 1 1 of 1 (0 s, about 0 s left)"


def test_a_board_as_a_table() -> None:
    board = Board(Clock())
    board.add("Exp 1", 12, done=12)
    board.add("Exp 2", 24)
    board.done("Exp 2", failed=True)
    console = Console(width=80)
    with console.capture() as shown:
        console.print(board)
    rows = [line.split() for line in shown.get().splitlines()]
    assert rows == [
        ["experiment", "done", "of", "failed", "time", "left"],
        ["Exp", "1", "12", "12", "done"],
        ["Exp", "2", "1", "24", "1"],
        ["all", "13", "36", "1"],
    ]


def test_a_board_through_a_pipe() -> None:
    """Lines come though nothing is finished."""
    board, said, twice = Board(Clock()), list[str](), threading.Event()
    board.add("Exp 1", 2)

    def say(line: str) -> None:
        said.append(line)
        if len(said) == 2:
            twice.set()

    with telling(board, say, every=0.001):
        assert twice.wait(60)
    assert set(said) == {"Exp 1 0 of 2 (0 s)"}


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(4.4, "4 s"), (89, "89 s"), (100, "2 min"), (5300, "88 min"), (7800, "2 h 10 min")],
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words
