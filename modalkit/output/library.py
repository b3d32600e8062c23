"""The library of effects as a record: what each is, on which models, with which priors, and what resembles it."""

from __future__ import annotations

from typing import get_args

from modalkit.output.fields import fill
from modalkit.output.schemas.effects import EffectEntry, EffectsDocument, PriorEntry
from updating import LIBRARY, Effect, Parameter
from updating.effects.specimens import SHOWN, example, kinds_of
from updating.models.spec import Kind


def effects_document() -> EffectsDocument:
    """Return the library of effects as ``modalkit.effects/1``."""
    return {
        "schema": "modalkit.effects/1",
        "specimen": SHOWN,
        "effects": [effect_document(effect) for effect in LIBRARY.values()],
    }


def effect_document(effect: Effect) -> EffectEntry:
    """Return one effect: sentences, and its parameters on the first kind of model that has each of them."""
    kinds = kinds_of(effect)
    named: dict[str, Parameter] = {}
    for kind in kinds:
        named = {p.name: p for p in effect.parameters(example(kind))} | named
    order = [p.name for kind in reversed(kinds) for p in effect.parameters(example(kind))]
    return fill(
        EffectEntry,
        effect,
        not_for=[kind for kind in get_args(Kind) if kind not in effect.models],
        parameters=[fill(PriorEntry, named[name]) for name in dict.fromkeys(order)],
    )


def effects_table(record: EffectsDocument) -> str:
    """Return the library as a table in Markdown: one row for each effect."""
    rows = ["| effect | acts on | models | parameters and prior | mistaken for | separated by |"]
    rows.append("|---|---|---|---|---|---|")
    for effect in record["effects"]:
        numbers = [_prior(parameter) for parameter in effect["parameters"]]
        numbers += [f"`{label}`: node numbers" for label in effect["labels"]]
        numbers += [f"`{label}`: a name, on matrices" for label in effect["names"]]
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


def _prior(parameter: PriorEntry) -> str:
    unit = "" if parameter["unit"] == "-" else f" {parameter['unit']}"
    scale = ", log" if parameter["log"] else ""
    return f"`{parameter['name']}`: {parameter['low']:.3g} to {parameter['high']:.3g}{unit}{scale}"
