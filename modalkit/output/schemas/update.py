"""The document of an update, ``modalkit.update/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of


class UpdatedParameter(TypedDict):
    """One updated parameter."""

    name: Annotated[str, "name as in `[update]`: `E`, `root.E`"]
    study: Annotated[str | None, "study it belongs to; null where several share it"]
    value: Annotated[float | None, "value after the update; null if it is not finite [`unit`]"]
    unit: Annotated[str, "unit; `-` for a ratio"]
    factor: Annotated[float | None, "true over nominal value; null for a parameter that is no factor [-]"]
    sigma: Annotated[float | None, "standard deviation; null where nothing bounds it [`unit`]"]
    at_bound: Annotated[bool, "whether it stands at the end of its range"]
    low: Annotated[float | None, "lower end of its range; null for none [`unit`]"]
    high: Annotated[float | None, "upper end of its range; null for none [`unit`]"]
    initial: Annotated[float | None, "value before; null if it is not known [`unit`]"]
    interval: Annotated[
        Sequence[float | None] | None,
        "ends of the 95 % interval of `--bootstrap`, or of several solutions; null without either [`unit`]",
    ]


class UpdatedPair(TypedDict):
    """One measured mode beside its partner."""

    study: Annotated[str, "title of the study"]
    test_mode: Annotated[int, "number among the measured modes, from 1 [-]"]
    model_mode: Annotated[int, "number among those of the model, from 1 [-]"]
    mac: Annotated[float | None, "MAC after the update; null without shapes [-]"]
    test_hz: Annotated[float | None, "measured frequency; never null in practice [Hz]"]
    before_hz: Annotated[float | None, "the model's before; null if it could not be solved [Hz]"]
    after_hz: Annotated[float | None, "the model's after; null if it could not be solved [Hz]"]
    used: Annotated[bool, "whether the mode has a weight in the update"]
    shape_sigma: Annotated[
        float | None, "assumed error of the shape, over its r.m.s.; null where shapes are not data [-]"
    ]


class RmsChange(TypedDict):
    """R.m.s. frequency error over the pairs used."""

    before: Annotated[float, "of the nominal model [%]"]
    after: Annotated[float, "of the updated one [%]"]


class Statistics(TypedDict):
    """How the fit went."""

    data: Annotated[int, "number of data that have a weight [-]"]
    chi2: Annotated[float | None, "misfit in variances of data and tolerances; null if it is not finite [-]"]
    dof: Annotated[int, "data less parameters; 0 or less: the fit tests nothing [-]"]
    reduced_chi2: Annotated[float | None, "`chi2 / dof`; null without a degree of freedom [-]"]
    inflation: Annotated[float | None, "factor by which the misfit raised `sigma`; null if not finite [-]"]
    weights: Annotated[str, "what the weights are, in words"]
    quantity: Annotated[str, "what is compared: `frequency` (relative), `eigenvalue`, or `receptance`"]
    draws: Annotated[int, "bootstrap updates behind `interval`; 0 for none [-]"]


class CoupledParameters(TypedDict):
    """Parameters that only a combination determines."""

    parameters: Annotated[Sequence[str], "their names"]
    determined: Annotated[Sequence[str], "combinations the data do determine: `E / density`"]
    sigma: Annotated[Sequence[float | None], "standard deviation of each combination; null for none [-]"]


class DeterminabilityEntry(TypedDict):
    """What the data determine."""

    singular_values: Annotated[
        Sequence[float | None],
        "factor by which the data narrow each direction of the parameters; null if not finite [-]",
    ]
    alone: Annotated[
        Sequence[float | None],
        "standard deviation from the data alone, over that before the update, by parameter; null for infinite [-]",
    ]
    couplings: Annotated[Sequence[CoupledParameters], "groups that the data do not separate"]
    subset: Annotated[Sequence[str], "parameters in the order in which they explain the residual"]
    explained: Annotated[
        Sequence[float | None], "share of the residual explained after each of these; null if not finite [-]"
    ]


class DampingPair(TypedDict):
    """Damping ratios of a pair, in the order of `pairs`."""

    test_damping: Annotated[float | None, "measured; null where it is not [-]"]
    before_damping: Annotated[float | None, "the model's before; null for none [-]"]
    after_damping: Annotated[float | None, "the model's after; null for none [-]"]


class ByFrfs(TypedDict):
    """What an update by FRFs has beside."""

    frac: Annotated[
        Sequence[Mapping[str, float | None]],
        "by FRF: nodes `response` and `force`; FRAC `before`, `after stage 1` and so on where there are several"
        " stages, and `after`; null if undefined [-]",
    ]
    damping: Annotated[Sequence[DampingPair], "damping ratios, one row for each of `pairs`", Of("pairs")]
    iterations_by_stage: Annotated[Sequence[int], "iterations of each stage [-]", Of("stages")]
    lines_hz: Annotated[Sequence[Sequence[float]], "frequencies compared, by stage [Hz]", Of("lines")]
    discrepancy: Annotated[
        Sequence[float], "error of the model that no parameter removes, relative to the FRFs, r.m.s. [-]"
    ]


class UpdateDocument(TypedDict):
    """Written by `modalkit update --json`."""

    schema: Annotated[Literal["modalkit.update/1"], "kind and version of the document"]
    parameters: Annotated[Sequence[UpdatedParameter], "what was updated"]
    pairs: Annotated[Sequence[UpdatedPair], "paired modes of all studies"]
    undetermined: Annotated[
        Sequence[str], "parameters that the data alone determine less than was known before"
    ]
    held: Annotated[
        Sequence[str],
        "parameters that their tolerances hold against the data; `sigma` is then that of the tolerance",
    ]
    iterations: Annotated[int, "number of steps [-]"]
    converged: Annotated[bool, "whether the steps converged to zero"]
    correlations: Annotated[
        Sequence[Sequence[float | None]], "of the parameters, in their order; null if undefined [-]"
    ]
    exact: Annotated[bool, "whether `after_hz` is of the full model and not of a reduced basis"]
    rms_percent: Annotated[RmsChange, "r.m.s. frequency error"]
    statistics: Annotated[Statistics, "how the fit went", Of("")]
    determinability: Annotated[
        DeterminabilityEntry | None, "what the data determine; null if it was not asked"
    ]
    frf: Annotated[ByFrfs | None, "what only an update by FRFs has; null for one by frequencies"]
    warnings: Annotated[Sequence[str], "what the user should know"]
