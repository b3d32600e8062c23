"""Read a diagnosis: the fields of the contract's JSON that the score needs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from acquisition.errors import InputError

VERDICTS = ("named", "class", "unknown", "none")
NAN = float("nan")


@dataclass(frozen=True)
class Estimate:
    """A parameter as the diagnosis states it, in the contract's unit.

    Parameters
    ----------
    value, low, high : float
        Value and 95 % interval; nan where there is none.
    """

    value: float
    low: float = NAN
    high: float = NAN


@dataclass(frozen=True, eq=False)
class Row:
    """One set of effects of the ranking.

    Parameters
    ----------
    effects : frozenset of str
        The set.
    probability : float
        Of the set, among all that were compared and no effect at all [-].
    fit : float
        Probability that data of this set fit no better than these; nan where it is not stated [-].
    parameters : dict of str to Estimate
        By ``effect.parameter``.
    points : dict of str to tuple of int
        Test points that it names, by ``effect.parameter``.
    """

    effects: frozenset[str]
    probability: float
    fit: float = NAN
    parameters: dict[str, Estimate] = field(default_factory=dict)
    points: dict[str, tuple[int, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class Stated:
    """The mechanism that a diagnosis leads with.

    Parameters
    ----------
    channel, extent : str
        What is changed, and whether all over, at a place, at supports or in the measuring chain.
    locations : tuple of (x, y)
        Where it is; empty where it has no place [m].
    low, high : (x, y) or None
        95 % interval of the first of them; None likewise [m].
    probability : float
        That it is so, given that there is a cause [-].
    """

    channel: str
    extent: str
    locations: tuple[tuple[float, float], ...] = ()
    low: tuple[float, float] | None = None
    high: tuple[float, float] | None = None
    probability: float = NAN

    def to_json(self) -> dict[str, Any]:
        """Return it as the contract has it."""
        places = [[x, y, 0.0] for x, y in self.locations]
        ends = {"location_low95": self.low, "location_high95": self.high}
        return {
            "channel": self.channel,
            "extent": self.extent,
            "location": places[0] if places else None,
            "locations": places,
            **{name: None if at is None else [*at, 0.0] for name, at in ends.items()},
            "probability": _or_none(self.probability),
        }


@dataclass(frozen=True, eq=False)
class Answer:
    """What a diagnosis states.

    Parameters
    ----------
    verdict : {"named", "class", "unknown", "none"}
        Kind of answer.
    sets : tuple of frozenset of str
        Sets of effects that it does not rule out, most probable first.
    ranking : tuple of Row
        All sets it compared, most probable first.
    locations : tuple of (x, y)
        Places that it points to, most probable first [m].
    p_value : float
        Probability that chance alone makes such a gap [-].
    channel : str
        stiffness, mass, damping, measurement or none.
    channels : dict of str to float
        Probability of each [-].
    held_out : dict of str to float
        Errors on data held out, ``before_percent`` and so on [%].
    closed : Estimate or None
        Share of the gap that it states as closed [%].
    metric : str
        What the errors are of: frequency, damping, frf or combined.
    level : str
        At which level it is certain: story, mechanism, or empty for neither.
    mechanism : Stated or None
        The mechanism that it leads with; None where it has none.
    has_levels : bool
        Whether it states levels at all; those of earlier versions do not.
    """

    verdict: str
    sets: tuple[frozenset[str], ...]
    ranking: tuple[Row, ...] = ()
    locations: tuple[tuple[float, float], ...] = ()
    p_value: float = NAN
    channel: str = "none"
    channels: dict[str, float] = field(default_factory=dict)
    held_out: dict[str, float] = field(default_factory=dict)
    closed: Estimate | None = None
    metric: str = ""
    level: str = ""
    mechanism: Stated | None = None
    has_levels: bool = False

    @property
    def best(self) -> Row | None:
        """The most probable row, where the diagnosis names an effect or a class."""
        return self.ranking[0] if self.verdict in ("named", "class") and self.ranking else None

    @property
    def top(self) -> frozenset[str] | None:
        """The most probable set; empty for ``none``; None for ``unknown``."""
        if self.verdict == "none":
            return frozenset()
        return None if self.best is None else self.best.effects

    def row(self, effects: Collection[str]) -> Row | None:
        """Return the row of a set of effects."""
        wanted = frozenset(effects)
        return next((row for row in self.ranking if row.effects == wanted), None)

    def to_json(self) -> dict[str, Any]:
        """Return the answer as a diagnosis of the contract, parameters in the rows of the answer alone."""
        return {
            "p_value": _or_none(self.p_value),
            "where": {
                "channel": self.channel,
                "channels": self.channels,
                "locations": [[x, y, 0.0] for x, y in self.locations],
            },
            "cause": {
                "verdict": self.verdict,
                **self._levels(),
                "sets": [sorted(s) for s in self.sets],
                "ranking": [_row_json(row, stated=row.effects in self.sets) for row in self.ranking],
            },
            "shrink": {
                "metric": self.metric,
                "held_out": {name: _or_none(value) for name, value in self.held_out.items()},
                "closed_percent": None if self.closed is None else _estimate_json(self.closed),
            },
        }

    def _levels(self) -> dict[str, Any]:
        if not self.has_levels:
            return {}
        leading = None if self.mechanism is None else self.mechanism.to_json()
        return {"level": self.level or None, "mechanism": leading}


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
    cause, where, shrink = document["cause"], document["where"], document["shrink"]
    if cause["verdict"] not in VERDICTS:
        raise ValueError(f"verdict {cause['verdict']!r} is not one of {', '.join(VERDICTS)}")
    rows = sorted((_row(row) for row in cause["ranking"]), key=lambda row: -row.probability)
    places = list(where.get("locations") or ([where["location"]] if where.get("location") else []))
    closed = shrink.get("closed_percent")
    held_out = shrink.get("held_out") or {}
    return Answer(
        verdict=cause["verdict"],
        sets=tuple(frozenset(s) for s in cause["sets"]),
        ranking=tuple(rows),
        locations=tuple((float(p[0]), float(p[1])) for p in places),
        p_value=_number(document.get("p_value")),
        channel=str(where.get("channel", "none")),
        channels={name: _number(p) for name, p in (where.get("channels") or {}).items()},
        held_out={name: _number(v) for name, v in held_out.items() if name != "points"},
        closed=None if closed is None else _estimate(closed),
        metric=str(shrink.get("metric", "")),
        level=cause.get("level") or "",
        mechanism=_stated(cause.get("mechanism")),
        has_levels="level" in cause,
    )


def _stated(mechanism: Mapping[str, Any] | None) -> Stated | None:
    if mechanism is None:
        return None
    low, high = (mechanism.get(f"location_{end}95") for end in ("low", "high"))
    return Stated(
        channel=str(mechanism["channel"]),
        extent=str(mechanism["extent"]),
        locations=tuple((float(p[0]), float(p[1])) for p in mechanism["locations"]),
        low=None if low is None else (float(low[0]), float(low[1])),
        high=None if high is None else (float(high[0]), float(high[1])),
        probability=_number(mechanism["probability"]),
    )


def _row(row: Mapping[str, Any]) -> Row:
    stated = {n: p for n, p in row["parameters"].items() if not isinstance(p["value"], str)}
    points = {n: p["value"] for n, p in stated.items() if _is_points(p)}
    return Row(
        effects=frozenset(row["effects"]),
        probability=float(row["probability"]),
        fit=_number(row.get("fit_p_value")),
        parameters={n: _estimate(p) for n, p in stated.items() if n not in points},
        points={n: _points(value) for n, value in points.items()},
    )


def _is_points(parameter: Mapping[str, Any]) -> bool:
    return isinstance(parameter["value"], list | tuple) or parameter.get("unit") == "node"


def _points(value: float | Sequence[int]) -> tuple[int, ...]:
    return tuple(int(v) for v in value) if isinstance(value, Sequence) else (int(value),)


def _estimate(parameter: Mapping[str, Any]) -> Estimate:
    return Estimate(*(_number(parameter[key]) for key in ("value", "low95", "high95")))


def _number(value: Any) -> float:
    """Read a number; ``null`` means that it could not be determined."""
    return NAN if value is None else float(value)


def _row_json(row: Row, *, stated: bool) -> dict[str, Any]:
    points = {name: {"value": list(value), "unit": "node"} for name, value in row.points.items()}
    return {
        "effects": sorted(row.effects),
        "probability": row.probability,
        "fit_p_value": _or_none(row.fit),
        "parameters": {n: _estimate_json(e) for n, e in row.parameters.items()} | points if stated else {},
    }


def _estimate_json(estimate: Estimate) -> dict[str, float | None]:
    values = (estimate.value, estimate.low, estimate.high)
    return {key: _or_none(v) for key, v in zip(("value", "low95", "high95"), values, strict=True)}


def _or_none(value: float) -> float | None:
    """Turn what is not a finite number into what JSON calls null."""
    return value if abs(value) < float("inf") else None
