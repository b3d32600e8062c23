"""The page of the model: what the study states, and what changes if effects are put into it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition import InputError
from acquisition.errors import ModalkitError
from acquisition.quantities import hertz
from identification import ModalModel
from modalkit.app.toml import toml_text
from modalkit.app.typed_units import WRITTEN
from modalkit.output.correlation import correlation_document
from modalkit.study.read import Study
from modalkit.views.charts.matrix import matrix_chart
from modalkit.views.curves import lines
from modalkit.views.pairs import pairs_in
from modalkit.views.shapes import Beside
from updating import LIBRARY
from updating.correlation.frfs import correlate_frfs
from updating.effects import Effect, Parameter, Variant, accepted_state, names_of
from updating.effects.limits import PLACES
from updating.models.named_factors import departure
from updating.models.spec import Spec
from updating.models.state import State
from updating.prediction.assignment import mac_of_constants
from updating.prediction.matching import Paired, pair_modes
from updating.prediction.predict import Predictor

FACTORS = ("E", "density", "thickness", "length", "width")
"""Factors of the whole model that can be moved."""

REGIONAL = ("E", "density", "thickness")
"""Factors of one region that can be moved."""

REACH = 0.25
"""How far a factor can be moved either way: ten times what a modeller doubts of any; beyond, pairs are lost [-]."""

LIMITS = (0.5, 2.0)
"""Between which any factor is taken; those of a region, which moves frequencies less, are moved that far [-]."""


@dataclass(frozen=True)
class Field:
    """A value that is edited by itself. All else is edited in the study's text.

    Parameters
    ----------
    label : str
        What it is called.
    path : tuple of str
        Where it stands in the study.
    unit : str
        Unit in which it is shown; another can be written behind the number.
    times : float
        What a number in this unit is in the study's [study's unit].
    outlined : bool
        Whether only models that are drawn by length and width have it, not matrices and decks.
    """

    label: str
    path: tuple[str, ...]
    unit: str = "–"
    times: float = 1.0
    outlined: bool = False


FIELDS = (
    Field("Length", ("model", "length"), "mm", 1e-3, outlined=True),
    Field("Width", ("model", "width"), "mm", 1e-3, outlined=True),
    Field("Thickness", ("model", "thickness"), "mm", 1e-3, outlined=True),
    Field("Modulus E", ("model", "material", "E"), "GPa", 1e9, outlined=True),
    Field("Density", ("model", "material", "density"), "kg/m³", outlined=True),
    Field("Poisson's ratio", ("model", "material", "poisson"), outlined=True),
    Field("Theory", ("model", "theory"), outlined=True),
    Field("Tolerance of E", ("tolerances", "E")),
    Field("Tolerance of density", ("tolerances", "density")),
    Field("Tolerance of thickness", ("tolerances", "thickness"), outlined=True),
    Field("Tolerance of length", ("tolerances", "length"), outlined=True),
    Field("Tolerance of width", ("tolerances", "width"), outlined=True),
    Field("Tolerance of damping", ("tolerances", "damping")),
    Field("Exponential window", ("test", "exponential_window"), "1/s"),
    Field("Calibration", ("test", "calibration")),
    Field("Repeatability", ("test", "repeatability")),
    Field("Fluid density", ("environment", "fluid_density"), "kg/m³", outlined=True),
)

THEORIES = {"plate": ("kirchhoff", "mindlin"), "beam": ("euler-bernoulli", "rayleigh", "timoshenko")}
"""What a model's theory can be, by its type."""


@dataclass(frozen=True)
class Moved:
    """Effects and factors that are tried out.

    Parameters
    ----------
    effects : sequence of mapping
        Each with its name and values, as ``[[model.effect]]``.
    factors : mapping of str to float
        Factors of the whole model, ``E``, or of a region, ``root.E`` [-].
    """

    effects: Sequence[Mapping[str, Any]] = ()
    factors: Mapping[str, float] | None = None


def model_page(content: Mapping[str, Any], study: Study, beside: Beside | None, why: str) -> dict[str, Any]:
    """Return what the study states, and where it has a model, pairs, MAC and what can be moved."""
    page: dict[str, Any] = {
        "text": toml_text(content),
        "test": dict(content.get("test", {})),
        "fields": _fields(content, study),
        "effects": list(content.get("model", {}).get("effect", [])),
        "update": study.update.model_dump(),
        "why": why,
        "sliders": [],
        "factors": [],
        "correlation": None,
    }
    if beside is None:
        return page
    predictor = beside.predictor
    page["correlation"] = correlation_document(beside.correlation)
    page["model_hz"] = predictor.predict().frequency
    page["sliders"] = _sliders(predictor)
    page["factors"] = _factors(predictor.spec)
    return page


def _factors(spec: Spec) -> list[dict[str, Any]]:
    """Return the factors that mean something to a model: those of the whole, and of its regions by their names."""
    found: list[dict[str, Any]] = [
        {"name": name, "region": "", "low": 1 - REACH, "high": 1 + REACH, "log": False}
        for name in FACTORS
        if _scales(spec, name)
    ]
    if spec.imported is None or spec.imported.deck is None:  # numbers of a deck are those of its own cards
        found += [
            {"name": f"{region}.{name}", "region": region, "low": LIMITS[0], "high": LIMITS[1], "log": True}
            for region in dict.fromkeys(one.name for one in spec.regions)
            for name in REGIONAL
            if _scales(spec, name, regional=True)
        ]
    return found


def _scales(spec: Spec, name: str, *, regional: bool = False) -> bool:
    """Return whether a factor means something to a model; imported matrices have few."""
    return spec.imported is None or spec.imported.obstacle(name, regional=regional) is None


def _fields(content: Mapping[str, Any], study: Study) -> list[dict[str, Any]]:
    """Return the values that the study's kind of model has."""
    if study.model is None:
        return []
    kind = study.model.type
    return [_field(content, study, one) for one in FIELDS if kind in THEORIES or not one.outlined]


def _field(content: Mapping[str, Any], study: Study, field: Field) -> dict[str, Any]:
    """Return a value in the unit in which it stands in the file, or what is taken in its place."""
    stated: Any = content
    taken: Any = study
    for key in field.path:
        stated = stated.get(key) if isinstance(stated, Mapping) else None
        taken = getattr(taken, key, None)
    theory = field.path[-1] == "theory" and study.model is not None
    own = WRITTEN.fullmatch(stated.strip()) if isinstance(stated, str) and not theory else None
    return {
        "label": field.label,
        "path": field.path,
        "unit": "" if theory else field.unit if own is None else own[2],
        "times": field.times,
        "bare": field.times == 1.0 and own is None,
        "value": stated if own is None else own[1],
        "default": taken,
        "choices": THEORIES[study.model.type] if theory and study.model is not None else None,
    }


def _sliders(predictor: Predictor) -> list[dict[str, Any]]:
    """Return the effects that can act on this specimen, with their places and the ranges of their parameters."""
    found = []
    for name, effect in LIBRARY.items():
        if effect.labels or effect.why_not(predictor) is not None:
            continue
        if parameters := effect.parameters(predictor):
            found.append(
                {
                    "name": name,
                    "summary": effect.summary,
                    "parameters": [_slider(p) for p in parameters],
                    "forms": _forms(effect, predictor),
                }
            )
    return found


def _slider(p: Parameter) -> dict[str, Any]:
    low = -p.high if p.signed and not p.log and p.low >= 0 else p.low
    return {"name": p.name, "unit": p.unit, "low": low, "high": p.high, "log": p.log}


def _forms(effect: Effect, predictor: Predictor) -> list[dict[str, Any]]:
    """Return the places of an effect by their names in the model, and where the sliders there start.

    Of what the names say already, as where a node set is, there is no slider.
    """
    names = names_of(effect, predictor.spec)
    fixed: dict[tuple[tuple[str, Any], ...], dict[str, Any]] = {}
    for variant in effect.variants(predictor) if names else (Variant(),):
        place = tuple((key, value) for key, value in variant.values.items() if key in names)
        fixed[place] = dict(variant.values) | fixed.get(place, {})
    parameters = effect.parameters(predictor)
    return [
        {
            "names": dict(place),
            "start": {
                p.name: known.get(p.name, p.default if p.default is not None else p.value(0.5))
                for p in parameters
                if not (p.name in PLACES and "at" in dict(place))
            },
        }
        for place, known in fixed.items()
    ]


def moved_page(beside: Beside, identified: ModalModel | None, moved: Moved, index: int) -> dict[str, Any]:
    """Return frequencies, MAC and one FRF of the model with effects and factors moved.

    Raises
    ------
    InputError
        If a factor is none that can be moved.
    StudyError
        If an effect does not take such values.
    """
    predictor = _with(beside.predictor, moved)
    measured = beside.session.case.measured
    prediction = predictor.predict()
    page: dict[str, Any] = {"model_hz": prediction.frequency, "pairs": [], "mac": None, "frf": None}
    if measured.has_shapes:
        found = mac_of_constants(measured, prediction)
        hz = [
            [f"{i + 1}: {hertz(f)}" for i, f in enumerate(own)]
            for own in (measured.frequency, prediction.frequency)
        ]
        title = "Measured modes with those of the model"
        page["mac"] = matrix_chart("mac", title, "In hundredths.", found, *hz, axes=("test", "model")).data()
    try:
        paired = pair_modes(measured, prediction)
    except ModalkitError as error:
        return page | {"why": str(error)}
    page["pairs"] = [
        {
            "test_mode": one.test + 1,
            "model_mode": one.model + 1,
            "test_hz": measured.frequency[one.test],
            "model_hz": prediction.frequency[one.model],
            "error_percent": 100 * (prediction.frequency[one.model] / measured.frequency[one.test] - 1),
            "mac": one.mac,
        }
        for one in pairs_in(paired, measured, prediction)
    ]
    if identified is not None:
        row = min(max(index, 0), len(identified.frfs.responses) - 1)
        page["frf"] = _frf(identified, row, predictor, paired)
    return page


def _frf(identified: ModalModel, row: int, predictor: Predictor, paired: Paired) -> dict[str, Any] | None:
    """Return an FRF with the model's; None where it is not one of the test's."""
    frfs = identified.frfs.select([row])
    try:
        both = correlate_frfs(frfs, predictor.measured, predictor, predictor.predict(), paired)
    except ModalkitError:
        return None
    return lines(
        both.measured.frequency,
        measured=np.abs(both.measured.values[0]),
        model=np.abs(both.model.values[0]),
        measured_phase=np.degrees(np.angle(both.measured.values[0])),
        model_phase=np.degrees(np.angle(both.model.values[0])),
    ) | {"unit": both.measured.unit, "frac": both.frac[0]}


def _with(predictor: Predictor, moved: Moved) -> Predictor:
    """Return the predictor with what is moved in its model, on the same basis."""
    factors = dict(moved.factors or {})
    known = [one["name"] for one in _factors(predictor.spec)]
    if strange := sorted(set(factors) - set(known)):
        raise InputError(f"there is no factor {strange[0]}; those that can be moved are {', '.join(known)}")
    if wild := [v for v in factors.values() if not LIMITS[0] <= v <= LIMITS[1]]:
        raise InputError(f"a factor of {wild[0]:g} is outside the range of the sliders; edit the study")

    def state(own: Predictor) -> State:
        total = departure(own.spec, factors)
        for entry in moved.effects:
            values = {key: value for key, value in entry.items() if key != "name"}
            total = total.plus(accepted_state(own, str(entry.get("name")), values))
        return total

    return predictor.for_test(predictor.measured, (*predictor.additions, state))
