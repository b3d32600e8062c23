"""Springs and dashpots to the ground beside closed forms and transfer matrices, and whether a diagnosis names them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import LOOK, imported
from scipy import linalg, optimize
from updating_cases import BEAM, ExactBeam, case_of, specimen, struck

from updating import LIBRARY, diagnose
from updating.effects.base import total_mass
from updating.effects.structure.axial_load import buckling_load
from updating.effects.structure.spring import lowest
from updating.models.state import NOMINAL, State

EFFECT = LIBRARY["ground_spring"]
EI = 210e9 * BEAM.width * BEAM.thickness**3 / 12
LINE = 7850.0 * BEAM.width * BEAM.thickness
SIZE = (BEAM.length, BEAM.width, BEAM.thickness)
UNIT = EI / BEAM.length**3


@pytest.mark.parametrize("place", ["beam", "timoshenko", "plate", "free"])
def test_a_foundation_under_all_of_it_adds_to_every_eigenvalue_alike(place: str) -> None:
    """K + k/M M: omega^2 rises by k/M in every mode, and 2 zeta omega by c/M; shapes stay (no rotary inertia)."""
    predictor = LOOK[place]
    mass, spec = total_mass(predictor.spec), predictor.spec
    stiffness, damping = 30 * UNIT, 0.5
    values = {"x": spec.length / 2, "y": spec.width / 2, "extent": spec.length}
    state = EFFECT.state(predictor, {**values, "stiffness": stiffness, "damping": damping})
    found, plain = (predictor.predict(s, count=4) for s in (state, NOMINAL))
    omega, before = 2 * np.pi * found.frequency, 2 * np.pi * plain.frequency
    close = 5e-3 if place == "timoshenko" else 1e-5
    assert omega**2 - before**2 == pytest.approx(np.full(4, stiffness / mass), rel=max(close, 1e-4))
    rates = 2 * (found.damping * omega - plain.damping * before)
    assert rates == pytest.approx(np.full(4, damping / mass), rel=max(close, 1e-4))
    size = np.abs(plain.constants).max()
    assert np.abs(found.constants) == pytest.approx(np.abs(plain.constants), abs=close * size)


@pytest.mark.parametrize("ratio", [1.0, 30.0, 3000.0])
def test_a_spring_at_the_tip(ratio: float) -> None:
    """1 + cos u cosh u + (k L^3 / EI u^3) (sin u cosh u - cos u sinh u) = 0."""

    def equation(u: float) -> float:
        own = (1 + np.cos(u) * np.cosh(u)) / np.cosh(u)
        return float(own + ratio / u**3 * (np.sin(u) - np.cos(u) * np.tanh(u)))

    grid = np.linspace(0.5, 6 * np.pi, 2000)
    signs = np.sign([equation(u) for u in grid])
    roots = [
        optimize.brentq(equation, grid[i], grid[i + 1]) for i in np.flatnonzero(signs[1:] != signs[:-1])[:5]
    ]
    exact = np.array(roots) ** 2 / (2 * np.pi * BEAM.length**2) * np.sqrt(EI / LINE)
    beam = LOOK["beam"]
    values = {"x": BEAM.length, "stiffness": ratio * UNIT}
    assert beam.predict(EFFECT.state(beam, values), count=5).frequency == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("place", ["beam", "timoshenko"])
@pytest.mark.parametrize(("low", "high"), [(0.1, 0.14), (0.15, 0.3), (0.0, 0.376)])
@pytest.mark.parametrize("ratio", [20.0, 500.0])
def test_a_foundation_under_a_stretch(place: str, low: float, high: float, ratio: float) -> None:
    """Transfer matrices of the beam with the foundation's reaction in their equilibrium."""
    predictor, shear = LOOK[place], place == "timoshenko"
    exact = ExactBeam(*SIZE, shear=shear, rotary=shear, beds=((low, high, ratio * UNIT),)).frequencies(5)
    values = {"x": (low + high) / 2, "extent": high - low, "stiffness": ratio * UNIT}
    found = predictor.predict(EFFECT.state(predictor, values), count=5).frequency
    assert found == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize(
    ("place", "at", "size"), [("beam", 1.0, 0.2), ("beam", 0.53, 0.3), ("plate", 1.0, 0.1)]
)
def test_a_strong_dashpot_beside_the_complex_modes(place: str, at: float, size: float) -> None:
    """All of s^2 M + s C + K: |s| of a mode that is damped by a fifth to a half is off its undamped one by a per cent.

    A fifteenth of that is left, or 0.05 %.
    """
    predictor = LOOK[place]
    unit = total_mass(predictor.spec) * lowest(predictor)
    values = {"x": at * BEAM.length, "y": 0.2, "extent": 0.0, "stiffness": 0.0, "damping": size * unit}
    state = EFFECT.state(predictor, values)
    found = predictor.predict(state, count=5)
    stiffness, mass = predictor.reduced.matrices(predictor.base.plus(state))
    n = len(stiffness)
    viscous = 2.0 * mass + 1e-6 * stiffness + state.losses[0].matrix[:n, :n]
    none, unit_matrix = np.zeros((n, n)), np.eye(n)
    first = np.block([[none, unit_matrix], [-stiffness, -viscous]])
    poles = linalg.eigvals(first, np.block([[unit_matrix, none], [none, mass]]))
    poles = np.sort_complex(1j * poles[poles.imag > 0])[::-1][:5]  # by their imaginary part, upwards
    size_of = np.abs(poles)
    plain = predictor.predict(count=5).frequency
    moved = np.abs(size_of / (2 * np.pi * plain) - 1).max()
    assert moved > 1e-3
    assert 2 * np.pi * found.frequency == pytest.approx(size_of, rel=max(moved / 15, 5e-4))


def left_by_axial_load(x: float, extent: float) -> float:
    """R.m.s. over modes of what the best load and a common factor leave of a spring's shifts [5e-4 of frequency]."""
    beam, load = LOOK["beam"], LIBRARY["axial_load"]
    values = {"x": x * BEAM.length, "extent": extent * BEAM.length, "stiffness": 3 * UNIT}

    def shift(state: State) -> np.ndarray:
        return np.log(beam.predict(state, count=4).frequency / beam.predict(count=4).frequency)

    held, critical = shift(EFFECT.state(beam, values)), buckling_load(beam)

    def misfit(p: np.ndarray) -> np.ndarray:
        found = shift(load.state(beam, {"force": p[0] * critical}))
        return np.append((found + p[1] - held) / 5e-4, p[1] / 5e-3)

    best = optimize.least_squares(misfit, [0.1, 0.0], bounds=([-0.7, -0.05], [5.0, 0.05]))
    return float(np.sqrt(2 * best.cost / 4))


@pytest.mark.long
def test_an_axial_load_does_what_a_spring_near_the_clamp_does_and_nothing_like_one_near_the_end() -> None:
    assert left_by_axial_load(0.35, 0.3) < 1.5
    assert left_by_axial_load(0.6, 0.3) > 6
    assert left_by_axial_load(0.85, 0.0) > 20


def test_two_cords_do_what_one_spring_does_to_the_frequencies_of_a_symmetric_structure() -> None:
    """To first order: k of either at mirrored places, or 2 k at one of them."""
    free = LOOK["free"]
    cords = {"stiffness": 0.5 * UNIT, "inset": 0.1, "cords": 2.0}
    hung = free.predict(LIBRARY["suspension"].state(free, cords), count=4).frequency
    one = free.predict(EFFECT.state(free, {"x": 0.1 * BEAM.length, "stiffness": UNIT}), count=4).frequency
    plain = free.predict(count=4).frequency
    assert np.log(one / plain) == pytest.approx(np.log(hung / plain), rel=0.02)


def test_a_stretch_stays_on_the_structure() -> None:
    for place in ("beam", "plate"):
        predictor = LOOK[place]
        sizes = {"x": predictor.spec.length, "y": predictor.spec.width}
        axes = ("x", "y")[: predictor.spec.dim]
        for x, extent in ((0.0, 0.1), (1.0, 0.05), (0.3, 0.376)):
            values = {"x": x * sizes["x"], "y": x * sizes["y"], "extent": extent, "stiffness": 1.0}
            settled = EFFECT.settled(predictor, values)
            for axis in axes:
                half = min(extent, sizes[axis]) / 2
                assert half - 1e-12 <= settled[axis] <= sizes[axis] - half + 1e-12
        point = {"x": 0.123, "y": 0.077, "extent": 0.0, "stiffness": 1.0}
        assert dict(EFFECT.settled(predictor, point)) == pytest.approx(point)


def test_on_matrices_it_acts_along_what_is_measured() -> None:
    """A cantilever's matrices, held along z at a test point: as the same beam with a spring."""
    predictor = imported()
    at = predictor.measured.points[3]
    values = dict(zip("xyz", at, strict=True)) | {"extent": 0.0, "stiffness": 2e4, "damping": 0.0}
    state = EFFECT.state(predictor, values)
    across = replace(predictor.measured, directions=np.tile([0.0, 1.0, 0.0], (5, 1)))
    sideways = EFFECT.state(predictor.for_test(across), values)
    rows = predictor.reduced.rows(at[None], np.array([[0.0, 0.0, 1.0]]))["w"]
    (unit,) = state.stiffness
    assert unit == pytest.approx(2e4 * rows.T @ rows)
    assert sideways.stiffness[0] != pytest.approx(unit, rel=1e-3)


@pytest.mark.parametrize(("x", "ratio"), [(0.21, 20.0), pytest.param(0.376, 4.0, marks=pytest.mark.long)])
def test_a_diagnosis_names_it(x: float, ratio: float) -> None:
    rng = np.random.default_rng(5)
    bench = specimen(rng)
    held = replace(bench, beds=((max(x - 0.001, 0.0), min(x + 0.001, bench.length), ratio * UNIT),))
    names = ("ground_spring", "axial_load", "E", "clamp_rotation", "local_stiffness", "length")
    found = diagnose(case_of(struck(held, rng)), library=[LIBRARY[n] for n in names])
    assert found.ranking[0].effects == ("ground_spring",), found.table()
    stated = found.ranking[0].parameters["ground_spring.stiffness"]
    assert stated.low95 is not None and stated.high95 is not None
    assert 0.8 * stated.low95 < ratio * UNIT < 1.2 * stated.high95
