"""Effects beside closed forms, transcendental equations, transfer matrices and complex eigen-solutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import CORNERS, LOOK, THIN, form
from exact_cases import SIZE, predicted
from scipy import linalg, optimize, special
from updating_cases import BEAM, PLATE, POINTS, STEEL, ExactBeam, blank

from modalkit.simulator.bodies.plate.plate import Plate
from updating import LIBRARY, Predictor
from updating.effects.box import mirror_images
from updating.effects.structure.axial_load import buckling_load
from updating.effects.structure.sensors import sensor_places
from updating.models import PointMass, build_structure
from updating.models.state import State

EI = 210e9 * BEAM.width * BEAM.thickness**3 / 12


LINE = 7850.0 * BEAM.width * BEAM.thickness


def hertz(roots: np.ndarray) -> np.ndarray:
    """Frequencies of an Euler-Bernoulli beam from the roots lambda = beta L."""
    return roots**2 / (2 * np.pi * BEAM.length**2) * np.sqrt(EI / LINE)


def roots_of(function: object, count: int) -> np.ndarray:
    grid = np.linspace(0.2, (count + 1) * np.pi, 3000)
    values = np.array([function(u) for u in grid])  # type: ignore[operator]
    found = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    return np.array([optimize.brentq(function, grid[i], grid[i + 1], xtol=1e-13) for i in found])


@pytest.mark.parametrize("share", [0.01, 0.1, 0.45])
def test_a_body_at_the_tip(share: float) -> None:
    """Rayleigh's equation of a cantilever with a mass and its rotary inertia at the tip (Laura et al. 1974)."""
    mass = share * LINE * BEAM.length
    turning = mass * (mass / 7850.0) ** (2 / 3) / 6 / (LINE * BEAM.length**3)

    def rayleigh(u: float) -> float:
        s, c, sh, ch = np.sin(u), np.cos(u), np.sinh(u), np.cosh(u)
        whole = 1 + c * ch + share * u * (c * sh - s * ch)
        return float(
            (whole - turning * u**3 * (ch * s + sh * c) + share * turning * u**4 * (1 - c * ch)) / ch
        )

    found = predicted("lumped_mass", "beam", mass=mass, x=BEAM.length)
    assert found == pytest.approx(hertz(roots_of(rayleigh, 5)), rel=5e-5)


@pytest.mark.parametrize("slope", [-1.2, -0.1, 0.1, 0.8])
def test_a_wedge_clamped_at_one_end(slope: float) -> None:
    """Kirchhoff's wedge (1879): w = C(z) / z, C Bessel functions of order 1 of z = 2 p sqrt(xi), xi the thickness.

    EI is EI1 xi^3 and the mass of a length m1 xi, p^4 = m1 omega^2 / EI1; each derivative by xi raises the order by one
    and divides by z once more. At the free end the second and the third are nothing.
    """
    ends = 1 - slope / 2, 1 + slope / 2

    def rows(p: float, xi: float, order: int) -> list[float]:
        z = 2 * p * np.sqrt(xi)
        n, grown = 1 + order, np.exp(z - 2 * p)
        kinds = special.jv(n, z), special.yv(n, z), special.ive(n, z) * grown, special.kve(n, z) / grown
        return [
            sign**order * (p / z) ** n * value for value, sign in zip(kinds, (-1, -1, 1, -1), strict=True)
        ]

    def free_wedge(u: float) -> float:
        p = u / abs(slope)  # lengths in units in which the thickness changes by one
        matrix = np.array(
            [rows(p, ends[0], 0), rows(p, ends[0], 1), rows(p, ends[1], 2), rows(p, ends[1], 3)]
        )
        return float(np.linalg.det(matrix / np.linalg.norm(matrix, axis=0)))

    found = predicted("taper", "beam", slope=slope)
    assert found == pytest.approx(hertz(roots_of(free_wedge, 5)), rel=5e-5)


@pytest.mark.parametrize("place", ["beam", "timoshenko"])
@pytest.mark.parametrize("ratio", [8.0, 300.0, 3e4])
def test_a_clamp_that_shifts_but_does_not_turn(place: str, ratio: float) -> None:
    spring, shear = ratio * EI / BEAM.length**3, place == "timoshenko"
    exact = ExactBeam(*SIZE, translation=spring, shear=shear, rotary=shear).frequencies(5)
    assert predicted("clamp_translation", place, stiffness=spring) == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("place", ["beam", "timoshenko"])
@pytest.mark.parametrize(("turn", "shift"), [(20.0, 500.0), (300.0, 1e4)])
def test_a_clamp_that_shifts_and_turns_as_a_pair(place: str, turn: float, shift: float) -> None:
    predictor, shear = LOOK[place], place == "timoshenko"
    values = {"clamp_rotation": turn * EI / BEAM.length, "clamp_translation": shift * EI / BEAM.length**3}
    state = State()
    for name, stiffness in values.items():
        state = state.plus(LIBRARY[name].state(predictor, {"stiffness": stiffness}))
    exact = ExactBeam(
        *SIZE,
        translation=values["clamp_translation"],
        rotation=values["clamp_rotation"],
        shear=shear,
        rotary=shear,
    )
    found = predictor.predict(state, count=5).frequency
    assert found == pytest.approx(exact.frequencies(5), rel=1e-4)


def test_a_shifting_clamp_holds_its_slope_in_frfs_too() -> None:
    """What turns is cut off from all else: FRFs far below it show nothing of it."""
    predictor = LOOK["beam"]
    state = LIBRARY["clamp_translation"].state(predictor, {"stiffness": 100 * EI / BEAM.length**3})
    still = 1j * 2 * np.pi * np.array([1e-3])
    given = predictor.receptance(still, state)[-1, 0].real
    assert given == pytest.approx(BEAM.length**3 / (3 * EI) + BEAM.length**3 / (100 * EI), rel=1e-4)


def axially_loaded(force: float, count: int) -> np.ndarray:
    """Cantilever under a dead load along it: (w, w', M, S) carried from the clamp to the tip."""

    def tip(hertz: float) -> float:
        omega = 2 * np.pi * hertz
        rate = np.array([[0, 1, 0, 0], [0, 0, 1 / EI, 0], [0, force, 0, 1], [LINE * omega**2, 0, 0, 0]])
        carried = linalg.expm(rate * BEAM.length)[2:, 2:]
        return float(np.linalg.det(carried))

    grid = np.linspace(2.0, 2200.0, 6000)
    values = np.array([tip(f) for f in grid])
    found = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    return np.array([optimize.brentq(tip, grid[i], grid[i + 1], xtol=1e-10) for i in found])


@pytest.mark.parametrize("share", [-0.9, -0.7, 0.5, 4.0])
def test_a_beam_under_tension_and_thrust(share: float) -> None:
    force = share * np.pi**2 * EI / (4 * BEAM.length**2)
    assert predicted("axial_load", "beam", force=force) == pytest.approx(axially_loaded(force, 5), rel=2e-5)


@pytest.mark.parametrize("clamped", [("x0", "x1"), ("y0", "y1")])
@pytest.mark.parametrize("size", ["length", "width"])
def test_a_tension_of_a_plate_of_another_size(clamped: tuple[str, ...], size: str) -> None:
    """Along the force slopes fall with the size; across it more edge carries the same force."""
    spec, factor = replace(PLATE, clamped=clamped), 1.1
    points = blank(np.array([(0.1, 0.05), (0.2, 0.1)]))
    force = 2 * buckling_load(Predictor(spec, points))
    there = Predictor(replace(spec, **{size: factor * getattr(spec, size)}), points)
    loaded = there.predict(LIBRARY["axial_load"].state(there, {"force": force}), count=1).frequency
    scaled = Predictor(spec, points, additions=(lambda _: State(factors={size: factor}),))
    found = scaled.predict(LIBRARY["axial_load"].state(scaled, {"force": force}), count=1).frequency
    assert found == pytest.approx(loaded, rel=1e-3)


@pytest.mark.parametrize(("clamped", "factor"), [(("x0",), 0.25), (("x0", "x1"), 4.0)])
def test_euler_buckles(clamped: tuple[str, ...], factor: float) -> None:
    predictor = Predictor(replace(THIN, clamped=clamped), blank(POINTS[:3]))
    critical = buckling_load(predictor)
    assert critical == pytest.approx(factor * np.pi**2 * EI / BEAM.length**2, rel=1e-4)
    nearly = LIBRARY["axial_load"].state(predictor, {"force": -0.9999 * critical})
    first = predictor.predict(count=1).frequency[0]
    assert predictor.predict(nearly, count=1).frequency[0] < 0.03 * first


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.8])
def test_huber_is_a_change_of_scale_across(ratio: float) -> None:
    """With D_1 and D_xy from the geometric mean the plate is an isotropic one of width W ratio^(-1/4)."""
    narrower = replace(PLATE, width=PLATE.width * ratio**-0.25, regions=())
    values = build_structure(narrower).eigen(5)[0]
    found = predicted("orthotropy", "plate", ratio=ratio)
    assert found == pytest.approx(np.sqrt(values) / (2 * np.pi), rel=5e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    ("ratio", "shear_ratio", "coupling"), [(0.5, 0.3, 1.0), (1.8, 2.0, 0.4), (4.0, 0.15, 2.0)]
)
def test_a_hinged_plate_of_four_constants(ratio: float, shear_ratio: float, coupling: float) -> None:
    """Lekhnitskii, Anisotropic Plates, 1968: the shapes are sines, the frequencies a sum of D_1, D_2 and D_3."""
    around = replace(PLATE, clamped=("x0", "x1", "y0", "y1"), elements=(14, 10), regions=(), masses=())
    inside = np.array([(x, y) for x in np.linspace(0.05, 0.35, 4) for y in (0.02, 0.1, 0.17)])
    predictor = Predictor(around, blank(inside))
    hinges = LIBRARY["clamp_rotation"].state(predictor, {"stiffness": 1e-3})
    values = {"ratio": ratio, "shear_ratio": shear_ratio, "coupling": coupling}
    found = predictor.predict(LIBRARY["orthotropy"].state(predictor, values).plus(hinges), count=8).frequency
    nu = STEEL.poisson
    along = STEEL.E * PLATE.thickness**3 / 12 / (1 - nu**2)
    mixed = np.sqrt(ratio) * (nu * coupling + (1 - nu) * shear_ratio)
    m, n = np.meshgrid(np.arange(1, 12) / PLATE.length, np.arange(1, 8) / PLATE.width)
    energy = along * (m**4 + 2 * mixed * (m * n) ** 2 + ratio * n**4)
    exact = np.pi / 2 * np.sort(np.sqrt(energy / STEEL.density / PLATE.thickness), axis=None)[:8]
    assert found == pytest.approx(exact, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("clamped", [("x0",), (), ("x0", "x1")])
def test_a_sheet_that_shears_in_its_plane_as_it_likes_beside_the_rig(clamped: tuple[str, ...]) -> None:
    """Quintic elements that shear across the thickness too: twist and coupling each by itself, not their sum."""
    spec = replace(PLATE, theory="mindlin", clamped=clamped, elements=(16, 10), regions=(), masses=())
    predictor = Predictor(spec, blank(CORNERS))
    values = {"ratio": 0.7, "shear_ratio": 0.75}
    found = predictor.predict(LIBRARY["orthotropy"].state(predictor, values), count=8).frequency
    body = Plate(
        0.0, spec.length, spec.width, spec.thickness, STEEL.E, STEEL.density, clamped=clamped, **values
    )
    omega, _ = body.real_modes(8 + body.rigid_modes)
    assert found == pytest.approx(omega[body.rigid_modes :] / (2 * np.pi), rel=1e-3)


def test_an_accelerometer_that_roves_loads_the_mean_of_its_places() -> None:
    """To first order: the mean frequency of a model loaded at one place after the other, to 2 % of the shift."""
    predictor = LOOK["beam"]
    test = predictor.measured
    roving = predictor.for_test(replace(test, seen=test.hit, hit=test.seen))
    assert LIBRARY["sensor_mass"].why_not(roving) is None
    mass = 0.001 * LINE * BEAM.length
    found = roving.predict(LIBRARY["sensor_mass"].state(roving, {"mass": mass}), count=5).frequency
    one_by_one = [
        predicted("lumped_mass", "beam", mass=mass, x=float(x)) for x in sensor_places(roving)[:, 0]
    ]
    plain = predictor.predict(count=5).frequency
    assert found / plain - 1 == pytest.approx(np.mean(one_by_one, axis=0) / plain - 1, rel=0.02)


def test_a_mirror_image_is_another_place() -> None:
    free = replace(THIN, clamped=())
    at = (0.1, 0.0, 0.0)
    assert mirror_images(free, at) == (at, pytest.approx((0.276, 0.0, 0.0)))
    assert mirror_images(THIN, at) == (at,)
    assert mirror_images(replace(free, masses=(PointMass((0.3,), 0.01),)), at) == (at,)
    assert len(mirror_images(free, (0.188, 0.0, 0.0))) == 1
    assert len(mirror_images(PLATE, (0.1, 0.05, 0.0))) == 2
    assert len(mirror_images(replace(PLATE, clamped=()), (0.1, 0.05, 0.0))) == 4
    both = [
        predicted("damping_patch", "free", **form(LIBRARY["damping_patch"], LOOK["free"]) | {"x": x})
        for x in (0.1, 0.276)
    ]
    assert both[0] == pytest.approx(both[1], rel=1e-7)
