"""What the app keeps: the study as it stands, and every state before it that can be had back."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

LONGEST = 500
"""States that are kept; a state takes a few kilobytes, so that an autosave is a megabyte at most."""


@dataclass(frozen=True)
class State:
    """A study as it stood, and what was done to bring it there.

    Parameters
    ----------
    text : str
        The tables of the study as JSON; a text, so that no state can be changed.
    label : str
        What was done.
    """

    text: str
    label: str

    @classmethod
    def of(cls, content: Mapping[str, Any], label: str) -> State:
        """Return the state of these tables."""
        return cls(json.dumps(content, ensure_ascii=False, allow_nan=False), label)

    @property
    def content(self) -> dict[str, Any]:
        """The tables, a copy."""
        found: dict[str, Any] = json.loads(self.text)
        return found

    def key(self, files: str, unread: Collection[str] = ()) -> str:
        """Return what results of this state are kept under, with a digest of what its files hold.

        ``unread`` are the tables that the work does not read: its result belongs to any state of them.
        """
        text = self.text
        if unread:
            read = {name: table for name, table in self.content.items() if name not in unread}
            text = json.dumps(read, ensure_ascii=False, allow_nan=False)
        return hashlib.sha256(f"{files} {text}".encode()).hexdigest()[:16]


@dataclass(frozen=True)
class History:
    """States in the order in which they came about, and which of them is shown.

    Parameters
    ----------
    states : tuple of State
        The first is the study as it was opened.
    position : int
        Which one is shown.
    """

    states: tuple[State, ...]
    position: int = 0

    @property
    def now(self) -> State:
        """The state that is shown."""
        return self.states[self.position]

    @property
    def undo_label(self) -> str | None:
        """What undo would take back; None where there is nothing."""
        return self.now.label if self.position else None

    @property
    def redo_label(self) -> str | None:
        """What redo would do again; None where there is nothing."""
        return self.states[self.position + 1].label if self.position + 1 < len(self.states) else None

    def labels(self, start: str) -> list[str]:
        """Return the rests of all labels up to now that begin with a text."""
        before = [state.label for state in self.states[: self.position + 1]]
        return [label.removeprefix(start) for label in before if label.startswith(start)]

    def then(self, content: Mapping[str, Any], label: str) -> History:
        """Return the history with a further state in place of those undone; itself where nothing changes."""
        state = State.of(content, label)
        if state.text == self.now.text:
            return self
        states = (*self.states[: self.position + 1], state)[-LONGEST:]
        return History(states, len(states) - 1)

    def undone(self) -> History:
        """Return the history one state back, as far as there is one."""
        return replace(self, position=max(self.position - 1, 0))

    def redone(self) -> History:
        """Return the history one state on, as far as there is one."""
        return replace(self, position=min(self.position + 1, len(self.states) - 1))
