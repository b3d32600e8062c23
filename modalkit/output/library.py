"""The library of effects as a record: what each is, on which models, with which priors, and what resembles it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from updating import LIBRARY, Effect, Material, Measured, Parameter, Predictor, Spec

KINDS = ("beam", "plate", "matrices")

STEEL = Material(210e9, 7850.0)

SPECIMENS = {
    "beam": Spec("beam", 0.376, 0.0305, 0.0047625, (10,), ("x0",), "euler-bernoulli", STEEL),
    "plate": Spec("plate", 0.376, 0.200, 0.003175, (10, 6), ("x0",), "kirchhoff", STEEL),
}
"""Steel cantilevers whose priors the list shows."""

SHOWN = (
    "a steel cantilever beam of 376 x 30.5 x 4.7625 mm, or plate of 376 x 200 x 3.175 mm, hit at 20 to 400 Hz"
)
"""What they are, in words."""


def effects_record() -> dict[str, Any]:
    """Return the library of effects as ``modalkit.effects/1``."""
    return {
        "schema": "modalkit.effects/1",
        "specimen": SHOWN,
        "effects": [effect_record(effect) for effect in LIBRARY.values()],
    }


def effect_record(effect: Effect) -> dict[str, Any]:
    """Return one effect: sentences, and its parameters on the first kind of model that has each of them."""
    kinds = [kind for kind in SPECIMENS if kind in effect.models]
    named: dict[str, Parameter] = {}
    for kind in kinds:
        named = {p.name: p for p in effect.parameters(example(kind))} | named
    order = [p.name for kind in reversed(kinds) for p in effect.parameters(example(kind))]
    return {
        "name": effect.name,
        "channel": effect.channel,
        "summary": effect.summary,
        "footprint": effect.footprint,
        "models": list(effect.models),
        "not_for": [kind for kind in KINDS if kind not in effect.models],
        "equivalent_to": list(effect.equivalent_to),
        "separated_by": effect.separated_by,
        "fidelity": effect.fidelity,
        "damping_doubt": effect.damping_doubt,
        "parameters": [
            {"name": p.name, "unit": p.unit, "low": p.low, "high": p.high, "log": p.log, "why": p.why}
            for p in (named[name] for name in dict.fromkeys(order))
        ],
        "labels": list(effect.labels),
        "of_sensor": effect.of_sensor,
    }


@cache
def example(kind: str) -> Predictor:
    """Return the specimen of a kind as seen by a complete test: three points, a sensor at the last."""
    spec = SPECIMENS[kind]
    x = np.linspace(0.2, 0.376, 3)
    points = x[:, None] if kind == "beam" else np.column_stack([x, np.full(3, 0.2)])
    two, constants = np.ones(2), np.ones((3, 2))
    measured = Measured(
        np.array([20.0, 400.0]),
        two,
        two,
        two,
        points,
        (1, 2, 3),
        np.full(3, 2),
        np.arange(3),
        constants,
        constants,
        absolute=True,
    )
    return Predictor(spec, replace(measured, level=100.0))


def effects_table(record: dict[str, Any]) -> str:
    """Return the library as a table in Markdown: one row for each effect."""
    rows = ["| effect | acts on | models | parameters and prior | mistaken for | separated by |"]
    rows.append("|---|---|---|---|---|---|")
    for effect in record["effects"]:
        numbers = [_prior(parameter) for parameter in effect["parameters"]]
        numbers += [f"`{label}`: node numbers" for label in effect["labels"]]
        numbers += ['`channel`: or a fixed sensor, as "5+Z"'] if effect["of_sensor"] else []
        cells = (
            f"`{effect['name']}`",
            effect["channel"],
            ", ".join(effect["models"]),
            "<br>".join(numbers) or "none",
            ", ".join(f"`{name}`" for name in effect["equivalent_to"]) or "nothing",
            effect["separated_by"],
        )
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"


def _prior(parameter: dict[str, Any]) -> str:
    unit = "" if parameter["unit"] == "-" else f" {parameter['unit']}"
    scale = ", log" if parameter["log"] else ""
    return f"`{parameter['name']}`: {parameter['low']:.3g} to {parameter['high']:.3g}{unit}{scale}"
