"""What can be used of the content of files, in words."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition import Dof, UffContent
from acquisition.display import counted

NAMED = 12
"""So many degrees of freedom are named in one line."""


def usable(content: UffContent) -> list[str]:
    """Return what can be used of files: nodes, hits, FRFs and modes, each in a line."""
    parts = [counted(len(content.geometry.nodes), "node")] if content.geometry.nodes else []
    for test in content.tests:
        count = sum(p.count for p in test.points)
        hit, seen = [p.reference for p in test.points], [d for p in test.points for d in p.responses]
        parts.append(
            f"{counted(count, 'hit')} at {_places(hit)}, seen at {_places(seen)}, {test.samples} samples at "
            f"{test.rate:g} Hz"
        )
    if content.frfs is not None:
        f = content.frfs
        span = f"{f.frequency[0]:g} to {f.frequency[-1]:g} Hz in steps of {f.df:g} Hz"
        where = f"hit at {_places(f.references)}, seen at {_places(f.responses)}"
        parts.append(f"{counted(len(f.responses), 'FRF')} ({f.form}), {where}, {span}")
    if content.modal is not None:
        parts.append(counted(len(content.modal), "mode"))
    return parts


def _places(dofs: Sequence[Dof]) -> str:
    """Return how many points there are, and which, the first of many."""
    names = list(dict.fromkeys(str(dof) for dof in dofs))
    shown = ", ".join(names[:NAMED]) + (", ..." if len(names) > NAMED else "")
    return f"{counted(len(names), 'point')} ({shown})"
