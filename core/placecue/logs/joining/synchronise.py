"""Messages of several topics joined by time, with a short look ahead and constant memory."""

from __future__ import annotations

import heapq
from bisect import bisect_right, insort
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from math import pi

from placecue.logs.joining.clock import Clock
from placecue.logs.joining.items import Item
from placecue.logs.joining.poses import Motion
from placecue.logs.joining.silence import Silence
from placecue.observation import Part, Pose2D

#: So few items of a topic are kept, however old they are.
FEW = 16


def _stamp(item: Item) -> int:
    return item.stamp


class Track:
    """The recent items of one topic, in order of time."""

    def __init__(self) -> None:
        self.items: list[Item] = []
        self.newest: int | None = None  # time of the item that came last

    def add(self, item: Item) -> None:
        """Take in an item."""
        insort(self.items, item, key=_stamp)
        self.newest = item.stamp

    def reaches(self, stamp: int) -> bool:
        """Tell whether the topic has got as far as a time."""
        return self.newest is not None and self.newest >= stamp

    def forget_before(self, stamp: int) -> None:
        """Drop what lies before a time, but for the last item of it."""
        keep = bisect_right(self.items, stamp, key=_stamp) - 1
        if keep > 0:
            del self.items[:keep]

    def forget_after(self, stamp: int) -> Item | None:
        """Drop what lies after a time; return the last item dropped, or None."""
        kept = bisect_right(self.items, stamp, key=_stamp)
        dropped = self.items[kept:]
        del self.items[kept:]
        return dropped[-1] if dropped else None

    def drop(self, item: Item) -> None:
        """Drop an item that turned out to be useless."""
        self.items.remove(item)
        if self.newest == item.stamp:
            self.newest = self.items[-1].stamp if self.items else None

    def around(self, stamp: int) -> tuple[Item | None, Item | None]:
        """Return the last item at or before a time and the first one after it."""
        after = bisect_right(self.items, stamp, key=_stamp)
        return (
            self.items[after - 1] if after else None,
            self.items[after] if after < len(self.items) else None,
        )

    def nearest(self, stamp: int, tolerance: int) -> Item | None:
        """Return the item nearest in time, no farther than the tolerance, ns."""
        near = [
            item
            for item in self.around(stamp)
            if item is not None and abs(item.stamp - stamp) <= tolerance
        ]
        return min(near, key=lambda item: abs(item.stamp - stamp), default=None)


@dataclass(frozen=True, slots=True)
class Match:
    """Items that belong together.

    Parameters
    ----------
    driver : Item
        The image, or the scan where there are none; its time is that of the observation.
    scan : Item or None
        The nearest scan within the tolerance.
    poses : tuple of Item
        The poses before and after, or the only one near enough, or none.
    label : Item or None
        The label event in force.
    """

    driver: Item
    scan: Item | None
    poses: tuple[Item, ...]
    label: Item | None


class Synchroniser:
    """Joins items to matches, in order of time.

    Items may come up to ``window`` later than others of the same time. A driver waits until
    every follower has got as far as its own time, but no longer than the window. Where the clock
    of the drivers jumps back by more than the window, matches go on from there: what waits is
    given first, what followers hold of the time after it is forgotten, and the label stays.
    Where images drive and the camera is silent, scans drive, at the usual distance of images.

    Parameters
    ----------
    driver : {"image", "scan"}
        The part that makes an observation.
    followers : iterable of {"scan", "pose"}
        The parts to wait for.
    tolerance : int
        How far apart a driver and its scan, or a lone pose, may be, ns.
    window : int
        How late items may come, ns.
    pose_gap : int
        How far apart two poses may be to interpolate between them, ns.
    silence : Silence or None
        When the drivers count as silent; None: scans never stand in.
    usable : callable, optional
        Tells whether a pose can be used; others are dropped, so that its neighbours are joined.
    motion : Motion, optional
        Transforms to wait for, too.
    labelled : bool
        Whether labels come: one that was recorded at the very time of a driver holds for it, also
        where it stands behind it.

    Attributes
    ----------
    late : int
        How many drivers came too late to keep the order and were left out.
    jumps : int
        How often the clock of the drivers jumped.
    repeated : int
        How many drivers have the stamp of the one before.
    stood_in : int
        How many scans stood in for images.
    first : dict of str to int
        Where ``late``, ``jump``, ``repeated`` and ``stood in`` were first seen, ns.
    """

    def __init__(
        self,
        driver: Part,
        followers: Iterable[Part],
        tolerance: int,
        window: int,
        pose_gap: int,
        *,
        silence: Silence | None = None,
        usable: Callable[[Item], bool] = lambda item: True,
        motion: Motion | None = None,
        labelled: bool = False,
    ) -> None:
        self.usable = usable
        self.motion = motion
        self.labelled = labelled
        self.driver = driver
        self.followers = tuple(followers)
        self.tolerance = tolerance
        self.window = window
        self.pose_gap = pose_gap
        self.late = 0
        self.jumps = 0
        self.repeated = 0
        self.stood_in = 0
        self.first: dict[str, int] = {}
        self._waits = bool(self.followers) or motion is not None
        self._clock = Clock(window)
        self._tracks: dict[str, Track] = {part: Track() for part in (*self.followers, "label")}
        self._recorded = Track()  # labels that have the recorder's time alone
        self._waiting: list[tuple[int, int, Item]] = []  # stamp, running number, driver
        self._number = 0
        self._silence = silence
        self._idle: list[Item] = []  # scans since the last image, which may come to stand in
        self._quiet: int | None = None  # since when there is no image: the last one
        self._taken: int | None = None  # the last image, or scan that stood in
        self._last: int | None = None
        # A time, and the poses next to it that can be used.
        self._beside: tuple[int | None, Item | None, Item | None] = (None, None, None)

    def push(self, item: Item) -> Iterator[Match]:
        """Take in an item and yield the matches that it completes."""
        if item.role == self.driver:
            tick = self._clock.tick(item)
            self._leave_out(tick.late)
            if tick.since is not None:
                yield from self._jump(tick.since, tick.wild)
            if tick.items and self._silence is not None:
                self._seen_again(max(each.stamp for each in tick.items), self._silence)
            for each in tick.items:
                self._wait(each)
        elif item.role == "label" and not item.stamped:
            self._recorded.add(item)
            return  # its time is the recorder's, and says nothing of the drivers' clock
        else:
            self._tracks[item.role].add(item)
            if item.role == "scan" and self._silence is not None:
                self._stand_in(item, self._silence)
        while self._waiting and self._ready(self._waiting[0][0], item):
            yield from self._pop()
        self._forget(item.stamp)

    def _wait(self, item: Item) -> None:
        heapq.heappush(self._waiting, (item.stamp, self._number, item))
        self._number += 1

    def _stand_in(self, scan: Item, silence: Silence) -> None:
        """Take in a scan that may have to stand in, and let those before it wait if they have to.

        The newest is held back: an image of its time may follow.
        """
        if self._quiet is None:
            self._quiet = scan.stamp
        # A little less than the period: scans do not come just when images would.
        before = self._idle[-1].stamp if self._idle else self._taken
        if before is not None and scan.stamp - before < 0.75 * silence.period:
            return
        self._idle.append(scan)
        if scan.stamp - self._quiet >= silence.after:
            self._stood_in(self._idle[:-1])
            del self._idle[:-1]

    def _seen_again(self, image: int, silence: Silence) -> None:
        """Let the scans wait that stood in until an image came, but for those of its time."""
        if self._quiet is not None and image - self._quiet >= silence.after:
            self._stood_in([s for s in self._idle if image - s.stamp >= silence.period / 2])
        self._idle.clear()
        self._quiet = self._taken = image

    def _stood_in(self, scans: list[Item]) -> None:
        for scan in scans:
            self._wait(scan)
            self._taken = scan.stamp
            self.stood_in += 1
            self.first.setdefault("stood in", scan.stamp)

    def finish(self) -> Iterator[Match]:
        """Yield the matches of the drivers that still wait."""
        self._leave_out(self._clock.finish())
        if self._idle and self._silence is not None and self._quiet is not None:
            silent = self._idle[-1].stamp - self._quiet >= self._silence.after
            self._stood_in(self._idle if silent else [])
        while self._waiting:
            yield from self._pop()

    def _leave_out(self, item: Item | None) -> None:
        if item is not None:
            self.late += 1
            self.first.setdefault("late", item.stamp)

    def _jump(self, since: int, wild: bool) -> Iterator[Match]:
        """Go on at an earlier time."""
        self.jumps += 1
        self.first.setdefault("jump", since)
        self._idle.clear()
        self._quiet = self._taken = None
        if not wild:
            while self._waiting:
                yield from self._pop()
            label = self._tracks["label"]
            for track in self._tracks.values():
                dropped = track.forget_after(since + self.window)
                if track is label and dropped is not None and not label.around(since)[0]:
                    label.add(Item(since, "label", dropped.value))
            if self.motion is not None:
                self.motion.buffer.forget_after(since + self.window)
        self._last = None

    def _ready(self, stamp: int, newest: Item) -> bool:
        if self.labelled and newest.log_time == self._waiting[0][2].log_time:
            return False
        if not self._waits or newest.stamp - stamp >= self.window:
            return True
        if self.motion is not None and not self.motion.reaches(stamp):
            return False
        if not all(self._tracks[part].reaches(stamp) for part in self.followers):
            return False
        poses = self._tracks.get("pose")
        if poses is None:
            return True
        beside = self._usable_around(poses, stamp)
        if not poses.reaches(stamp):
            return False
        self._beside = stamp, *beside  # nothing comes in before it is used
        return True

    def _usable_around(self, poses: Track, stamp: int) -> tuple[Item | None, Item | None]:
        """Return the poses before and after a time, without those that cannot be used."""
        while True:
            before, after = poses.around(stamp)
            if before is not None and not (before.known or self.usable(before)):
                poses.drop(before)
            elif before is not None and before.stamp == stamp:
                return before, after
            elif after is not None and not (after.known or self.usable(after)):
                poses.drop(after)
            else:
                return before, after

    def _pop(self) -> Iterator[Match]:
        stamp, _, item = heapq.heappop(self._waiting)
        if self._last is not None and stamp < self._last:
            self._leave_out(item)
            return
        if stamp == self._last:
            self.repeated += 1
            self.first.setdefault("repeated", stamp)
        self._last = stamp
        scan = self._tracks.get("scan") if item.role == self.driver else None
        yield Match(
            item,
            None if scan is None else scan.nearest(stamp, self.tolerance),
            self._poses(stamp),
            self._label(item),
        )

    def _label(self, driver: Item) -> Item | None:
        """Return the label in force: by the recorder's clock where labels have no other."""
        stamped = self._tracks["label"].around(driver.stamp)[0]
        if not self._recorded.items:
            return stamped
        recorded = self._recorded.around(driver.log_time)[0]
        if stamped is None or recorded is None:
            return stamped or recorded
        return max(stamped, recorded, key=lambda each: each.log_time)

    def _poses(self, stamp: int) -> tuple[Item, ...]:
        track = self._tracks.get("pose")
        if track is None:
            return ()
        (known, before, after), self._beside = self._beside, (None, None, None)
        if known != stamp:
            before, after = self._usable_around(track, stamp)
        if before is not None and after is not None:
            if before.stamp == stamp:
                return (before,)
            if after.stamp - before.stamp <= self.pose_gap:
                return before, after
        nearest = track.nearest(stamp, self.tolerance)
        return () if nearest is None else (nearest,)

    def _forget(self, now: int) -> None:
        oldest = now - self.window
        if self._waiting:
            oldest = min(oldest, self._waiting[0][0])
        for track in self._tracks.values():
            if len(track.items) >= FEW:
                track.forget_before(oldest - self.tolerance)
        if self.motion is not None:
            self.motion.buffer.forget_before(oldest - self.tolerance - self.pose_gap)
        if len(self._recorded.items) >= FEW:
            times = [item.log_time for _, _, item in self._waiting]
            self._recorded.forget_before(min(times, default=0))


def interpolate(before: Pose2D, after: Pose2D, share: float) -> Pose2D:
    """Return the pose at a share of the way from one to another, turning the shorter way.

    Parameters
    ----------
    before, after : Pose2D
        Two poses in one frame.
    share : float
        0 gives ``before``, 1 gives ``after``.
    """
    turn = (after.theta - before.theta + pi) % (2 * pi) - pi
    return Pose2D(
        before.x + share * (after.x - before.x),
        before.y + share * (after.y - before.y),
        before.theta + share * turn,
        before.frame,
    )
