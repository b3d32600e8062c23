"""Where on the structure: beams and plates as a plan, with zones, test points and the places found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.quantities import probability
from modalkit.output.location import localisation_title
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.outline import Outline, outline
from updating import Case, Diagnosis


def place_chart(diagnosis: Diagnosis, case: Case | None) -> Chart | None:
    """Return the plan of a beam or a plate; None for matrices and decks, which are drawn in space.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case, optional
        What was diagnosed, the first of several; without it there are neither test points nor clamps.
    """
    if case is not None and case.spec.imported is not None:
        return None
    body = outline(diagnosis, case)
    beam = body.width == 0
    tall = 0.12 * body.length if beam else body.width
    series = [_zones(diagnosis, body, tall)]
    nodes = () if case is None else case.measured.nodes
    # of a beam at its edges: the numbers of the zones stand in the middle
    points, sensors = (
        np.column_stack([places[:, 0], np.full(len(places), height)]) if beam else places
        for places, height in ((body.points, 0.0), (body.sensors, tall))
    )
    concerned = diagnosis.where.points if diagnosis.verdict != "unknown" else ()
    for named in (False, True):
        own = [i for i, node in enumerate(nodes) if (node in concerned) is named]
        text = [f"test point {nodes[i]}" for i in own]
        name = (
            _listed("test point", [nodes[i] for i in own]) if named else f"test point{'s' * (len(own) > 1)}"
        )
        more = {"hollow": not named, "text": text, "size": 4.5 if named else 3.5}
        if own:
            series.append(
                Series(name, "points", points[own, 0], points[own, 1], "orange" if named else "ink", more)
            )
    if len(sensors):
        more = {"symbol": "square", "size": 5, "hollow": True, "text": ["sensor"] * len(sensors)}
        series.append(
            Series("sensor" + "s" * (len(sensors) > 1), "points", sensors[:, 0], sensors[:, 1], "ink", more)
        )
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


def _listed(what: str, numbers: Sequence[int]) -> str:
    return f"{what}{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"


def _zones(diagnosis: Diagnosis, body: Outline, tall: float) -> Series:
    none = diagnosis.verdict == "none"
    low, high, bottom, top, held = (np.array(c) for c in zip(*body.zones, strict=True))
    if body.width == 0:
        bottom, top = np.zeros(len(low)), np.full(len(low), tall)
    text = [
        n if none else f"{n}\nprobability {probability(v)}" for n, v in zip(body.names, held, strict=True)
    ]
    written = ["" if none or v < 0.005 else f"{100 * v:.0f}" for v in held]
    more = {
        "low": low, "high": high, "bottom": bottom, "top": top, "value": 0 * held if none else held,
        "written": written, "text": text,
    }  # fmt: skip
    return Series("zone", "cells", (low + high) / 2, (bottom + top) / 2, "blue", more)


def _places(diagnosis: Diagnosis, body: Outline, tall: float) -> Series:
    flat = [at[:2] for at in diagnosis.where.locations]
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
        return f"The structure with its test points, {size}. There is no cause to locate."
    by = (
        "if that zone alone were changed: a hint at most"
        if diagnosis.where.zones_by == "regions"
        else "that the cause sits there"
    )
    return f"Each zone with the probability {by} [%]. {size[:1].upper()}{size[1:]}."
