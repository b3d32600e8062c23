"""The document of a planned test, ``modalkit.plan/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, NotRequired, TypedDict

from modalkit.output.fields import Of


class ForecastEntry(TypedDict):
    """One effect, as clear as it is asked about."""

    effect: Annotated[str, "name of the effect"]
    name: Annotated[str, "name in this document: the effect's, and its place where there are several"]
    at: Annotated[str | None, "its place in the names of your own model; null where it has none"]
    outcome: Annotated[
        Literal["named", "place", "edge", "class", "unseen"],
        "expected answer: named, named with its place in doubt, at the edge, in a class, or not seen",
        Of("kind"),
    ]
    not_told_from: Annotated[
        Sequence[str], "rivals from which it is not or hardly separated, nearest first", Of("rivals")
    ]
    seen_from: Annotated[str | None, "in words: size from which it is seen; null for never"]
    separated_from: Annotated[
        str | None, "in words: size from which it is separated from all others by 3 sigma; null for never"
    ]
    sure_from: Annotated[str | None, "in words: size from which it is separated by 5 sigma; null for never"]
    sure: Annotated[float | None, "that size; null for never [SI]"]
    seen: Annotated[float | None, "size from which it is seen; null for never [SI]"]
    separated: Annotated[float | None, "size from which it is separated; null for never [SI]"]
    asked: Annotated[str | None, "in words: the size that is asked about; null for none"]
    nearest: Annotated[str, "the rival with the most similar effect"]
    nearest_sigma: Annotated[float | None, "distance to that one; null if undefined [sigma]", Of("sigma")]
    sigma: Annotated[
        Mapping[str, float | None], "distance to each rival and to `none`; null from itself [sigma]"
    ]


class DesignEntry(TypedDict):
    """What one test separates."""

    effects: Annotated[Sequence[ForecastEntry], "effect by effect"]
    classes: Annotated[Sequence[Sequence[str]], "groups within 2 sigma of each other"]
    unseen: Annotated[Sequence[str], "effects that would be taken for none"]
    separated_share: Annotated[float, "share of the pairs of effects 3 sigma apart or more [-]"]


class AdviceEntry(TypedDict):
    """One change of the test."""

    change: Annotated[str, "short name"]
    measure: Annotated[str, "what to do"]
    worth: Annotated[float, "gain, by which changes are ranked; 0 for none [-]"]
    threshold_factor: Annotated[float, "factor by which separable sizes become smaller [-]", Of("factor")]
    separates: Annotated[Sequence[Sequence[str]], "pairs of effects that it newly separates"]
    then: Annotated[DesignEntry, "the forecast with the change"]


class BlindCase(TypedDict):
    """One blind trial on your own model."""

    effect: Annotated[str, "what was hidden"]
    severity: Annotated[str, "its size, in words"]
    test: Annotated[str, "`as it is`, or `advice followed`"]
    forecast: Annotated[str, "what was forecast, in words"]
    sigma: Annotated[float | None, "forecast distance to the nearest rival; null for infinite [sigma]"]
    answered: Annotated[str, "what the diagnosis stated"]
    right: Annotated[str, "`yes`, `in the class`, or `no`"]


class CheckedForecast(TypedDict):
    """Blind trials beside the forecast."""

    followed: Annotated[str | None, "advice that half of the trials follow; null for none"]
    trials: Annotated[Sequence[BlindCase], "trial by trial"]
    summary: Annotated[Sequence[str], "counts in words"]


class PlanDocument(TypedDict):
    """Written by `modalkit blind STUDY --json`."""

    schema: Annotated[Literal["modalkit.plan/1"], "kind and version of the document"]
    said: Annotated[Sequence[str], "what the forecast takes of the study"]
    left_out: Annotated[Sequence[str], "what of the study it does not take"]
    not_forecast: Annotated[Sequence[str], "effects it does not forecast; the command prints why"]
    now: Annotated[DesignEntry, "the test as the study has it"]
    advice: Annotated[Sequence[AdviceEntry], "changes of the test, most worth first"]
    trials: NotRequired[Annotated[CheckedForecast, "blind trials; absent without `--trials`"]]
