"""What became of the scans of a log, counted."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Account:
    """Counts of observations, and of what was done about them.

    Parameters
    ----------
    scans : int
        Observations with a scan.
    still : int
        Of them, those of a robot that had not moved: nothing had to be laid on anything.
    matched : int
        Those whose scan was laid on the map.
    untold : int
        Of these, those where the walls left a direction open, as in a corridor.
    familiar : int
        Times that the robot came to a place that the map had already; nothing was added.
    few : int
        Scans with too few end points to say anything.
    unmatched : int
        Scans that lay on nothing seen before; odometry alone was followed.
    stopped : int
        Those that showed a robot in motion whose odometry stood still.
    without : int
        Observations without odometry: the robot was taken to go on as it did.
    jumps : int
        Times that odometry said what cannot be.
    lost : int
        Times that a new piece of the map was begun, with a guess of how it hangs together.
    disordered : int
        Observations not later than the one before; they moved nothing.
    loops, confirmed, refused : int
        Loops closed, loops that said what was known, and loops that contradicted the rest.
    """

    scans: int = 0
    still: int = 0
    matched: int = 0
    untold: int = 0
    familiar: int = 0
    few: int = 0
    unmatched: int = 0
    stopped: int = 0
    without: int = 0
    jumps: int = 0
    lost: int = 0
    disordered: int = 0
    loops: int = 0
    confirmed: int = 0
    refused: int = 0

    def told(self) -> str:
        """Return all that happened, in one line."""
        parts = [f"{self.matched} of {self.scans} scans laid on the map"]
        notes = (
            (self.still, "of a standing robot"),
            (self.untold, "in corridors, along which odometry counts"),
            (self.familiar, "times at places that the map had"),
            (self.few, "with too few end points"),
            (self.unmatched, "unlike all before, placed by odometry"),
            (self.stopped, "in motion while odometry stood still"),
            (self.without, "observations without odometry"),
            (self.jumps, "jumps of odometry passed over"),
            (self.lost, "times begun anew, as the robot may have been carried"),
            (self.disordered, "observations out of order of time"),
        )
        parts += [f"{count} {what}" for count, what in notes if count]
        parts.append(f"{self.loops} loops closed")
        parts += [f"{self.confirmed} confirmed"] if self.confirmed else []
        parts += [f"{self.refused} refused"] if self.refused else []
        return ", ".join(parts)
