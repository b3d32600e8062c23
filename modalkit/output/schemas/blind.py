"""The document of a blind run, ``modalkit.blind/2``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypedDict

Maybe = float | None
SORT = "`effect`, `pair`, `none`, `outside` the library, or `left out` of it"


class RateEntry(TypedDict):
    """The answer to a question: a share with its Wilson interval, or a number with its bootstrap interval."""

    question: Annotated[str, "the question; ends with the unit of the number, if it has one"]
    group: Annotated[str, "group of trials; `all` for all to which the question applies"]
    count: Annotated[
        Maybe,
        "number of trials for which it is true; a class counts by its share; null where `rate` is not a share [-]",
    ]
    total: Annotated[int, "number of trials [-]"]
    rate: Annotated[
        Maybe, "`count / total`, or the number; null without any [-, or the unit of the question]"
    ]
    low: Annotated[Maybe, "lower end of its 95 % interval; null for none [as `rate`]"]
    high: Annotated[Maybe, "upper end; null for none [as `rate`]"]


class Severity(TypedDict):
    """One parameter of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    parameter: Annotated[str, "`effect.parameter`"]
    true: Annotated[float, "hidden value [SI]"]
    value: Annotated[Maybe, "stated value; null if not finite [SI]"]
    low95: Annotated[Maybe, "lower end; null without interval [SI]"]
    high95: Annotated[Maybe, "upper end; null without interval [SI]"]
    error: Annotated[Maybe, "relative error, stated over true minus 1; null if not finite [-]"]
    covered: Annotated[bool | None, "whether the interval holds the truth; null without one"]
    committed: Annotated[bool, "whether that set alone was the answer"]


class Points(TypedDict):
    """Hidden test points of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    parameter: Annotated[str, "`effect.parameter`"]
    true: Annotated[str, "hidden nodes"]
    said: Annotated[str, "stated nodes"]
    same: Annotated[bool, "whether both sets of nodes are the same"]


class PlaceError(TypedDict):
    """The place of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, SORT]
    nearest: Annotated[float, "error of the nearest place offered, over the span [-]"]
    first: Annotated[float, "error of the first place offered, over the span [-]"]
    places: Annotated[int, "places offered [-]"]
    covered: Annotated[bool | None, "whether the intervals hold the truth; null without any"]
    held: Annotated[bool, "whether the answer holds the effect"]


class Closing(TypedDict):
    """How far the gap of one trial closes."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, SORT]
    metric: Annotated[str, "metric of the stated share"]
    true_metric: Annotated[str, "metric of the true share"]
    said: Annotated[Maybe, "stated share of the gap that closes; null if none is stated [%]"]
    low95: Annotated[Maybe, "lower end of its 95 % interval; null likewise [%]"]
    high95: Annotated[Maybe, "upper end; null likewise [%]"]
    true: Annotated[
        Maybe, "true share, on the rig's own modes in the band; null if there is nothing to close [%]"
    ]
    beyond: Annotated[Maybe, "true share on the modes above the band; null likewise [%]"]
    held_out: Annotated[Maybe, "share by the errors on modes held out; null likewise [%]"]
    covered: Annotated[bool | None, "whether the interval holds the truth; null without one"]
    held: Annotated[bool, "whether the answer holds the effect"]


class TrialEntry(TypedDict):
    """One trial, judged."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, SORT]
    kind: Annotated[str, "specimen: beam, plate, solid, frame, ribbed or bracket"]
    level: Annotated[str, "none, mild, clear or strong"]
    severity: Annotated[float, "drawn strength, 1 for clear [-]"]
    visibility: Annotated[float, "by how much the effect moves the data beyond the tolerances [sigma]"]
    left_visible: Annotated[
        Maybe,
        "residual after the best effect of the library; null if the library has the hidden effect [sigma]",
    ]
    faint: Annotated[bool, "whether the effect is too small to be seen"]
    visible: Annotated[bool, "whether the data show it"]
    baseline: Annotated[bool, "whether there is a baseline"]
    calibrated: Annotated[bool, "whether the FRFs have an absolute level"]
    gap_percent: Annotated[float, "r.m.s. frequency gap [%]"]
    verdict: Annotated[str, "verdict of the diagnosis, or `failed`"]
    answered: Annotated[str, "the answer in words"]
    sets: Annotated[int, "sets in the answer [-]"]
    right: Annotated[bool, "whether the answer is right, as a class at least"]
    top: Annotated[bool, "whether the most probable answer is right"]
    holds: Annotated[bool, "whether the answer holds the truth"]
    commits: Annotated[bool, "whether the answer is a single one"]
    credit: Annotated[float, "1 for a right answer, its share for a class [-]"]
    confidence: Annotated[float, "probability of the first set [-]"]
    first: Annotated[bool, "whether that set is the truth"]
    probability: Annotated[Maybe, "probability of the truth; null where the diagnosis failed [-]"]
    p_value: Annotated[Maybe, "p-value of the gap; null likewise [-]"]
    fit: Annotated[Maybe, "p-value of the first row; null without rows [-]"]
    failure: Annotated[str, "message of a diagnosis that failed"]
    brier: Annotated[Maybe, "Brier score; null where the library cannot answer [-]"]
    log: Annotated[Maybe, "log score; null likewise [-]"]
    size: Annotated[Maybe, "sets that hold 95 %; null likewise [-]"]
    stated: Annotated[Maybe, "probability of the most probable set; null likewise [-]"]
    covers: Annotated[Maybe, "1 where the sets that hold 95 % hold the truth, else 0; null likewise [-]"]


class ShrinkageEntry(TypedDict):
    """How far the answer truly closes the gap on the rig."""

    metric: Annotated[str, "frequency or damping"]
    before_percent: Annotated[float, "r.m.s. error on the modes of the band [%]"]
    after_percent: Annotated[float, "with the answer in the model [%]"]
    beyond_before_percent: Annotated[Maybe, "the same above the band; null if undefined [%]"]
    beyond_after_percent: Annotated[Maybe, "with the answer; null likewise [%]"]


class OutcomeEntry(TypedDict):
    """One trial, opened."""

    index: Annotated[int, "number of the trial [-]"]
    statement: Annotated[str, "the hidden truth, as the JSON text that was sealed"]
    salt: Annotated[str, "128 random bits, hexadecimal"]
    commitment: Annotated[str, "hash of both, published before the diagnosis"]
    document: Annotated[
        Mapping[str, Any] | None, "what the score needs of `modalkit.diagnosis/1`; null where it failed"
    ]
    failure: Annotated[str | None, "message of a diagnosis that failed; null for one that did not"]
    seconds: Annotated[float, "0: the time is no part of the result [s]"]
    shrinkage: Annotated[
        ShrinkageEntry | None, "how far the answer truly closes the gap; null without an answer"
    ]


class DrawnFrom(TypedDict):
    """What could be drawn."""

    kinds: Annotated[Sequence[str], "specimens"]
    plates: Annotated[float, "share of plates [-]"]
    effects: Annotated[Sequence[str], "what may be hidden; empty for all"]
    none: Annotated[float, "share of trials without effect [-]"]
    pairs: Annotated[float, "share with two [-]"]
    triples: Annotated[float, "share with three [-]"]
    outside: Annotated[float, "share with an effect the library lacks [-]"]
    mild: Annotated[float, "share of faint effects [-]"]
    strong: Annotated[float, "share of strong ones [-]"]
    leave_out: Annotated[bool, "whether the true effect is taken out of the library"]
    baseline: Annotated[float, "share with a baseline [-]"]


class BlindDocument(TypedDict):
    """Written by `modalkit blind --json`, without a study: the score, from which it can be made again."""

    schema: Annotated[Literal["modalkit.blind/2"], "kind and version of the document"]
    seed: Annotated[int, "seed of the run [-]"]
    plan: Annotated[DrawnFrom, "what could be drawn"]
    rates: Annotated[Sequence[RateEntry], "every question, for every group of trials"]
    severity: Annotated[Sequence[Severity], "errors of parameters, trial by trial"]
    points: Annotated[Sequence[Points], "hidden test points"]
    places: Annotated[Sequence[PlaceError], "errors of place, trial by trial"]
    closing: Annotated[Sequence[Closing], "how far gaps close, trial by trial"]
    confusion: Annotated[
        Mapping[str, Mapping[str, float]], "hidden effect, then answer: trials, zeros left out [-]"
    ]
    trials: Annotated[Sequence[TrialEntry], "every trial, judged"]
    outcomes: Annotated[Sequence[OutcomeEntry], "every trial, opened"]
