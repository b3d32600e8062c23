"""Faults of a hit: their kind, by which hits are counted, and how it shows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """A fault of one hit; as text it is a reason of the hit's verdict.

    Parameters
    ----------
    kind : str
        Which fault it is, the same for all hits that have it: ``double hit``.
    detail : str
        How it shows in this one.
    joint : str
        What stands between them in a sentence.
    """

    kind: str
    detail: str
    joint: str = ": "

    def __str__(self) -> str:
        return f"{self.kind}{self.joint}{self.detail}"
