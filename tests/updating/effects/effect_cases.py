"""Specimens on which every effect is tried, and every effect put into the full matrices by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from imported_cases import imported_beam, seen_from, spec_of
from scipy import sparse
from updating_cases import BEAM, PLATE, POINTS, blank

from updating import LIBRARY, Effect, Predictor
from updating.models import FieldStructure, Spec
from updating.models.fields import Sparse

THIN = replace(BEAM, theory="euler-bernoulli")
CORNERS = np.array([[x, y] for x in np.linspace(0.09, 0.376, 4) for y in (0.0, 0.11, 0.2)])


def imported() -> Predictor:
    """A cantilever of four regions, given by its matrices, struck along z at five points."""
    spec = replace(spec_of(imported_beam(20, parts=(5, 10, 15))), damping=BEAM.damping)
    points = np.column_stack([np.linspace(0.1, 0.5, 5), np.zeros((5, 2))])
    seen = seen_from(points, np.tile([0.0, 0.0, 1.0], (5, 1)), np.array([20.0, 400.0]))
    return Predictor(spec, replace(seen, damping=np.full(2, 0.01), damping_sigma=np.full(2, 0.001)))


def complex_test(points: np.ndarray) -> Any:
    """A test that carries phases, and the course of its frequencies, as far as effects ask for them."""
    test = blank(points)
    chains = len(set(test.seen.tolist()))
    course = {"trend": np.zeros(2), "trend_sigma": np.full(2, 1e-4)}
    return replace(test, phase=np.zeros((chains, 2)), phase_sigma=np.full((chains, 2), 0.01), **course)


LOOK = {
    "beam": Predictor(THIN, complex_test(POINTS)),
    "timoshenko": Predictor(BEAM, complex_test(POINTS)),
    "plate": Predictor(PLATE, complex_test(CORNERS)),
    "no shapes": Predictor(THIN, blank(POINTS[:0], shapes_only=True)),
    "free": Predictor(replace(THIN, clamped=()), complex_test(POINTS)),
    "matrices": imported(),
}


def admits(name: str, place: str) -> bool:
    """Tell whether an effect can be examined."""
    return LIBRARY[name].why_not(LOOK[place]) is None


def admitted(
    names: Iterable[str] = LIBRARY, places: Iterable[str] = LOOK, *, formed: bool = False
) -> pytest.MarkDecorator:
    """Run a test for every name and place where the effect can be examined, and has a form if ``formed``."""
    places = tuple(places)
    cases = [
        (name, place)
        for name in names
        for place in places
        if admits(name, place) and (not formed or LIBRARY[name].variants(LOOK[place]))
    ]
    return pytest.mark.parametrize(("name", "place"), cases)


def form(effect: Effect, predictor: Predictor, quantile: float = 0.45, **ends: float) -> dict[str, Any]:
    """Return the values of an effect's first form at a quantile of all parameters."""
    parameters = effect.parameters(predictor)
    values = effect.values(predictor, [ends.get(p.name, quantile) for p in parameters])
    first = effect.variants(predictor)
    return {**values, **(first[-1].values if first else {})}


def full_modes(name: str, predictor: Predictor, values: dict[str, Any], count: int) -> np.ndarray:
    """Solve the sparse matrices of the full model with an effect put into them by hand [Hz]."""
    structure = predictor.reduced.structure
    assert isinstance(structure, FieldStructure)
    k, m, released = structure.matrix("stiffness"), structure.matrix("mass"), frozenset[str]()
    change = CHANGES[name](structure, values)
    k = Sparse(k + change.get("stiffness", 0 * k))
    m = Sparse(m + change.get("mass", 0 * m))
    released = change.get("released", released)
    first = structure.rigid_modes
    found = structure.eigen(first + count, stiffness=k, mass=m, released=released)[0][first:]
    if name != "exponential_window":
        return np.sqrt(found) / (2 * np.pi)
    ratio = np.nan_to_num(
        predictor.predict(count=count).damping
    )  # it moves poles beside their frequency of ringing
    ringing, real = np.sqrt(found * (1 - ratio**2)), ratio * np.sqrt(found) + values["decay"]
    return np.hypot(ringing, real) / (2 * np.pi)


def bound(effect: Effect, predictor: Predictor, full: np.ndarray) -> float:
    """How far the small model may be from the full one: 0.05 % of every frequency.

    Of an effect that shifts them by a quarter and more, a fifth of what it says its idealisation is off by.
    """
    shift = np.abs(np.log(full / predictor.predict(count=len(full)).frequency)).max()
    return max(5e-4, 0.2 * effect.fidelity * shift * (shift > 0.25))


def _row(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Sparse]:
    return structure.fields.at(np.array([[values[n] for n in ("x", "y")[: structure.fields.dim]]]))


def _body(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    """A body as bulky as some steel cubes of side a: m a^2 / 6 about its own axes each."""
    mass, rows = values["mass"], _row(structure, values)
    side = (mass / 7850.0) ** (1 / 3)
    total = mass * (rows["w"].T @ rows["w"])
    for name in ("wx", "wy"):
        if name in rows:
            total = total + values.get("bulk", 1.0) * mass * side**2 / 6 * (rows[name].T @ rows[name])
    return {"mass": total}


def _sensor(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    end = (POINTS[-1],) if structure.fields.dim == 1 else CORNERS[-1]
    sizes = (structure.spec.length, structure.spec.width)
    place = [np.clip(x + values.get(d, 0.0), 0, s) for x, d, s in zip(end, ("dx", "dy"), sizes, strict=False)]
    rows = structure.fields.at(np.atleast_2d(place))
    total = values["mass"] * (rows["w"].T @ rows["w"])
    side = (values["mass"] / 7850.0) ** (1 / 3)
    for name in ("wx", "wy"):
        if name in rows:
            turning = values.get("bulk", 0.0) * values["mass"] * side**2 / 6
            total = total + turning * (rows[name].T @ rows[name])
    return {"mass": total}


def _edge(structure: FieldStructure, field: str, power: int) -> Callable[[dict[str, Any]], Sparse]:
    """A spring along x = 0 by the trapezoidal rule over ten thousandths of the width."""
    fields, spec = structure.fields, structure.spec
    if spec.kind == "beam":
        name = (
            "r" if field == "slope" and spec.theory == "timoshenko" else {"slope": "wx", "shift": "w"}[field]
        )
        part = next(c for c in fields.components if name in c.names)
        rows, weights = part.at(np.zeros((1, 1)), fields.n_dofs)[name], np.ones(1)
    else:
        y = np.linspace(0, spec.width, 2001)
        rows = fields.at(np.column_stack([0 * y, y]))["wx" if field == "slope" else "w"]
        weights = np.full(2001, spec.width / 2000)
        weights[[0, -1]] /= 2
    unit = Sparse(rows.T @ sparse.diags_array(weights) @ rows)
    return lambda values: values["stiffness"] * unit


def _rotation(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    return {"stiffness": _edge(structure, "slope", 1)(values), "released": frozenset({"rotation"})}


def _translation(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    return {"stiffness": _edge(structure, "shift", 3)(values), "released": frozenset({"translation"})}


def _box(structure: FieldStructure, values: dict[str, Any], edge: float) -> np.ndarray:
    points, spec = structure.fields.points, structure.spec
    least = np.array([spec.length, spec.width][: points.shape[1]]) / np.array(spec.elements) / 3
    centre = np.array([values[n] for n in ("x", "y")[: points.shape[1]]])
    size = np.array([values["extent"], values.get("extent_y", values["extent"])][: points.shape[1]])
    steep = np.maximum(edge * size, least)
    return np.prod(0.5 + 0.5 * np.tanh((size / 2 - abs(points - centre)) / steep), axis=1)


def _sprung(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    """Springs side by side, a thousand along a stretch, on plates 120 x 120 over a square."""
    sizes = (structure.spec.length, structure.spec.width)[: structure.fields.dim]
    count = 1 if not values["extent"] else (1000, 120)[structure.fields.dim - 1]
    lines = []
    for name, size in zip("xy", sizes, strict=False):
        half = min(values["extent"], size) / 2
        middle = np.clip(values[name], half, size - half)
        lines.append(middle + 2 * half * ((np.arange(count) + 0.5) / count - 0.5))
    points = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, len(sizes))
    rows = structure.fields.at(points)["w"]
    return {"stiffness": values["stiffness"] / len(points) * (rows.T @ rows)}


def _hung(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    """Two to four cords, on plates the first two across a diagonal."""
    near, far, count = values["inset"], 1 - values["inset"], round(values["cords"])
    beam = {
        2: [near, far],
        3: [near, 0.5, far],
        4: [near, near + (far - near) / 3, far - (far - near) / 3, far],
    }
    corners = [[near, near], [far, far], [near, far], [far, near]]
    shares = np.array(beam[count])[:, None] if structure.fields.dim == 1 else np.array(corners[:count])
    sizes = np.array([structure.spec.length, structure.spec.width])[: structure.fields.dim]
    rows = structure.fields.at(shares * sizes)["w"]
    return {"stiffness": values["stiffness"] * (rows.T @ rows)}


def _soft(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    if structure.fields.dim == 1:
        return {"stiffness": _bent(structure, values)}
    return {"stiffness": structure.matrix("stiffness", -values["loss"] * _box(structure, values, 1 / 16))}


def _bent(structure: FieldStructure, values: dict[str, Any], count: int = 4000) -> Sparse:
    """Element by element: the moment is linear, and the curvature what it makes of it in a thousand slices."""
    spec, fields = structure.spec, structure.fields
    length = spec.length / spec.elements[0]
    read = (
        fields.sampled["rx" if "rx" in fields.sampled else "wxx"]
        .toarray()
        .reshape(spec.elements[0], -1, fields.n_dofs)
    )
    at, weights = fields.points[:, 0].reshape(len(read), -1), fields.weights.reshape(len(read), -1)
    bending = spec.material.E * spec.width * spec.thickness**3 / 12
    total = np.zeros((fields.n_dofs,) * 2)
    for element, curvature in enumerate(read):
        s = (np.arange(count) + 0.5) / count - 0.5
        away = abs((element + 0.5 + s) * length - values["x"])
        inside = 0.5 + 0.5 * np.tanh((values["extent"] / 2 - away) / (values["extent"] / 16))
        compliance = values["loss"] / (1 - values["loss"]) * inside
        linear = np.stack([np.ones(count), s])
        plain = linear @ linear.T * length / count / bending
        soft = (linear * (1 + compliance)) @ linear.T * length / count / bending
        own = np.stack([np.ones_like(at[element]), at[element] / length - element - 0.5])
        moments = (own * weights[element]) @ curvature
        total += moments.T @ (np.linalg.inv(soft) - np.linalg.inv(plain)) @ moments
    return Sparse(total)


def _heavy(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    """Bodies side by side, two thousand along a stretch, on plates 120 x 120 over a rectangle."""
    spec, dim = structure.spec, structure.fields.dim
    count, lines, section = (2000, 120)[dim - 1], [], spec.thickness * (spec.width if dim == 1 else 1.0)
    extents = values["extent"], values.get("extent_y", values["extent"])
    for name, extent, size in zip("xy"[:dim], extents, (spec.length, spec.width), strict=False):
        low, high = (min(max(values[name] + side * extent / 2, 0.0), size) for side in (-1, 1))
        lines.append(low + (high - low) * (np.arange(count) + 0.5) / count)
        section *= (high - low) / count
    points = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, dim)
    rows = structure.fields.at(points)["w"]
    return {"mass": (values["factor"] - 1) * spec.material.density * section * (rows.T @ rows)}


def _layer(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    inside = _box(structure, values, 0.0)
    heavy = structure.matrix("mass", values["mass"] * inside) - structure.point_masses()
    return {"stiffness": structure.matrix("stiffness", values["stiffness"] * inside), "mass": heavy}


def _tension(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    fields, spec = structure.fields, structure.spec
    force = values["force"] / (1 if spec.kind == "beam" else spec.width)
    slope = fields.sampled["wx"]
    return {"stiffness": force * (slope.T @ sparse.diags_array(fields.weights) @ slope)}


def _across(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    spec, fields = structure.spec, structure.fields
    nu, ratio = spec.material.poisson, values["ratio"]
    rigidity = spec.material.E * spec.thickness**3 / (12 * (1 - nu**2)) * sparse.diags_array(fields.weights)
    xx, yy, xy = (fields.sampled[n] for n in ("wxx", "wyy", "wxy"))
    mixed = xx.T @ rigidity @ yy
    root = np.sqrt(ratio) - 1
    root += np.sqrt(ratio) * (values.get("coupling", 1.0) - 1)
    change = (ratio - 1) * (yy.T @ rigidity @ yy) + root * nu * (mixed + mixed.T)
    twist = values.get("shear_ratio", 1.0) * np.sqrt(ratio) - 1
    return {"stiffness": change + twist * 2 * (1 - nu) * (xy.T @ rigidity @ xy)}


def _wedge(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    """Every term under the thickness that each quadrature point has, to the power of the term."""
    thicker = 1 + values["slope"] * (structure.fields.points[:, 0] / structure.spec.length - 0.5)
    found: dict[str, Any] = {}
    for term in structure.terms:
        left, right = (structure.fields.sampled[name] for name in (term.left, term.right))
        weight = term.coefficient * (thicker ** term.powers.get("thickness", 0.0) - 1)
        part = left.T @ sparse.diags_array(weight) @ right
        found[term.kind] = found.get(term.kind, 0) + (part + part.T) / 2
    return found


def _nothing(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
    return {}


def _scaled(powers: dict[str, float]) -> Callable[[FieldStructure, dict[str, Any]], dict[str, Any]]:
    def change(structure: FieldStructure, values: dict[str, Any]) -> dict[str, Any]:
        return {k: (values["factor"] ** p - 1) * structure.matrix(k) for k, p in powers.items()}

    return change


CHANGES: dict[str, Callable[[FieldStructure, dict[str, Any]], dict[str, Any]]] = {
    "E": _scaled({"stiffness": 1}),
    "density": _scaled({"mass": 1}),
    "section_scale": _scaled({"stiffness": 1, "mass": 1}),
    "clamp_rotation": _rotation,
    "clamp_translation": _translation,
    "sensor_mass": _sensor,
    "lumped_mass": _body,
    "local_stiffness": _soft,
    "local_mass": _heavy,
    "ground_spring": _sprung,
    "suspension": _hung,
    "damping_patch": _layer,
    "axial_load": _tension,
    "taper": _wedge,
    "orthotropy": _across,
    "uniform_damping": _nothing,
    "exponential_window": _nothing,
    "calibration_gain": _nothing,
    "channel_gain": _nothing,
    "time_delay": _nothing,
    "drift": _nothing,
    "polarity": _nothing,
    "swapped_points": _nothing,
    "position_error": _nothing,
}
"""What each effect adds to the full matrices; those of length, thickness, shear and the fluid are tested elsewhere."""


def scaled(spec: Spec, size: float) -> Spec:
    """Return the same specimen a few times as large in all directions."""
    return replace(
        spec, length=size * spec.length, width=size * spec.width, thickness=size * spec.thickness, regions=()
    )


CONTRACT = {
    "E": {"factor"},
    "density": {"factor"},
    "thickness": {"factor"},
    "section_scale": {"factor"},
    "taper": {"slope"},
    "length": {"extension"},
    "clamp_rotation": {"stiffness", "from", "to"},
    "clamp_translation": {"stiffness", "from", "to"},
    "sensor_mass": {"mass", "bulk", "dx", "dy"},
    "lumped_mass": {"mass", "x", "y", "bulk"},
    "local_stiffness": {"x", "y", "extent", "extent_y", "loss"},
    "local_mass": {"x", "y", "extent", "extent_y", "factor"},
    "ground_spring": {"x", "y", "extent", "stiffness", "damping"},
    "suspension": {"stiffness", "damping", "inset", "cords"},
    "absorber": {"x", "y", "mass", "frequency", "damping"},
    "shear": set(),
    "orthotropy": {"ratio", "shear_ratio", "coupling"},
    "axial_load": {"force"},
    "fluid_added_mass": {"fluid_density", "free_surface", "bottom", "wall"},
    "fluid_damping": {"viscosity"},
    "damping_patch": {"x", "y", "extent", "extent_y", "loss_factor", "alpha", "beta", "mass", "stiffness"},
    "uniform_damping": {"alpha", "beta", "loss_factor"},
    "joint_nonlinearity": {"slope", "joint"},
    "exponential_window": {"decay"},
    "calibration_gain": {"gain"},
    "channel_gain": {"gain", "points"},
    "time_delay": {"delay"},
    "drift": {"rate"},
    "polarity": {"points"},
    "swapped_points": {"points"},
    "position_error": {"point", "dx", "dy"},
}
"""Names and parameters that examinations outside this repository rest on."""

VANISHING = {
    "E": {"factor": 1.0},
    "density": {"factor": 1.0},
    "thickness": {"factor": 1.0},
    "section_scale": {"factor": 1.0},
    "taper": {"slope": 0.0},
    "length": {"extension": 0.0},
    "clamp_rotation": {},
    "clamp_translation": {},
    "sensor_mass": {"mass": 0.0},
    "lumped_mass": {"mass": 0.0},
    "local_stiffness": {"loss": 0.0},
    "local_mass": {"factor": 1.0},
    "ground_spring": {"stiffness": 0.0, "damping": 0.0},
    "absorber": {"mass": 0.0},
    "orthotropy": {"ratio": 1.0, "shear_ratio": 1.0, "coupling": 1.0},
    "axial_load": {"force": 0.0},
    "fluid_added_mass": {"fluid_density": 0.0},
    "fluid_damping": {"viscosity": 0.0},
    "damping_patch": {"loss_factor": 0.0, "alpha": 0.0, "beta": 0.0, "mass": 0.0, "stiffness": 0.0},
    "uniform_damping": {"alpha": 0.0, "beta": 0.0, "loss_factor": 0.0},
    "exponential_window": {"decay": 0.0},
    "calibration_gain": {"gain": 1.0},
    "channel_gain": {"gain": 1.0},
    "time_delay": {"delay": 0.0},
    "drift": {"rate": 0.0},
    "position_error": {"dx": 0.0, "dy": 0.0},
    "joint_nonlinearity": {"slope": 0.0},
}
"""Values at which an effect is none."""
