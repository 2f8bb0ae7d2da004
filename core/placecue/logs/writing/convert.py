"""Any source into MCAP."""

from __future__ import annotations

from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.logs.writing.kept import Kept
from placecue.logs.writing.writer import McapWriter
from placecue.progress import track
from placecue.source import Source


def copy(source: Source, writer: McapWriter, kept: Kept | None = None) -> int:
    """Write every observation of a source; what cannot be written is counted and said once.

    Parameters
    ----------
    source : Source
        Where observations come from.
    writer : McapWriter
        Where they go; open it with ``metadata=source.metadata``.
    kept : Kept, optional
        What else is copied beside them.

    Returns
    -------
    int
        How many were written.

    Raises
    ------
    DataError
        If there is not one to write.
    """
    faults, total = Faults(), 0
    if kept is not None:
        kept.begin(writer.output)
    for observation in track(source, f"converting {source.name}", source.count()):
        total += 1
        if kept is not None:
            kept.until(observation.stamp)
        try:
            writer.write(observation)
        except UnusableObservation as error:
            faults.pass_over(error)
    if total == 0:
        raise DataError(f"{source.name} holds no observation: there is nothing to write")
    if kept is not None:
        kept.until(None)
    faults.report_of(total)
    return total - faults.passed_over
