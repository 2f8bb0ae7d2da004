"""Joins what a match says of a pose with what was expected, direction by direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from placecue.slam.matching import Match
from placecue.slam.planar import Array, between, compose

#: Standard deviation of one end point's distance from its wall, m, and of what a whole match may
#: be wrong by at best: m, m, rad. Points of a wall are wrong together.
POINT, BEST = 0.05, np.array([0.005, 0.005, 0.001])
#: A direction that fewer points than this share tell is told by the prior alone.
TOLD = 0.04
#: So often a match is wrong altogether, whatever it says of itself.
WRONG = 0.02
#: A turn is weighed as the motion that it makes at this distance, m.
ARM = 3.0


@dataclass(frozen=True, slots=True)
class Estimate:
    """A pose and how sure it is.

    Parameters
    ----------
    pose : ndarray, shape (3,)
        x, y, heading.
    covariance : ndarray, shape (3, 3)
        In the pose's own axes.
    untold : int
        How many of the three directions no wall told.
    """

    pose: Array
    covariance: Array
    untold: int = 0


def told(match: Match, points: int) -> tuple[Array, int]:
    """Return the information of a match, with nothing in the directions that it cannot tell.

    Parameters
    ----------
    match : Match
        The match.
    points : int
        How many points were laid on the target.

    Returns
    -------
    information : ndarray, shape (3, 3)
        In 1/m², 1/rad² and so on.
    untold : int
        How many directions are left out.

    References
    ----------
    Zhang, Kaess, Singh, On degeneracy of optimization-based state estimation problems, ICRA 2016:
    directions are judged by the eigenvalues of the information, and what is not told is left as it
    was predicted.
    """
    scale = np.diag([1.0, 1.0, 1.0 / ARM])
    values, axes = np.linalg.eigh(scale @ match.information @ scale)
    known = values > TOLD * points
    kept = axes[:, known] * values[known] @ axes[:, known].T
    back = np.diag([1.0, 1.0, ARM])
    return back @ kept @ back / POINT**2, int((~known).sum())


def fused(match: Match, points: int, expected: Array, covariance: Array) -> Estimate:
    """Return the pose that match and prior together make the likeliest.

    Parameters
    ----------
    match : Match
        Where the scan fits.
    points : int
        How many points were laid on the target.
    expected : ndarray, shape (3,)
        Where it was expected.
    covariance : ndarray, shape (3, 3)
        Of what was expected.

    Notes
    -----
    The farther a match lies from what was expected, the likelier it is that scan and map are
    paired wrongly; the pose is taken from it, but as unsure as the two possibilities lie apart.
    """
    information, untold = told(match, points)
    prior = np.linalg.inv(covariance)
    joint = np.linalg.inv(information + prior)
    off = between(match.pose, expected)
    step = joint @ prior @ off
    # What both leave of the difference, the directions that the match does not tell left out.
    surprise = float(off @ (prior - prior @ joint @ prior) @ off)
    doubt = WRONG / (WRONG + (1 - WRONG) * np.exp(-surprise / 2))
    apart = off - step
    spread = joint + np.diag(BEST**2) + doubt * np.outer(apart, apart)
    return Estimate(compose(match.pose, step), spread, untold)
