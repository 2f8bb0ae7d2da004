"""How accuracy grows with what is spent on cues: as a table, and as a picture."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from placecue.evaluation.pictures import save_picture

COST, RATE, CHOSEN, USED = "cost", "balanced_accuracy", "chosen", "used "
#: Okabe and Ito's colours, which most colour-blind people tell apart.
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#F0E442")
Curve = Mapping[str, Sequence[Any]]


def trade_off_table(curve: Curve) -> str:
    """Return the curve as CSV: a row a point.

    Parameters
    ----------
    curve : mapping of str to sequence
        ``trade_off_`` of an integrator; see :class:`placecue.Integrator`.
    """
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = {COST: "cost (ms)"}
    writer.writerow([names.get(name, name) for name in curve])
    writer.writerows(zip(*([_plain(each) for each in column] for column in curve.values()),
                         strict=True))  # fmt: skip
    return text.getvalue()


def draw_trade_off(curve: Curve, path: str | Path) -> Path:
    """Draw balanced accuracy, and for which share of the samples each cue is used, over cost.

    Parameters
    ----------
    curve : mapping of str to sequence
        ``trade_off_`` of an integrator; see :class:`placecue.Integrator`.
    path : str or Path
        Picture file to write; see :func:`placecue.evaluation.pictures.save_picture`.
    """
    from matplotlib.figure import Figure

    figure = Figure((6.4, 5.6), dpi=100, layout="constrained")
    rate, share = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    cost = curve[COST]
    rate.plot(cost, _percent(curve[RATE]), marker=".", color="#333333", lw=1)
    at = [n for n, chosen in enumerate(curve[CHOSEN]) if chosen]
    rate.plot([cost[n] for n in at], [100 * curve[RATE][n] for n in at], "o", color="#D55E00",
              ms=9, label="chosen")  # fmt: skip
    rate.set_ylabel("balanced accuracy (%)")
    rate.set_title("Accuracy over cost, on held-out samples", fontsize=10)
    rate.legend(loc="lower right", frameon=False)
    cues = [name for name in curve if name.startswith(USED)]
    for number, name in enumerate(cues):
        colour = COLOURS[number % len(COLOURS)]
        share.plot(cost, _percent(curve[name]), marker=".", lw=1, color=colour,
                   label=name.removeprefix(USED))  # fmt: skip
    for n in at:
        share.axvline(cost[n], color="#D55E00", lw=1)
    share.set_ylabel("used for (% of samples)")
    share.set_xlabel("mean cost of a sample (ms)")
    share.set_ylim(-4, 104)
    if cost[-1] > 5 * cost[0] > 0:
        share.set_xscale("log")
    share.legend(loc="center right", frameon=False)
    for axes in (rate, share):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", lw=0.6)
    return save_picture(figure, path)


def _percent(shares: Sequence[float]) -> list[float]:
    return [100 * share for share in shares]


def _plain(value: Any) -> Any:
    return str(value).lower() if isinstance(value, bool) else f"{value:.6g}"
