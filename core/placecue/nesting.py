"""How deep brackets lie in one another in JSON, told before it is parsed."""

from __future__ import annotations

import re

from placecue.errors import DataError
from placecue.limits import current_limits

#: A text, which may hold brackets, or a bracket.
TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[][{}]', re.DOTALL)


def check_depth(text: str, what: str) -> None:
    """Refuse JSON that is nested deeper than the limit: parsers of it run out of stack.

    Parameters
    ----------
    text : str
        The JSON.
    what : str
        What it is, for messages.

    Raises
    ------
    DataError
        If it is nested too deep.
    """
    depth, most = 0, current_limits().depth
    for token in TOKEN.finditer(text):
        bracket = token[0]
        if bracket in "[{":
            depth += 1
            if depth > most:
                raise DataError(
                    f"{what} has brackets nested deeper than limits.depth={most} allows"
                )
        elif bracket in "]}":
            depth -= 1
