"""One trial, opened: what was hidden, what was answered, and the seal that proves the first came before the second."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.seal import Seal
from modalkit.blind.shrunk import Shrinkage
from modalkit.blind.trial import Truth
from modalkit.output.whole import plain


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """One trial, opened.

    Parameters
    ----------
    index : int
        Number of the trial [-].
    truth : Truth
        What was hidden.
    answer : Answer or None
        What the diagnosis stated; None where it failed.
    document : mapping or None
        The diagnosis as JSON, without the modes of the gap; None where it failed.
    failure : str or None
        Message of a diagnosis that failed.
    sealed : Seal
        Statement and salt; its commitment was announced before the diagnosis began.
    seconds : float
        Time the diagnosis took [s].
    shrinkage : Shrinkage or None
        How far the answer closes the gap on the rig itself; None where it names nothing that the rig can do.
    """

    index: int
    truth: Truth
    answer: Answer | None
    document: Mapping[str, Any] | None
    failure: str | None
    sealed: Seal
    seconds: float
    shrinkage: Shrinkage | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the outcome as JSON can carry it; the truth is the sealed statement."""
        content: dict[str, Any] = plain(
            {
                "index": self.index,
                "statement": self.sealed.statement,
                "salt": self.sealed.salt,
                "document": self.document,
                "failure": self.failure,
                "seconds": round(self.seconds, 3),
                "shrinkage": None if self.shrinkage is None else asdict(self.shrinkage),
            }
        )
        return content

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Outcome:
        """Return the outcome that :meth:`to_json` wrote; the seal is not checked here.

        Raises
        ------
        InputError
            If the diagnosis in it is none.
        KeyError, TypeError, ValueError
            If something is missing or of another kind.
        """
        text, shrunk = document["document"], document["shrinkage"]
        return cls(
            index=document["index"],
            truth=Truth.from_json(json.loads(document["statement"])),
            answer=None if text is None else read_answer(text),
            document=text,
            failure=document["failure"],
            sealed=Seal(document["statement"], document["salt"]),
            seconds=float(document["seconds"]),
            shrinkage=None if shrunk is None else Shrinkage(**shrunk),
        )


def slim(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a diagnosis without the modes of its gap, which no score looks at."""
    gap = {key: value for key, value in document.get("gap", {}).items() if key not in ("modes", "frac")}
    return {**document, "gap": gap}
