"""The document of the library of effects, ``modalkit.effects/1``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of


class PriorEntry(TypedDict):
    """One parameter with its prior."""

    name: Annotated[str, "name within the effect"]
    unit: Annotated[str, "unit; `-` for a ratio"]
    low: Annotated[float, "lower end of the prior's range [`unit`]"]
    high: Annotated[float, "upper end [`unit`]"]
    log: Annotated[bool, "whether the prior is uniform in the logarithm"]
    why: Annotated[str, "why this range"]


class EffectEntry(TypedDict):
    """One effect."""

    name: Annotated[str, "name in a study, on the command line and in every document"]
    channel: Annotated[str, "where it acts: stiffness, mass, damping or measurement"]
    summary: Annotated[str, "what it is, in a sentence"]
    footprint: Annotated[str, "what it does to the data"]
    models: Annotated[Sequence[str], "types of model it applies to"]
    not_for: Annotated[Sequence[str], "types it does not apply to"]
    equivalent_to: Annotated[Sequence[str], "effects that some data cannot separate from it"]
    separated_by: Annotated[str, "the test that would"]
    fidelity: Annotated[float, "how far its idealisation may be off, relative to the shift it makes [-]"]
    damping_doubt: Annotated[float, "doubt of ln damping that it leaves, 1 sigma [-]"]
    parameters: Annotated[Sequence[PriorEntry], "its parameters and their priors"]
    labels: Annotated[Sequence[str], "further values that are node numbers of the test"]
    names: Annotated[Sequence[str], "further values that are names of your own model", Of("named")]
    of_sensor: Annotated[bool, "whether `channel` may name one fixed sensor instead: `5+Z`"]


class EffectsDocument(TypedDict):
    """Written by `modalkit effects --json`."""

    schema: Annotated[Literal["modalkit.effects/1"], "kind and version of the document"]
    specimen: Annotated[str, "the specimen for which priors that scale with it are shown"]
    effects: Annotated[Sequence[EffectEntry], "the library"]
