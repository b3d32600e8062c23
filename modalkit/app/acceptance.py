"""From a row of a diagnosis to the effects that a study puts into its model."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from acquisition import ModalData
from acquisition.errors import InputError, ModalkitError
from modalkit.study.stated_effects import BEFORE, accepted_values, check_repeated
from updating import LIBRARY
from updating.diagnosis.answer.ranked import Ranked
from updating.effects import accepted_state, names_of
from updating.prediction.predict import Predictor


@dataclass(frozen=True)
class Offer:
    """What acceptance of a row would put into the study.

    Parameters
    ----------
    entries : list of dict, optional
        Those of ``[[model.effect]]``; None where the row cannot be accepted.
    why_not : str
        Why it cannot; "" where it can.
    """

    entries: list[dict[str, Any]] | None
    why_not: str = ""


def acceptable(effects: Sequence[str]) -> bool:
    """Return whether the effects of a row can be put into the model: there are some, and none is a hypothesis."""
    return bool(effects) and all(name in LIBRARY for name in effects)


def offer(
    row: Ranked, predictor: Predictor, there: Sequence[str] = (), *, since_baseline: bool = False
) -> Offer:
    """Return what acceptance of a row would put into the study, checked as the study checks it.

    Parameters
    ----------
    row : Ranked
        Of a diagnosis.
    predictor : Predictor
        The model it was found on.
    there : sequence of str
        Effects that are in the model already.
    since_baseline : bool
        Whether it was found beside a baseline, so that it came afterwards.
    """
    if not row.effects:
        return Offer(None)
    values = {
        name: {"value": list(one.value) if isinstance(one.value, tuple) else one.value}
        for name, one in row.parameters.items()
    }
    try:
        check_repeated([*there, *row.effects])
        entries = accepted_entries(
            {"effects": row.effects, "parameters": values}, predictor, since_baseline=since_baseline
        )
        for entry in entries:
            name, stated = accepted_values(entry, predictor.spec.kind)
            accepted_state(predictor, name, stated)
    except ModalkitError as error:
        return Offer(None, str(error))
    return Offer(entries)


def exchanged_points(
    entries: Sequence[Mapping[str, Any]], modal: ModalData, fixed: Collection[int]
) -> tuple[list[dict[str, Any]], dict[str, list[float]]]:
    """Return entries without those of exchanged labels, and the places of the points after the exchange.

    Points exchange their places in the test. An entry stays an effect where a place is not known, or where one of
    the two points has a fixed sensor or hammer beside the roving one, which was not moved.

    Parameters
    ----------
    entries : sequence of mapping
        Those of ``[[model.effect]]``.
    modal : ModalData
        The modes of the test, with the places of its points.
    fixed : collection of int
        Nodes that are both hit and measured.
    """
    kept: list[dict[str, Any]] = []
    places: dict[str, list[float]] = {}
    for entry in entries:
        points = list(entry.get("points", ()))
        known = len(points) == 2 and all(p in modal.geometry and p not in fixed for p in points)
        if LIBRARY[entry["name"]].exchanges and known:
            first, second = modal.geometry.at(points).tolist()
            places |= {str(points[0]): second, str(points[1]): first}
        else:
            kept.append(dict(entry))
    return kept, places


def accepted_entries(
    row: Mapping[str, Any], predictor: Predictor, *, since_baseline: bool = False
) -> list[dict[str, Any]]:
    """Return the entries of ``[[model.effect]]`` that a row of the ranking is.

    Parameters
    ----------
    row : mapping
        As the document of a diagnosis has it; what only follows from the parameters is left out.
    predictor : Predictor
        The model it was found on.
    since_baseline : bool
        Whether it was found beside a baseline, so that it came afterwards.

    Raises
    ------
    InputError
        If a hypothesis is among them.
    """
    if not acceptable(row["effects"]):
        own = next(name for name in row["effects"] if name not in LIBRARY)
        raise InputError(
            f"{own!r} is a hypothesis of the study, and hypotheses cannot be put into the model; change its deck or "
            "matrices"
        )
    entries = []
    seen: dict[str, int] = {}
    for name in row["effects"]:
        seen[name] = seen.get(name, 0) + 1
        key = name if seen[name] == 1 else f"{name}#{seen[name]}"
        effect = LIBRARY[name]
        takes = {p.name for p in effect.parameters(predictor)} | set(effect.labels) | {"channel"}
        takes |= names_of(effect, predictor.spec)
        values = {
            parameter: estimate["value"]
            for whole, estimate in row["parameters"].items()
            for own, _, parameter in [whole.rpartition(".")]
            if own == key and parameter in takes
        }
        entries.append({"name": name} | values | ({BEFORE: False} if since_baseline else {}))
    return entries
