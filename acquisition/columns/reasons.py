"""Why a proposed layout holds what it does: the comments beside its keys, by table and key."""

from __future__ import annotations

import re

HEADER = re.compile(r"\[\[?(\w+)\]\]?$")
KEY = re.compile(r"(?:# )?(\w+)(?: =|:) ")
"""How a line of a key begins; behind ``#`` it is one for which nothing can be proposed."""

Reasons = dict[tuple[str, int], dict[str, str]]
"""By table, "" for the top, and its number from 0: the reason for each key."""


def reasons_in(proposal: str) -> Reasons:
    """Return the reasons that :func:`~acquisition.columns.proposal.propose_layout` wrote into a layout.

    Parameters
    ----------
    proposal : str
        Its text.
    """
    table, counts = ("", 0), {"": 1}
    found: Reasons = {table: {}}
    for line in proposal.splitlines():
        header, key = HEADER.match(line), KEY.match(line)
        if header is not None:
            name = header[1]
            table = (name, counts.get(name, 0))
            counts[name] = table[1] + 1
            found[table] = {}
        elif key is not None:
            _, mark, why = line[key.end() :].partition("  # ")
            if line.startswith("# "):
                why = why if mark else line[key.end() :]
            if why:
                found[table].setdefault(key[1], why)
    return found
