"""Records of CURE text files: laser scans and odometry of the IDOL2 and COLD databases.

One record a line, separated by blanks. Fields, counted from 0:

- scans: 2 is the number of beams n, 3 and 4 are seconds and microseconds, 12 the angle from beam
  to beam (rad), 14 the longest range (m), and 16 to 15 + n are the ranges (m), beam 0 on the
  right. What is longer than the longest range was not measured (32.767 m in IDOL2).
- odometry: 3 and 4 are seconds and microseconds, 8 and 9 are x and y (m); the heading (rad) is
  field 11 of 14, after z, or field 10 of 13.

Sources: lines of IDOL2's ``dum_cloudy1``; public readers of COLD.
"""

from __future__ import annotations

import numpy as np

from placecue.observation import LaserScan
from placecue_sources.text_records import Fields

RANGES_FROM = 16
#: Where the heading stands in an odometry record, by the number of fields.
HEADING = {13: 10, 14: 11}


def stamp(fields: Fields) -> int:
    """Return the time of a record, ns.

    Raises
    ------
    ValueError, IndexError
        If the fields do not hold one.
    """
    seconds, microseconds = int(fields[3]), int(fields[4])
    if seconds < 0 or not 0 <= microseconds < 10**6:
        raise ValueError(f"a time of {seconds} s and {microseconds} us")
    return (seconds * 10**6 + microseconds) * 1000


def scan(
    fields: Fields, field_of_view: float | None = None, max_range: float | None = None
) -> LaserScan:
    """Return the scan of a record.

    Parameters
    ----------
    fields : sequence of bytes
        All of the record.
    field_of_view : float, optional
        Angle from the first to the last beam, degrees; by default what the record says.
    max_range : float, optional
        Longest range that is a measurement, m; by default what the record says.

    Raises
    ------
    ValueError, IndexError
        If there are more or fewer ranges than it says, or a field is no number.
    """
    beams = int(fields[2])
    found = len(fields) - RANGES_FROM
    if beams < 1 or found != beams:
        raise ValueError(f"{beams} beams promised, {max(found, 0)} ranges there")
    step, longest = float(fields[12]), float(fields[14])
    if field_of_view is not None:
        step = np.deg2rad(field_of_view) / max(beams - 1, 1)
    limit = longest if max_range is None else max_range
    if not 0 < step < 2 * np.pi or not limit > 0:
        raise ValueError(f"beams {step:g} rad apart with a longest range of {limit:g} m")
    return LaserScan(
        angles=step * (np.arange(beams, dtype=np.float64) - (beams - 1) / 2),
        ranges=np.array(fields[RANGES_FROM:]).astype(np.float64),
        range_min=0.0,
        range_max=limit,
    )


def odometry(fields: Fields) -> tuple[float, float, float]:
    """Return x (m), y (m) and heading (rad) of a record.

    Raises
    ------
    ValueError
        If it has not 13 or 14 fields, or one is no number.
    """
    if len(fields) not in HEADING:
        raise ValueError(f"{len(fields)} fields where 13 or 14 are due")
    return float(fields[8]), float(fields[9]), float(fields[HEADING[len(fields)]])
