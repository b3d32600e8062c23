"""Where on the structure: beams and plates as a plan, with zones, test points and the places found."""

from __future__ import annotations

import numpy as np

from acquisition.quantities import probability
from modalkit.output.location import localisation_title
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.outline import Outline, outline
from updating import Case, Diagnosis


def place_chart(diagnosis: Diagnosis, case: Case) -> Chart | None:
    """Return the plan of a beam or a plate; None for matrices and decks, which are drawn in space.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case
        What was diagnosed, the first of several.
    """
    if case.spec.imported is not None:
        return None
    body = outline(diagnosis, case)
    beam = body.width == 0
    tall = 0.12 * body.length if beam else body.width
    series = [_zones(diagnosis, case, body, tall)]
    across = np.full(len(body.points), tall / 2) if beam else body.points[:, 1]
    text = [f"test point {n}" for n in case.measured.nodes]
    series.append(
        Series(
            "test point",
            "points",
            body.points[:, 0],
            across,
            "ink",
            {"hollow": True, "text": text, "size": 3.5},
        )
    )
    if len(body.sensors):
        along, own = body.sensors[:, 0], np.full(len(body.sensors), tall / 2) if beam else body.sensors[:, 1]
        more = {"symbol": "square", "size": 5, "hollow": True, "text": ["sensor"] * len(body.sensors)}
        series.append(Series("sensor", "points", along, own, "ink", more))
    if diagnosis.verdict in ("named", "class") and diagnosis.where.locations:
        series.append(_places(diagnosis, body, tall))
    series += _clamps(body, tall)
    edge = 0.06 * body.length
    return Chart(
        "place",
        localisation_title(diagnosis),
        _text(diagnosis, body),
        Axis("", range=(-edge, body.length + edge)),
        Axis("", range=(-edge, tall + edge)),
        series,
        more={"equal": (tall + 2 * edge) / (body.length + 2 * edge), "bare": True},
    )


def _zones(diagnosis: Diagnosis, case: Case, body: Outline, tall: float) -> Series:
    none = diagnosis.verdict == "none"
    low, high, bottom, top, held = (np.array(c) for c in zip(*body.zones, strict=True))
    if body.width == 0:
        bottom, top = np.zeros(len(low)), np.full(len(low), tall)
    names = [r.name for r in case.spec.regions]
    text = [n if none else f"{n}\nprobability {probability(v)}" for n, v in zip(names, held, strict=True)]
    written = ["" if none or v < 0.005 else f"{100 * v:.0f} %" for v in held]
    more = {
        "low": low, "high": high, "bottom": bottom, "top": top, "value": 0 * held if none else held,
        "written": written, "text": text,
    }  # fmt: skip
    return Series("zone", "cells", (low + high) / 2, (bottom + top) / 2, "blue", more)


def _places(diagnosis: Diagnosis, body: Outline, tall: float) -> Series:
    flat = [body.flat(at) for at in diagnosis.where.locations]
    text = [
        f"place {i + 1}\nx = {x:.4g} m" + (f", y = {y:.4g} m" if body.width else "")
        for i, (x, y) in enumerate(flat)
    ]
    more = {"text": text, "symbol": "diamond", "size": 6}
    return Series(
        "place found",
        "points",
        [x for x, _ in flat],
        [y if body.width else tall for _, y in flat],
        "orange",
        more,
    )


def _clamps(body: Outline, tall: float) -> list[Series]:
    edges = {
        "x0": ((0.0, 0.0), (0.0, tall)),
        "x1": ((body.length, body.length), (0.0, tall)),
        "y0": ((0.0, body.length), (0.0, 0.0)),
        "y1": ((0.0, body.length), (tall, tall)),
    }
    return [
        Series("clamped edge", "line", *edges[name], "clamp", {"unnamed": i > 0})
        for i, name in enumerate(body.clamped)
    ]


def _text(diagnosis: Diagnosis, body: Outline) -> str:
    size = f"{body.length:.4g} m long" + (
        f", {body.width:.4g} m wide" if body.width else "; drawn thicker than it is"
    )
    if diagnosis.verdict == "none":
        return f"The structure with its test points, {size}. Nothing is to be placed."
    by = (
        "if that zone alone were changed: a hint at most"
        if diagnosis.where.zones_by == "regions"
        else "that the cause sits there"
    )
    return f"Each zone with the probability {by}. {size[:1].upper()}{size[1:]}."
