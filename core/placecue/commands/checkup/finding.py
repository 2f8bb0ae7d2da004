"""What the doctor found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

State = Literal["ok", "note", "wrong"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at.

    Parameters
    ----------
    state : {"ok", "note", "wrong"}
        A note is no fault: something optional that is not there, say.
    what : str
        What was looked at.
    found : str
        What it is like, in one line.
    mend : str
        What to do, where there is something to do.
    """

    state: State
    what: str
    found: str
    mend: str = ""

    def __str__(self) -> str:
        mend = f"; {self.mend}" if self.mend else ""
        return f"{self.state:<6}{self.what}: {self.found}{mend}"
