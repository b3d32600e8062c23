"""The document of a diagnosis, ``modalkit.diagnosis/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of

SOMETHING_ELSE = "something_else"
"""What stands for a cause in no library where a set of the answer, or a row of the ranking, names its effects."""


class GapMode(TypedDict):
    """One measured mode beside its partner."""

    study: Annotated[str, "title of the study"]
    test_hz: Annotated[float, "measured frequency [Hz]", Of("test [Hz]")]
    model_hz: Annotated[float, "the nominal model's [Hz]", Of("model [Hz]")]
    error_percent: Annotated[float, "model minus test, over test [%]", Of("error [%]")]
    sigma_percent: Annotated[float, "standard deviation of the measured frequency [%]", Of("sigma [%]")]
    mac: Annotated[float | None, "MAC; null without shapes [-]", Of("MAC")]
    test_damping: Annotated[
        float | None, "measured damping ratio; null where none is known [-]", Of("test damping")
    ]
    model_damping: Annotated[
        float | None, "what the study expects; null where it states none [-]", Of("model damping")
    ]


class GapEntry(TypedDict):
    """The gap before anything is explained."""

    frequency_rms_percent: Annotated[float, "r.m.s. frequency error over the pairs [%]", Of("rms_percent")]
    noise_floor_percent: Annotated[
        float, "error from the repeatability of the test alone [%]", Of("floor_percent")
    ]
    modes: Annotated[Sequence[GapMode], "mode by mode"]
    frac: Annotated[
        Sequence[float | None],
        "FRAC of the modal constants over the modes, by FRF; empty without level, null if undefined [-]",
    ]


class ZoneEntry(TypedDict):
    """A region of the model."""

    name: Annotated[str, "name of the region"]
    center: Annotated[Sequence[float], "its centre in model axes [m]"]
    probability: Annotated[float, "probability that the cause sits in it [-]"]


class WhereEntry(TypedDict):
    """Where the cause acts."""

    channel: Annotated[str, "the likeliest of stiffness, mass, damping and measurement; `none` without gap"]
    channels: Annotated[
        Mapping[str, float],
        "probability of each channel given that there is a cause; `none`: that there is no cause at all [-]",
    ]
    location: Annotated[Sequence[float] | None, "most probable place, model axes; null where it has none [m]"]
    locations: Annotated[
        Sequence[Sequence[float]],
        "all places with a notable share, mirrored ones too, most probable first [m]",
    ]
    points: Annotated[
        Sequence[int], "test nodes concerned: at the places, or those an effect of the measurement names [-]"
    ]
    names: Annotated[
        Sequence[str], "regions, node sets and joints of your own model that the first row names"
    ]
    zones: Annotated[Sequence[ZoneEntry], "regions of the model, with their probability"]


class EstimateEntry(TypedDict):
    """A parameter of an effect."""

    value: Annotated[
        float | str | Sequence[int] | None,
        "its value; nodes or a name where it has no size; null if not finite [`unit`]",
    ]
    unit: Annotated[str, "unit; `-` for a ratio"]
    low95: Annotated[
        float | None, "lower end of the 95 % interval; null where the value is not a number [`unit`]"
    ]
    high95: Annotated[float | None, "upper end; null likewise [`unit`]"]
    at_bound: Annotated[bool, "whether the interval touches the end of the prior's range"]


class RankedEntry(TypedDict):
    """One set of effects."""

    effects: Annotated[
        Sequence[str],
        "the set; an effect that occurs twice is listed twice; `something_else` is a cause outside the library",
    ]
    probability: Annotated[
        float, "of this set, among all sets compared, no effect at all, and a cause outside the library [-]"
    ]
    equivalents: Annotated[Sequence[Sequence[str]], "other rows that fit less than 2 sigma worse or better"]
    parameters: Annotated[
        Mapping[str, EstimateEntry],
        "by `effect.parameter`, a second such effect as `effect#2.parameter`; nodes and sensors only in rows of `sets`;"
        " a place that is an end or a test point is in `where.location` only",
    ]
    plausible: Annotated[bool, "whether the sizes are believable for such a specimen"]
    fit_p_value: Annotated[
        float | None,
        "chance of a misfit like this or worse if the set is true; null of `something_else` [-]",
        Of("p_value"),
    ]
    set_aside: Annotated[Sequence[str], "data that are treated as worse than stated"]


class SetAsideEntry(TypedDict):
    """No cause, but data that are worse than stated."""

    data: Annotated[Sequence[str], "which, most probably"]
    probability: Annotated[
        float, "that there is no cause and some data, these or others, are worse than stated [-]"
    ]
    fit_p_value: Annotated[
        float | None,
        "chance of a misfit of all other data like this or worse; null if undefined [-]",
        Of("p_value"),
    ]


class MechanismSizeEntry(TypedDict):
    """How large a mechanism is."""

    quantity: Annotated[
        str,
        "what is stated: `added mass`, `compliance`, `relative stiffness`, or a parameter's name",
    ]
    value: Annotated[float, "posterior median over all sets that share the mechanism [`unit`]"]
    unit: Annotated[str, "unit; `-` for a ratio"]
    low95: Annotated[float, "lower end of the 95 % interval [`unit`]"]
    high95: Annotated[float, "upper end [`unit`]"]


class AlikeEntry(TypedDict):
    """A set of effects that has a mechanism."""

    effects: Annotated[Sequence[str], "the set; `something_else` is a cause outside the library"]
    probability: Annotated[float, "its probability, given that there is a cause [-]"]


class MechanismEntry(TypedDict):
    """What several sets of effects do alike, whatever the story."""

    channel: Annotated[Literal["stiffness", "mass", "damping", "measurement"], "what is changed"]
    extent: Annotated[
        Literal["global", "local", "edge", "chain"],
        "all over the structure, at a place, at its supports, in the measuring chain",
    ]
    location: Annotated[Sequence[float] | None, "most probable place, model axes; null where it has none [m]"]
    locations: Annotated[
        Sequence[Sequence[float]],
        "all places that fit as well, mirrored ones too, and those that it is in at the same time [m]",
    ]
    location_low95: Annotated[
        Sequence[float] | None, "lower ends of the 95 % intervals about `location`; null likewise [m]"
    ]
    location_high95: Annotated[Sequence[float] | None, "upper ends; null likewise [m]"]
    size: Annotated[
        MechanismSizeEntry | None, "how large it is; null where its sets have no quantity in common"
    ]
    probability: Annotated[float, "of all its sets together, given that there is a cause [-]"]
    sets: Annotated[Sequence[AlikeEntry], "these sets, most probable first"]


class CauseEntry(TypedDict):
    """The cause."""

    verdict: Annotated[
        Literal["named", "class", "unknown", "none"],
        "one set; several these data cannot separate; a gap that no set explains; no gap",
    ]
    lacks: Annotated[
        Literal["fit", "closing", "evidence", "samples", "partners", "one size", "library"] | None,
        "what the first row lacks to be an answer; null unless `verdict` is `unknown`",
    ]
    level: Annotated[
        Literal["story", "mechanism"] | None,
        "what is certain: the set itself (`story`), or only the mechanism that sets with 95 % of the probability share"
        " (`mechanism`); null for neither",
    ]
    mechanism: Annotated[
        MechanismEntry | None,
        "the leading one of `mechanisms`; null for `none`, and for `unknown` unless a cause outside the library leads",
    ]
    mechanisms: Annotated[
        Sequence[MechanismEntry],
        "mechanisms of the first set (for `unknown`, of a cause outside the library), one per effect; all act at once",
    ]
    effects: Annotated[Sequence[str], "union of `sets`"]
    sets: Annotated[
        Sequence[Sequence[str]], "the answer: sets that hold 95 %; empty for `unknown` and `none`"
    ]
    ranking: Annotated[Sequence[RankedEntry], "all sets compared, most probable first"]
    set_aside: Annotated[
        SetAsideEntry | None,
        "data that must be worse than stated if there is no cause; null for none",
    ]


class HeldPointsEntry(TypedDict):
    """Errors of modal constants at points held out."""

    before_percent: Annotated[float | None, "of the nominal model; null if undefined [%]", Of("before")]
    after_percent: Annotated[float | None, "with the first row; null if undefined [%]", Of("after")]
    nuisance_only_percent: Annotated[
        float | None, "with the tolerances alone; null if undefined [%]", Of("nuisance")
    ]


class HeldOut(TypedDict):
    """R.m.s. errors on modes left out in turn and predicted from the others."""

    before_percent: Annotated[
        float | None, "of the nominal model; null with one mode only [%]", Of("held_before")
    ]
    after_percent: Annotated[
        float | None, "with the first row of the ranking; null likewise [%]", Of("held_after")
    ]
    runner_up_percent: Annotated[
        float | None, "with the second row of the ranking; null where there is none [%]", Of("held_runner_up")
    ]
    nuisance_only_percent: Annotated[
        float | None, "with the tolerances alone; null with one mode only [%]", Of("held_nuisance")
    ]
    noise_floor_percent: Annotated[
        float | None, "error from the repeatability of the test alone; null if undefined [%]", Of("floor")
    ]
    nuisance_stretch_sigma: Annotated[
        float | None,
        "how far off a tolerance would have to be if tolerances alone were the cause; null if undefined [sigma]",
        Of("stretch"),
    ]
    points: Annotated[
        HeldPointsEntry | None, "the same at points held out; null unless the gap shows in the FRFs"
    ]


class ClosedEntry(TypedDict):
    """Share of the closable gap that closes on modes held out."""

    value: Annotated[float, "the share [%]"]
    low95: Annotated[float, "lower end of its 95 % interval [%]"]
    high95: Annotated[float, "upper end [%]"]


class ShrinkEntry(TypedDict):
    """How far the gap shrinks."""

    metric: Annotated[
        Literal["frequency", "damping", "frf", "combined"],
        "data in which the gap shows, of which errors are given; for `combined`, 100 % is one standard deviation",
    ]
    before_percent: Annotated[float, "r.m.s. error of the nominal model [%]", Of("before")]
    after_percent: Annotated[float, "once the first row is fitted [%]", Of("after")]
    held_out: Annotated[HeldOut, "on modes left out", Of("")]
    closed_percent: Annotated[
        ClosedEntry | None,
        "share that closes; null where `before_percent` is within 1.5 times the floor",
        Of("closed"),
    ]


class RemainderEntry(TypedDict):
    """What the first row leaves."""

    significant: Annotated[bool, "whether it exceeds the stated noise"]
    percent: Annotated[float, "r.m.s. left beyond noise, in `shrink.metric` [%]"]
    sigma: Annotated[float, "largest residual of a mode or a channel [sigma]"]
    carried_by: Annotated[Sequence[str], "which data carry it: `mode 11 frequency`"]


class NextTestEntry(TypedDict):
    """A measurement that would help."""

    measure: Annotated[str, "what to do"]
    separates: Annotated[Sequence[str], "effects of the explanations it separates"]
    expected_sigma: Annotated[
        float | None, "by how many sigma at least; null for advice that separates nothing [sigma]"
    ]


class RegionalChangeEntry(TypedDict):
    """What a cause that is in no library would change in one region."""

    region: Annotated[str, "its name; empty for parts outside all regions"]
    property: Annotated[Literal["stiffness", "mass"], "what is changed"]
    percent: Annotated[float, "by how much, the most probable value [%]"]
    low95: Annotated[float, "lower end of the 95 % interval [%]"]
    high95: Annotated[float, "upper end [%]"]


class SomethingElseEntry(TypedDict):
    """A cause that is in no library: fields of stiffness and mass, of damping and of gains."""

    probability: Annotated[float, "that the cause is outside the library, given that there is a cause [-]"]
    log_bayes_factor: Annotated[
        float, "for such a cause in addition to the first row; above 0 is evidence for one [-]", Of("beside")
    ]
    channels: Annotated[
        Mapping[str, float], "probability that it changes each channel, where it is the cause [-]"
    ]
    changes: Annotated[
        Sequence[RegionalChangeEntry], "changes of the structure that it would make, the most certain first"
    ]


class SearchedEntry(TypedDict):
    """How much of what there is was searched."""

    causes: Annotated[int, "causes in a set [-]"]
    sets: Annotated[int, "number of sets searched, the most promising ones by score tests [-]"]
    possible: Annotated[int, "number of sets possible [-]"]


class DiagnosisDocument(TypedDict):
    """Written by `modalkit diagnose --json`."""

    schema: Annotated[Literal["modalkit.diagnosis/1"], "kind and version of the document"]
    title: Annotated[str, "of the study, or the studies"]
    significant: Annotated[bool, "whether test and model differ by more than tolerances and noise"]
    p_value: Annotated[float, "chance of such a gap without any cause [-]"]
    gap: Annotated[GapEntry, "how large the gap is"]
    where: Annotated[WhereEntry, "where the cause acts"]
    cause: Annotated[CauseEntry, "which effects make it"]
    shrink: Annotated[ShrinkEntry, "how far the gap shrinks once they are in the model"]
    remainder: Annotated[RemainderEntry | None, "what the first row leaves beyond noise; null without gap"]
    something_else: Annotated[
        SomethingElseEntry | None,
        "a cause outside the library; null without gap, or where it was not examined",
    ]
    included: Annotated[Mapping[str, float], "probability of each effect that it is among the causes [-]"]
    next_test: Annotated[Sequence[NextTestEntry], "what to measure next, best first"]
    searched: Annotated[Sequence[SearchedEntry], "how many sets of causes were searched"]
    not_examined: Annotated[Mapping[str, str], "effects that could not be examined, and why"]
    rules: Annotated[
        Mapping[str, float],
        "rules that differ from the defaults, by name; empty where none does [unit of the rule]",
    ]
    warnings: Annotated[Sequence[str], "what the user should know"]
