"""What a person should know before trusting a map."""

from __future__ import annotations

from collections import Counter

from placecue.observation import Pose2D
from placecue.semantic_map import UNKNOWN, SemanticMap

#: An area that covers more of the way than this is looked at.
MOST_OF_THE_WAY = 0.6
#: And told of where fewer of the single beliefs than this have its label.
FEW_AGREE = 0.7


class Doubts:
    """Counts what speaks against a map while it grows.

    Parameters
    ----------
    advice : str
        What to do where one area covers most of the way though beliefs disagree.
    """

    def __init__(self, advice: str = "look at the single beliefs in its picture") -> None:
        self.advice = advice
        self.labels: Counter[str] = Counter()
        self.jumps = self.gaps = 0
        self.frames: list[str] = []
        self.unplaced = 0

    def count(self, label: str) -> None:
        """Take in the label of a belief that counts."""
        self.labels[label] += 1

    def broken(self, how: str, pose: Pose2D) -> None:
        """Take note that the way was broken off by a jump, a gap, or another frame."""
        if how == "frame":
            self.frames.append(pose.frame)
        elif how == "gap":
            self.gaps += 1
        else:
            self.jumps += 1

    def lines(self, semantic_map: SemanticMap) -> list[str]:
        """Return the doubts about a map, a line each."""
        told = [*self._swallowed(semantic_map)]
        if self.unplaced and semantic_map.areas and not semantic_map.nodes:
            told.append(
                "the log has no poses: areas are windows of 10 s, with a time and without a place"
            )
        elif self.unplaced:
            told.append(f"{self.unplaced} observations had no pose and are on no map")
        if self.jumps:
            told.append(
                f"the pose jumped {self.jumps} times: the map is broken off there, and smeared if "
                "the odometry began anew; poses of SLAM (source.pose_frame=map) do not"
            )
        if self.gaps:
            told.append(
                f"the log has {self.gaps} gaps over which the robot drove on unseen: the map is "
                "broken off there"
            )
        if self.frames:
            told.append(
                f"the frame of the poses changed {len(self.frames)} times, to "
                f"{', '.join(sorted(set(self.frames)))}: each change begins a part of the map "
                "that has nothing to do with the others"
            )
        return told

    def _swallowed(self, semantic_map: SemanticMap) -> list[str]:
        whole = sum(len(area.trajectory) for area in semantic_map.areas)
        largest = max(semantic_map.areas, key=lambda area: len(area.trajectory), default=None)
        if largest is None or largest.label == UNKNOWN or not self.labels:
            return []
        share = len(largest.trajectory) / max(whole, 1)
        agree = self.labels[largest.label] / self.labels.total()
        if share < MOST_OF_THE_WAY or agree > FEW_AGREE:
            return []
        return [
            f"area {largest.id} ({largest.label}) covers {100 * share:.0f} % of the way, and only "
            f"{100 * agree:.0f} % of the single beliefs say {largest.label}: places may be missing "
            f"from the map; {self.advice}"
        ]
