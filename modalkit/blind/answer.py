"""Read a diagnosis: the few fields of the contract's JSON that the score needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.errors import InputError

VERDICTS = ("named", "class", "unknown", "none")


@dataclass(frozen=True)
class Estimate:
    """A parameter as the diagnosis states it, in the contract's unit.

    Parameters
    ----------
    value, low, high : float
        Value and 95 % interval.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Answer:
    """What a diagnosis says.

    Parameters
    ----------
    verdict : {"named", "class", "unknown", "none"}
        Kind of answer.
    sets : tuple of frozenset of str
        Sets of effects that it does not rule out.
    ranking : tuple of (frozenset, probability)
        All sets it compared, most probable first.
    parameters : dict
        Estimates of the rows that consist of one effect, by ``effect.parameter``.
    locations : tuple of float
        Places along the beam that it points to [m].
    closed : float or None
        Share of the gap that it says is closed [%].
    """

    verdict: str
    sets: tuple[frozenset[str], ...]
    ranking: tuple[tuple[frozenset[str], float], ...]
    parameters: dict[str, Estimate]
    locations: tuple[float, ...]
    closed: float | None

    @property
    def top(self) -> frozenset[str] | None:
        """The most probable set; empty for ``none``; None for ``unknown``."""
        if self.verdict == "none":
            return frozenset()
        if self.verdict == "unknown" or not self.ranking:
            return None
        return self.ranking[0][0]

    def probability(self, names: tuple[str, ...]) -> float:
        """Return the probability given to single effects of some names together [-]."""
        return sum(p for effects, p in self.ranking if len(effects) == 1 and next(iter(effects)) in names)


def read_answer(document: Mapping[str, Any]) -> Answer:
    """Read a diagnosis.

    Parameters
    ----------
    document : mapping
        As ``diagnose --json`` writes it.

    Returns
    -------
    Answer
        What counts for the score.

    Raises
    ------
    InputError
        If the document is not a diagnosis of the contract.
    """
    try:
        return _read(document)
    except (KeyError, TypeError, AttributeError, IndexError, ValueError) as error:
        raise InputError(
            f"the diagnosis does not follow modalkit.diagnosis/1: {type(error).__name__} {error}"
        ) from error


def _read(document: Mapping[str, Any]) -> Answer:
    cause, where = document["cause"], document["where"]
    if cause["verdict"] not in VERDICTS:
        raise ValueError(f"verdict {cause['verdict']!r} is not one of {', '.join(VERDICTS)}")
    rows = sorted(cause["ranking"], key=lambda row: -float(row["probability"]))
    parameters = {
        name: Estimate(*(_number(p[key]) for key in ("value", "low95", "high95")))
        for row in reversed(rows)
        if len(row["effects"]) == 1
        for name, p in row["parameters"].items()
        if not isinstance(p["value"], list)
    }
    places = list(where.get("locations") or ([where["location"]] if where.get("location") else []))
    closed = document["shrink"].get("closed_percent")
    return Answer(
        verdict=cause["verdict"],
        sets=tuple(frozenset(s) for s in cause["sets"]),
        ranking=tuple((frozenset(row["effects"]), float(row["probability"])) for row in rows),
        parameters=parameters,
        locations=tuple(float(place[0]) for place in places),
        closed=None if closed is None else _number(closed["value"]),
    )


def _number(value: Any) -> float:
    """Read a number; ``null`` says that it could not be determined."""
    return float("nan") if value is None else float(value)
