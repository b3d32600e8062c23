"""A place of another mass beside transfer matrices and Ritz's method, by its prior, and named by diagnoses."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from effect_cases import LOOK
from numpy.polynomial import legendre
from scipy import linalg
from updating_cases import BEAM, PLATE, STEEL, ExactBeam, blank, case_of, observed, specimen, struck

from modalkit.simulator.bodies.plate.parts import Patch
from modalkit.simulator.bodies.plate.plate import Plate
from updating import LIBRARY, Case, Predictor, Spec, diagnose

EFFECT = LIBRARY["local_mass"]
OWN = BEAM.length * BEAM.width * BEAM.thickness * STEEL.density
AREA = STEEL.density * PLATE.thickness


def shifts(predictor: Predictor, values: dict[str, float], count: int) -> np.ndarray:
    found = predictor.predict(EFFECT.state(predictor, values), count=count).frequency
    return np.asarray(np.log(found / predictor.predict(count=count).frequency))


@pytest.mark.parametrize("place", ["beam", "timoshenko", "free"])
@pytest.mark.parametrize(
    ("low", "high", "factor"), [(0.05, 0.07, 3.0), (0.1, 0.22, 1.4), (0.25, 0.376, 4.0), (0.2, 0.3, 0.3)]
)
def test_a_stretch_of_a_beam_by_transfer_matrices(place: str, low: float, high: float, factor: float) -> None:
    """Its edges are sharp there: the shift of every mode to within two hundredths of the largest."""
    thick = place == "timoshenko"
    size = (BEAM.length, BEAM.width, BEAM.thickness)
    bare = ExactBeam(*size, shear=thick, rotary=thick, clamped=place != "free")
    exact = np.log(replace(bare, heavy=(low, high, factor)).frequencies(6) / bare.frequencies(6))
    values = {"x": (low + high) / 2, "extent": high - low, "factor": factor}
    assert shifts(LOOK[place], values, 6) == pytest.approx(exact, rel=0, abs=0.02 * np.abs(exact).max())
    mass = EFFECT.derived(LOOK[place], values)["mass"]
    assert mass == (pytest.approx((factor - 1) * OWN * (high - low) / BEAM.length, rel=0.02), "kg")


def polynomials(
    size: float, breaks: tuple[float, float], *, clamped: bool, count: int = 16
) -> list[np.ndarray]:
    """Legendre polynomials, times x^2 from a clamp, with two derivatives, at Gauss points of every piece; weights."""
    edges = np.unique([0.0, *breaks, size])
    at, weight = legendre.leggauss(count + 4)
    x = np.concatenate([(a + b) / 2 + at * (b - a) / 2 for a, b in pairwise(edges)])
    weights = np.concatenate([weight * (b - a) / 2 for a, b in pairwise(edges)])
    held = np.polynomial.Polynomial([0, 0, 1] if clamped else [1])
    found = []
    for i in range(count):
        own = legendre.Legendre.basis(i, domain=[0, size]).convert(kind=np.polynomial.Polynomial) * held
        found.append([own(x), own.deriv(1)(x), own.deriv(2)(x)])
    return [np.array([f[d] for f in found]) for d in range(3)] + [x, weights]


def ritz(spec: Spec, box: tuple[float, float, float, float], factor: float, modes: int) -> np.ndarray:
    """Kirchhoff's plate with a heavier rectangle (x from, to, y from, to) by Ritz's method [Hz]."""
    E, nu, h = spec.material.E, spec.material.poisson, spec.thickness
    x0, x1, x2, x, wx = polynomials(spec.length, box[:2], clamped="x0" in spec.clamped)
    y0, y1, y2, y, wy = polynomials(spec.width, box[2:], clamped=False)

    def times(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
        return np.kron((a * wx) @ c.T, (b * wy) @ d.T)

    bend = E * h**3 / 12 / (1 - nu**2)
    mixed = times(x2, y0, x0, y2)
    stiffness = bend * (
        times(x2, y0, x2, y0)
        + times(x0, y2, x0, y2)
        + nu * (mixed + mixed.T)
        + 2 * (1 - nu) * times(x1, y1, x1, y1)
    )
    inside_x, inside_y = (x > box[0]) & (x < box[1]), (y > box[2]) & (y < box[3])
    mass = AREA * times(x0, y0, x0, y0)
    mass += (factor - 1) * AREA * times(x0 * inside_x, y0 * inside_y, x0, y0)
    scale = 1 / np.sqrt(np.diag(mass))
    rigid = 0 if spec.clamped else 3
    values = linalg.eigh(
        stiffness * np.outer(scale, scale),
        mass * np.outer(scale, scale),
        eigvals_only=True,
        subset_by_index=(rigid, rigid + modes - 1),
    )
    return np.asarray(np.sqrt(values) / (2 * np.pi))


@pytest.mark.long
@pytest.mark.parametrize("clamped", [("x0",), ()])
@pytest.mark.parametrize(
    ("box", "factor"),
    [((0.1, 0.2, 0.05, 0.11), 2.0), ((0.25, 0.376, 0.13, 0.2), 3.0), ((0.05, 0.17, 0.02, 0.09), 0.4)],
)
def test_a_rectangle_of_a_plate_by_ritz(
    clamped: tuple[str, ...], box: tuple[float, float, float, float], factor: float
) -> None:
    predictor = Predictor(
        replace(PLATE, clamped=clamped, elements=(24, 14)), blank(LOOK["plate"].measured.points)
    )
    exact = np.log(ritz(predictor.spec, box, factor, 8) / ritz(predictor.spec, box, 1.0, 8))
    values = {
        "x": (box[0] + box[1]) / 2,
        "y": (box[2] + box[3]) / 2,
        "extent": box[1] - box[0],
        "extent_y": box[3] - box[2],
        "factor": factor,
    }
    most = EFFECT.fidelity * np.abs(exact).max()
    assert shifts(predictor, values, 8) == pytest.approx(exact, rel=0, abs=most)
    mass = (factor - 1) * AREA * (box[1] - box[0]) * (box[3] - box[2])
    assert EFFECT.derived(predictor, values)["mass"] == (pytest.approx(mass, rel=0.04), "kg")


def test_all_of_a_structure_is_its_density() -> None:
    """Both halves of a free beam are the whole."""
    whole = LOOK["free"].predict(LIBRARY["density"].state(LOOK["free"], {"factor": 1.2}), count=5).frequency
    halves = [{"x": share * BEAM.length, "extent": BEAM.length / 2, "factor": 1.2} for share in (0.25, 0.75)]
    one, two = (EFFECT.state(LOOK["free"], half) for half in halves)
    assert LOOK["free"].predict(one.plus(two), count=5).frequency == pytest.approx(whole, rel=2e-4)


def test_a_short_place_is_a_body() -> None:
    values = {"x": 0.3, "extent": 0.01, "factor": 3.0}
    body = {"mass": EFFECT.derived(LOOK["beam"], values)["mass"][0], "x": 0.3, "bulk": 0.0}
    found = LOOK["beam"].predict(LIBRARY["lumped_mass"].state(LOOK["beam"], body), count=4).frequency
    own = LOOK["beam"].predict(EFFECT.state(LOOK["beam"], values), count=4).frequency
    plain = LOOK["beam"].predict(count=4).frequency
    assert np.log(own / plain) == pytest.approx(np.log(found / plain), abs=0.02 * np.log(plain / own).max())


@pytest.mark.parametrize("place", ["beam", "plate"])
def test_heavier_and_lighter_are_two_forms_each_uniform_in_log_mass(place: str) -> None:
    predictor = LOOK[place]
    for chosen, sign in zip(EFFECT.variants(predictor), (1, -1), strict=True):
        masses = []
        for u in np.linspace(0.05, 0.95, 7):
            q = chosen.quantile("factor", u if sign > 0 else 1 - u)
            values = EFFECT.values(predictor, [0.5] * (len(EFFECT.parameters(predictor)) - 1) + [q])
            masses.append(sign * EFFECT.weight(predictor, values))
            assert ("heavier" if sign > 0 else "lighter") in EFFECT.sentence(values)
        assert (np.array(masses) > 0).all()
        assert np.diff(np.log(masses)) == pytest.approx(np.diff(np.log(masses))[0])


@pytest.mark.parametrize(
    ("low", "high", "factor"), [(0.1, 0.2, 1.4), pytest.param(0.2, 0.3, 0.6, marks=pytest.mark.long)]
)
def test_a_diagnosis_names_it_on_a_beam(low: float, high: float, factor: float) -> None:
    rng = np.random.default_rng(5)
    made = replace(specimen(rng), heavy=(low, high, factor))
    names = ("local_mass", "lumped_mass", "E", "density", "clamp_rotation", "local_stiffness", "length")
    found = diagnose(case_of(struck(made, rng)), library=[LIBRARY[n] for n in names])
    assert found.verdict == "named"
    assert found.sets == (("local_mass",),)
    row = found.ranking[0].parameters
    truth = {
        "mass": (factor - 1) * OWN * (high - low) / BEAM.length,
        "x": (low + high) / 2,
    }
    for name, value in truth.items():
        stated = row[f"local_mass.{name}"]
        assert stated.low95 is not None and stated.high95 is not None
        assert stated.low95 < value < stated.high95, name
    assert found.where.channel == "mass"


@pytest.mark.long
def test_a_diagnosis_names_it_on_a_plate() -> None:
    """The rig's thick plate, quintic elements with edges along the sheet's, and a thick plate as its model."""
    spec = replace(PLATE, theory="mindlin", elements=(16, 10))
    sheet = {"x": 0.25, "y": 0.12, "extent": 0.1, "extent_y": 0.07}
    patch = Patch(sheet["x"], sheet["y"], sheet["extent"], sheet["extent_y"], mass=0.8)
    size = (0.0, spec.length, spec.width, spec.thickness)
    body = Plate(*size, STEEL.E, STEEL.density, clamped=spec.clamped, patches=(patch,))
    omega, shapes = body.real_modes(8)
    points = np.array([(x, y) for x in np.linspace(0.06, 0.376, 6) for y in (0.0, 0.1, 0.2)])
    phi = body.rows(points, "w") @ shapes
    rng = np.random.default_rng(3)
    damping = 0.5 * (2.0 / omega + 1e-6 * omega)
    measured = observed(omega / (2 * np.pi), damping, phi * phi[-1], points, rng)
    found = diagnose(Case("sheet", spec, measured))
    assert found.verdict == "named", found.table()
    assert found.sets == (("local_mass",),)
    stated = found.ranking[0].parameters["local_mass.mass"]
    assert stated.low95 is not None and stated.high95 is not None
    assert stated.low95 < 0.8 * AREA * 0.1 * 0.07 < stated.high95
    assert found.where.location == pytest.approx((0.25, 0.12, 0.0), abs=2e-3)
