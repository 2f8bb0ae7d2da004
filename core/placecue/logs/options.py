"""The parameters that every kind of log takes."""

# Annotations are types here and no texts: of a dataclass they are read in its subclasses' modules.
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from placecue.source import Source


@dataclass(eq=False, repr=False)
class LogOptions(Source):
    """A source that is a file of messages: which of them it takes, and how it joins them.

    Parameters
    ----------
    path : str
        The file.
    image_topic, scan_topic, pose_topic, label_topic : str, optional
        Topics to take; needed where several could give a part.
    labels : str, optional
        CSV file with the columns start, end, label (see :class:`Intervals`); it takes the place
        of a label topic.
    parts : list of str, optional
        What to read, of image, scan, pose and label; all by default. Topics of other parts are
        neither read nor asked about.
    tolerance : float
        How far apart an image and its scan, or a lone pose, may be, s; also how far a transform
        may be from the time it is needed at.
    window : float
        How late a message may be written against others of the same time, s.
    pose_gap : float
        How far apart two poses, or two transforms, may be to interpolate between them, s.
    silence : float or None
        Where the camera is silent so long, and five times the usual distance of its images, scans
        make the observations, s; None: images always do, and what is seen between them is lost.
    base_frame : str, optional
        The robot's own frame; base_link, base_footprint or base by default.
    laser_frame : str, optional
        The laser's frame, where the scans name a wrong one.
    pose_frame : str, optional
        The fixed frame to give poses in. By default that of the messages; where poses come from
        transforms map, world or odom, the first that exists.
    range_max : float
        The scanner's limit where messages do not say it (Foxglove's do not), m.
    transform_horizon : float
        How much is searched for transforms, from the first one on, s; more where they do not
        connect the frames that are needed.
    start, end : float, optional
        The part of the log to read, s from its first message by log time.
    """

    path: str
    image_topic: str | None = None
    scan_topic: str | None = None
    pose_topic: str | None = None
    label_topic: str | None = None
    labels: str | None = None
    parts: Sequence[str] | None = None
    tolerance: float = 0.1
    window: float = 1.0
    pose_gap: float = 1.0
    silence: float | None = 1.0
    base_frame: str | None = None
    laser_frame: str | None = None
    pose_frame: str | None = None
    range_max: float = 30.0
    transform_horizon: float = 10.0
    start: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        self.name = Path(self.path).name
