"""The document of a blind run, ``modalkit.blind/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypedDict

Maybe = float | None


class Share(TypedDict):
    """A share with its Wilson interval."""

    count: Annotated[float, "how often; not whole where a class counts by its share [-]"]
    total: Annotated[float, "of how many [-]"]
    rate: Annotated[Maybe, "`count / total`; null of none [-]"]
    low95: Annotated[Maybe, "lower end of its 95 % interval; null of none [-]"]
    high95: Annotated[Maybe, "upper end; null of none [-]"]


class Mean(TypedDict):
    """A number with its bootstrap interval over the trials."""

    total: Annotated[int, "trials behind it [-]"]
    value: Annotated[Maybe, "the number; null without trials [-]"]
    low95: Annotated[Maybe, "lower end of its 95 % interval; null without trials [-]"]
    high95: Annotated[Maybe, "upper end; null without trials [-]"]


class Headline(Share):
    """A number to read first."""

    number: Annotated[str, "which"]


class Rate(Share):
    """How often, by question."""

    question: Annotated[str, "what is counted"]


Group = TypedDict(
    "Group",
    {
        "group": Annotated[str, "`level`, `kind`, `baseline` or `calibrated`"],
        "value": Annotated[str, "which of these"],
        "total": Annotated[int, "trials [-]"],
        "top": Annotated[Maybe, "share whose most probable answer is the truth; null of none [-]"],
        "top low95": Annotated[Maybe, "lower end; null of none [-]"],
        "top high95": Annotated[Maybe, "upper end; null of none [-]"],
        "right": Annotated[Maybe, "share true up to the class; null of none [-]"],
        "right low95": Annotated[Maybe, "lower end; null of none [-]"],
        "right high95": Annotated[Maybe, "upper end; null of none [-]"],
        "credit": Annotated[Maybe, "the same, a class by its share; null of none [-]"],
        "credit low95": Annotated[Maybe, "lower end; null of none [-]"],
        "credit high95": Annotated[Maybe, "upper end; null of none [-]"],
        "commits": Annotated[Maybe, "share with one answer; null of none [-]"],
        "commits low95": Annotated[Maybe, "lower end; null of none [-]"],
        "commits high95": Annotated[Maybe, "upper end; null of none [-]"],
    },
)

ByEffect = TypedDict(
    "ByEffect",
    {
        "sort": Annotated[str, "`effect`, `pair`, `none`, `outside` the library, or `left out` of it"],
        "effect": Annotated[str, "what was hidden"],
        "trials": Annotated[int, "how many [-]"],
        "visible": Annotated[int, "of which the data show it [-]"],
        "top": Annotated[int, "most probable answer is the truth [-]"],
        "right": Annotated[int, "true up to the class [-]"],
        "credit": Annotated[float, "the same, a class by its share [-]"],
        "named right": Annotated[int, "named alone, rightly [-]"],
        "class with it": Annotated[int, "a class that holds it [-]"],
        "wrong": Annotated[int, "named or in a class, wrongly [-]"],
        "unknown": Annotated[int, "called unknown [-]"],
        "none": Annotated[int, "called none [-]"],
        "failed": Annotated[int, "diagnosis failed [-]"],
        "rate": Annotated[Maybe, "share right of the visible; null of none [-]"],
        "low95": Annotated[Maybe, "lower end; null of none [-]"],
        "high95": Annotated[Maybe, "upper end; null of none [-]"],
        "mean class size": Annotated[Maybe, "sets in an answer; null without answers [-]"],
    },
)


class Calibration(Mean):
    """A score of the probabilities."""

    trials: Annotated[str, "of which trials"]
    measure: Annotated[str, "which score"]


class Reliability(Share):
    """Stated probability beside how often it is true, by bin."""

    low: Annotated[float, "lower edge of the bin [-]"]
    high: Annotated[float, "upper edge [-]"]
    stated: Annotated[float, "mean probability stated [-]"]


class Uniformity(Share):
    """P-values where nothing is hidden."""

    level: Annotated[float, "counted below this [-]"]
    ks_p: Annotated[Maybe, "Kolmogorov-Smirnov test of all of them; null without any [-]"]


Sizes = TypedDict(
    "Sizes",
    {
        "set": Annotated[str, "which set of answers"],
        "mean_size": Annotated[Maybe, "its mean size; null without trials [-]"],
        "mean_low95": Annotated[Maybe, "lower end; null without trials [-]"],
        "mean_high95": Annotated[Maybe, "upper end; null without trials [-]"],
        "size 1": Annotated[int, "trials with one set [-]"],
        "size 2": Annotated[int, "with two [-]"],
        "size 3": Annotated[int, "with three [-]"],
        "size 4": Annotated[int, "with four [-]"],
        "size 5": Annotated[int, "with five [-]"],
        "size over 5": Annotated[int, "with more [-]"],
    },
)


class Cover(Share, Sizes):
    """How often a set of answers holds the truth."""


class Severity(TypedDict):
    """One parameter of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    parameter: Annotated[str, "`effect.parameter`"]
    true: Annotated[float, "hidden value [SI]"]
    value: Annotated[Maybe, "stated value; null if not finite [SI]"]
    low95: Annotated[Maybe, "lower end; null without interval [SI]"]
    high95: Annotated[Maybe, "upper end; null without interval [SI]"]
    error: Annotated[Maybe, "stated over true, less 1; null if not finite [-]"]
    covered: Annotated[bool | None, "whether the interval holds the truth; null without one"]
    committed: Annotated[bool, "whether that set alone was the answer"]


class SeveritySummary(Share):
    """Errors of a parameter; the share is of intervals that hold the truth."""

    parameter: Annotated[str, "which, or `all`"]
    errors: Annotated[int, "how many [-]"]
    median_error: Annotated[Maybe, "median magnitude of `error`; null of none [-]"]
    median_low95: Annotated[Maybe, "lower end; null of none [-]"]
    median_high95: Annotated[Maybe, "upper end; null of none [-]"]
    bias: Annotated[Maybe, "mean `error`; null of none [-]"]


class Points(TypedDict):
    """Hidden test points of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    parameter: Annotated[str, "`effect.parameter`"]
    true: Annotated[str, "hidden nodes"]
    said: Annotated[str, "stated nodes"]
    same: Annotated[bool, "whether they are the same"]


class PlaceError(TypedDict):
    """The place of one trial."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, "as in `effects`"]
    nearest: Annotated[float, "error of the nearest place offered, over the span [-]"]
    first: Annotated[float, "error of the first one [-]"]
    places: Annotated[int, "places offered [-]"]
    covered: Annotated[bool | None, "whether the intervals hold the truth; null without any"]
    held: Annotated[bool, "whether the answer holds the effect"]


class PlaceSummary(Share):
    """Errors of place; the share is of those within 5 % of the span."""

    effect: Annotated[str, "which, or a group"]
    nearest_median: Annotated[Maybe, "median of `nearest`; null of none [-]"]
    nearest_low95: Annotated[Maybe, "lower end; null of none [-]"]
    nearest_high95: Annotated[Maybe, "upper end; null of none [-]"]
    first_median: Annotated[Maybe, "median of `first`; null of none [-]"]
    first_low95: Annotated[Maybe, "lower end; null of none [-]"]
    first_high95: Annotated[Maybe, "upper end; null of none [-]"]
    first_count: Annotated[int, "first places within 5 % [-]"]
    covered: Annotated[int, "intervals that hold the truth [-]"]
    intervals: Annotated[int, "of so many [-]"]


class ChannelShare(Share):
    """How often the channel is right."""

    channel: Annotated[str, "true channel, or `all`"]


class Closing(TypedDict):
    """How far the gap of one trial closes."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, "as in `effects`"]
    metric: Annotated[str, "metric of the statement"]
    true_metric: Annotated[str, "metric of the truth"]
    said: Annotated[Maybe, "stated share; null where none is [%]"]
    low95: Annotated[Maybe, "lower end; null likewise [%]"]
    high95: Annotated[Maybe, "upper end; null likewise [%]"]
    true: Annotated[Maybe, "what closes on the rig's own modes; null with nothing to close [%]"]
    beyond: Annotated[Maybe, "on the modes above the band; null likewise [%]"]
    held_out: Annotated[Maybe, "from the errors held out; null likewise [%]"]
    covered: Annotated[bool | None, "whether the interval holds the truth; null without one"]
    held: Annotated[bool, "whether the answer holds the effect"]


class ClosingSummary(Share):
    """Stated and true closing; the share is of those within 10 points."""

    trials: Annotated[str, "of which trials"]
    mean_difference: Annotated[Maybe, "mean magnitude of the difference; null of none [%]"]
    mean_low95: Annotated[Maybe, "lower end; null of none [%]"]
    mean_high95: Annotated[Maybe, "upper end; null of none [%]"]
    said: Annotated[Maybe, "mean stated; null of none [%]"]
    true: Annotated[Maybe, "mean true; null of none [%]"]
    beyond: Annotated[Maybe, "mean above the band; null of none [%]"]
    covered_count: Annotated[float, "intervals that hold the truth [-]"]
    covered_total: Annotated[int, "of so many [-]"]
    covered_rate: Annotated[Maybe, "share; null of none [-]"]
    covered_low95: Annotated[Maybe, "lower end; null of none [-]"]
    covered_high95: Annotated[Maybe, "upper end; null of none [-]"]


class OwnRule(Share):
    """The diagnosis's own rule on when to answer."""

    answered: Annotated[Maybe, "share answered; null of none [-]"]
    of: Annotated[int, "trials [-]"]


class CurvePoint(TypedDict):
    """One threshold of the abstention curve."""

    threshold: Annotated[float, "least probability of the first set that is answered [-]"]
    committed: Annotated[int, "trials answered [-]"]
    count: Annotated[int, "of these right [-]"]
    total: Annotated[int, "trials [-]"]
    answered: Annotated[float, "share answered [-]"]
    right: Annotated[float, "share right of these [-]"]
    low95: Annotated[Maybe, "lower end; null of none [-]"]
    high95: Annotated[Maybe, "upper end; null of none [-]"]


class AbstentionEntry(TypedDict):
    """What is answered against how often it is right."""

    area: Annotated[Mean, "mean share right over all shares answered"]
    rule: Annotated[OwnRule, "at the diagnosis's own rule"]
    curve: Annotated[Sequence[CurvePoint], "at every threshold"]


OpenEffect = TypedDict(
    "OpenEffect",
    {
        "effect": Annotated[str, "hidden effect, or a group"],
        "unknown": Annotated[int, "called unknown [-]"],
        "equivalent": Annotated[int, "given an honest equivalent [-]"],
        "wrong name": Annotated[int, "given a wrong name [-]"],
        "wrong class": Annotated[int, "a class without it [-]"],
        "none": Annotated[int, "called none [-]"],
        "failed": Annotated[int, "diagnosis failed [-]"],
    },
)


class OpenRow(OpenEffect, Share):
    """Answers to what is not in the library; the share is of honest ones."""


class RocPoint(TypedDict):
    """One threshold of the curve of detection."""

    threshold: Annotated[float, "of 1 - p of the fit [-]"]
    false: Annotated[float, "false alarms on known effects [-]"]
    found: Annotated[float, "unknown effects found [-]"]


class OpenSetEntry(TypedDict):
    """Effects that the diagnosis cannot know."""

    effects: Annotated[Sequence[OpenRow], "by hidden effect"]
    area: Annotated[Mean, "area under the curve; 0.5 is chance"]
    roc: Annotated[Sequence[RocPoint], "the curve"]


class TrialEntry(TypedDict):
    """One trial, judged."""

    trial: Annotated[int, "number of the trial [-]"]
    effect: Annotated[str, "what was hidden"]
    sort: Annotated[str, "as in `effects`"]
    kind: Annotated[str, "specimen: beam, plate, solid, frame, ribbed or bracket"]
    level: Annotated[str, "none, mild, clear or strong"]
    severity: Annotated[float, "drawn strength, 1 for clear [-]"]
    visibility: Annotated[float, "by how much the effect moves the data beyond the tolerances [sigma]"]
    left_visible: Annotated[
        Maybe,
        "what the library's best effect leaves of one that it lacks; null if the library has it [sigma]",
    ]
    faint: Annotated[bool, "whether the effect is too small to be seen"]
    visible: Annotated[bool, "whether the data show it"]
    baseline: Annotated[bool, "whether there is a baseline"]
    calibrated: Annotated[bool, "whether the FRFs have an absolute level"]
    gap_percent: Annotated[float, "r.m.s. frequency gap [%]"]
    verdict: Annotated[str, "of the diagnosis, or `failed`"]
    answered: Annotated[str, "the answer in words"]
    sets: Annotated[int, "sets in the answer [-]"]
    right: Annotated[bool, "whether it is true up to the class"]
    top: Annotated[bool, "whether the most probable answer is"]
    holds: Annotated[bool, "whether the answer holds the truth"]
    commits: Annotated[bool, "whether it is one answer"]
    credit: Annotated[float, "a class by its share [-]"]
    confidence: Annotated[float, "probability of the first set [-]"]
    first: Annotated[bool, "whether that set is the truth"]
    probability: Annotated[Maybe, "probability of the truth; null where the diagnosis failed [-]"]
    p_value: Annotated[Maybe, "of the gap; null likewise [-]"]
    fit: Annotated[Maybe, "p-value of the first row; null without rows [-]"]
    failure: Annotated[str, "message of a diagnosis that failed"]
    brier: Annotated[Maybe, "Brier score; null where the library cannot answer [-]"]
    log: Annotated[Maybe, "log score; null likewise [-]"]
    size: Annotated[Maybe, "sets that hold 95 %; null likewise [-]"]


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

    schema: Annotated[Literal["modalkit.blind/1"], "kind and version of the document"]
    seed: Annotated[int, "seed of the run [-]"]
    plan: Annotated[DrawnFrom, "what could be drawn"]
    headline: Annotated[Sequence[Headline], "numbers to read first"]
    rates: Annotated[Sequence[Rate], "how often, by question"]
    groups: Annotated[Sequence[Group], "by level, kind, baseline and calibration"]
    effects: Annotated[Sequence[ByEffect], "by hidden effect"]
    calibration: Annotated[Sequence[Calibration], "scores of the probabilities"]
    reliability: Annotated[Sequence[Reliability], "stated probability beside the true share"]
    uniformity: Annotated[Sequence[Uniformity], "p-values where nothing is hidden"]
    cover: Annotated[Sequence[Cover], "sets of answers and how often they hold the truth"]
    severity: Annotated[Sequence[Severity], "errors of parameters, trial by trial"]
    severity_summary: Annotated[Sequence[SeveritySummary], "by parameter"]
    points: Annotated[Sequence[Points], "hidden test points"]
    places: Annotated[Sequence[PlaceError], "errors of place, trial by trial"]
    place_summary: Annotated[Sequence[PlaceSummary], "by effect"]
    channels: Annotated[Sequence[ChannelShare], "how often the channel is right"]
    closing: Annotated[Sequence[Closing], "how far gaps close, trial by trial"]
    closing_summary: Annotated[Sequence[ClosingSummary], "by group"]
    confusion: Annotated[
        Mapping[str, Mapping[str, float]], "hidden effect, then answer: trials, zeros left out [-]"
    ]
    abstention: Annotated[AbstentionEntry, "the price of waiting until one is sure"]
    abstention_outside: Annotated[AbstentionEntry, "the same with effects that cannot be known"]
    open_set: Annotated[OpenSetEntry, "effects that the diagnosis cannot know"]
    trials: Annotated[Sequence[TrialEntry], "every trial, judged"]
    outcomes: Annotated[Sequence[OutcomeEntry], "every trial, opened"]
