"""Documents that lay modes side by side, ``modalkit.correlation/1`` and ``modalkit.comparison/1``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of


class CorrelatedPair(TypedDict):
    """One measured mode beside its partner."""

    test_mode: Annotated[int, "number among the measured modes, from 1 [-]", Of("test mode")]
    model_mode: Annotated[int, "number among those of the model, from 1 [-]", Of("model mode")]
    test_hz: Annotated[float, "measured frequency [Hz]", Of("test [Hz]")]
    model_hz: Annotated[float, "the model's [Hz]", Of("model [Hz]")]
    error_percent: Annotated[float, "model minus test, over test [%]", Of("error [%]")]
    sigma_percent: Annotated[float, "standard deviation of the measured frequency [%]", Of("sigma [%]")]
    mac: Annotated[float | None, "MAC; null without shapes [-]", Of("MAC")]


class NumberedMode(TypedDict):
    """A mode without a partner."""

    mode: Annotated[int, "number of the mode, from 1 [-]"]
    frequency_hz: Annotated[float, "its frequency [Hz]", Of("frequency [Hz]")]


class FracEntry(TypedDict):
    """Agreement of one FRF."""

    response: Annotated[int, "node of the response [-]"]
    response_direction: Annotated[str, "its direction, `+Z`; empty for a skew one", Of("response direction")]
    force: Annotated[int | None, "node of the force; null where modes do not say it [-]"]
    force_direction: Annotated[
        str | None, "its direction; null where modes do not say it", Of("force direction")
    ]
    frac: Annotated[float | None, "FRAC; null if undefined [-]", Of("FRAC")]


class CorrelationDocument(TypedDict):
    """Written by `modalkit correlate STUDY --json`."""

    schema: Annotated[Literal["modalkit.correlation/1"], "kind and version of the document"]
    frequency_rms_percent: Annotated[float, "r.m.s. frequency error over the pairs [%]", Of("rms_percent")]
    pairs: Annotated[Sequence[CorrelatedPair], "paired modes", Of("table")]
    mac: Annotated[
        Sequence[Sequence[float | None]],
        "MAC, test modes down, model modes across; empty without shapes, null if undefined [-]",
    ]
    unpaired_test: Annotated[Sequence[NumberedMode], "measured modes without a partner"]
    unpaired_model: Annotated[Sequence[NumberedMode], "model modes in the band without a partner"]
    frac: Annotated[
        Sequence[FracEntry],
        "by FRF: over the lines, or of modal constants where the test has modes only; empty for shapes without level",
    ]
    model_damping: Annotated[str | None, "where the damping of the model's FRFs is from; null without FRFs"]
    warnings: Annotated[Sequence[str], "what the user should know"]


class ComparedPair(TypedDict):
    """Two modes of two tests."""

    first_mode: Annotated[int, "number in the first test, from 1 [-]"]
    second_mode: Annotated[int, "number in the second [-]"]
    first_hz: Annotated[float, "frequency in the first [Hz]"]
    second_hz: Annotated[float, "frequency in the second [Hz]"]
    difference_percent: Annotated[float, "second minus first, over first [%]"]
    mac: Annotated[float | None, "MAC; null without common degrees of freedom [-]"]


class ComparisonDocument(TypedDict):
    """Written by `modalkit correlate FIRST SECOND --json`, for two tests."""

    schema: Annotated[Literal["modalkit.comparison/1"], "kind and version of the document"]
    pairs: Annotated[Sequence[ComparedPair], "paired modes"]
    mac: Annotated[Sequence[Sequence[float | None]], "MAC, first down, second across; null if undefined [-]"]
    unpaired_first: Annotated[Sequence[NumberedMode], "modes of the first without a partner"]
    unpaired_second: Annotated[Sequence[NumberedMode], "modes of the second without a partner"]
    degrees_of_freedom: Annotated[Sequence[str], "what both tests measured: `3+Z`"]
    warnings: Annotated[Sequence[str], "what the user should know"]
