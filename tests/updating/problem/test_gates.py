"""Whether model and data are good enough to speak of a gap: against finer meshes, thick plates, exact beams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.linalg import eigh
from updating_cases import BEAM, PLATE, STEEL, ExactBeam, blank

from acquisition.errors import StudyError
from acquisition.quantities import hertz
from updating import Measured, Predictor, Region, Spec, build_structure
from updating.models.state import State
from updating.problem.gates import missing_mode, notes_on, on_levels, on_modes
from updating.problem.theory_error import discrepancy, theory_error

THIN = replace(BEAM, theory="euler-bernoulli")
POINTS = np.linspace(0.0752, 0.376, 5)
CORNERS = np.array([[x, y] for x in np.linspace(0.09, 0.376, 4) for y in (0.0, 0.11, 0.2)])


def evaluate(spec: Spec) -> Predictor:
    return Predictor(spec, blank(POINTS if spec.kind == "beam" else CORNERS * spec.length / 0.376))


def polynomials(count: int, length: float, clamped: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Legendre polynomials that vanish at clamped ends, their derivatives, and weights, at Gauss points."""
    at, weight = legendre.leggauss(count + 6)
    x, unit = (at + 1) / 2, np.eye(count)
    value = np.array([legendre.legval(at, c) for c in unit])
    slope = 2 * np.array([legendre.legval(at, legendre.legder(c)) for c in unit])
    edge, bent = np.ones_like(x), np.zeros_like(x)
    for end, factor, by in (("0", x, 1.0), ("1", 1 - x, -1.0)):
        if end in clamped:
            edge, bent = edge * factor, bent * factor + edge * by
    return value * edge, (slope * edge + value * bent) / length, weight * length / 2


def thick_plate(spec: Spec, modes: int, count: int = 18) -> np.ndarray:
    """Mindlin's plate by Ritz's method, natural frequencies of the elastic modes [Hz]."""
    E, rho, nu, h = spec.material.E, spec.material.density, spec.material.poisson, spec.thickness
    ends = ["".join(e[1] for e in spec.clamped if e[0] == axis) for axis in "xy"]
    x, dx, wx = polynomials(count, spec.length, ends[0])
    y, dy, wy = polynomials(count, spec.width, ends[1])

    def times(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
        return np.kron((a * wx) @ c.T, (b * wy) @ d.T)

    bend, shear = E * h**3 / 12 / (1 - nu**2), 5 / 6 * E / (2 * (1 + nu)) * h
    plain, along, across = times(x, y, x, y), times(dx, y, dx, y), times(x, dy, x, dy)
    cross = bend * (nu * times(dx, y, x, dy) + (1 - nu) / 2 * times(x, dy, dx, y))
    wp, wt = -shear * times(dx, y, x, y), -shear * times(x, dy, x, y)
    stiffness = np.block(
        [
            [shear * (along + across), wp, wt],
            [wp.T, shear * plain + bend * (along + (1 - nu) / 2 * across), cross],
            [wt.T, cross.T, shear * plain + bend * (across + (1 - nu) / 2 * along)],
        ]
    )
    mass = np.kron(np.diag([rho * h, rho * h**3 / 12, rho * h**3 / 12]), plain)
    rigid = 0 if spec.clamped else 3
    values = eigh(stiffness, mass, eigvals_only=True, subset_by_index=(rigid, rigid + modes - 1))
    return np.sqrt(values) / (2 * np.pi)


@pytest.mark.parametrize(
    ("clamped", "known"), [(("x0",), [0.348, 0.817, 2.036]), (("x0", "x1", "y0", "y1"), [3.296, 6.286])]
)
def test_the_thick_plate_of_this_file_is_the_published_one(
    clamped: tuple[str, ...], known: list[float]
) -> None:
    """Square plates of h / a = 0.1, omega a^2 sqrt(rho h / D) / pi^2: Liew, Xiang and Kitipornchai (1993)."""
    plate = Spec(
        "plate",
        length=1.0,
        width=1.0,
        thickness=0.1,
        elements=(4, 4),
        clamped=clamped,
        theory="kirchhoff",
        material=STEEL,
    )
    unit = np.pi / 2 * np.sqrt(STEEL.E * 0.1**3 / 12 / (1 - 0.3**2) / (STEEL.density * 0.1))
    assert thick_plate(plate, len(known), 12) / unit == pytest.approx(known, abs=0.0015)


@pytest.mark.long
@pytest.mark.parametrize("thickness", [0.003175, 0.01])
@pytest.mark.parametrize("clamped", [("x0",), ("x0", "x1", "y0", "y1"), ()])
def test_what_thin_plates_lack_is_known_mode_by_mode(thickness: float, clamped: tuple[str, ...]) -> None:
    spec = replace(PLATE, thickness=thickness, clamped=clamped, elements=(20, 12))
    found = theory_error(evaluate(spec), np.arange(8))
    structure = build_structure(replace(spec, elements=(38, 20)))
    values = structure.eigen(structure.rigid_modes + 8)[0][structure.rigid_modes :]
    exact = np.log(thick_plate(spec, 8) / (np.sqrt(values) / (2 * np.pi)))
    assert np.all(exact < 0)
    # the polynomials do not quite resolve what happens within the thickness of a free edge
    assert np.all(np.abs(found.theory - exact) < 0.2 * np.abs(exact) + 2e-4)


def test_beams_are_compared_with_exact_ones() -> None:
    spec = replace(THIN, elements=(12,))
    predictor = evaluate(spec)
    found = theory_error(predictor, np.arange(4))
    base = predictor.predict(count=4).frequency
    sizes = spec.length, spec.width, spec.thickness
    thin = ExactBeam(*sizes, shear=False, rotary=False).frequencies(4)
    thick = ExactBeam(*sizes).frequencies(4)
    assert found.mesh == pytest.approx(np.log(thin / base), rel=0.12, abs=2e-7)
    assert found.total == pytest.approx(np.log(thick / base), rel=0.05, abs=2e-6)
    assert discrepancy(predictor, np.array([3, 1])) == pytest.approx(found.total[[3, 1]])
    assert not theory_error(evaluate(BEAM), np.arange(4)).theory.any()


@pytest.mark.long
@pytest.mark.parametrize("elements", [(12, 6), (30, 20)])
def test_plates_are_compared_with_a_finer_mesh(elements: tuple[int, int]) -> None:
    """Finer than the estimate uses: the doubt may be too large by three, and too small by a third."""
    spec = replace(PLATE, elements=elements)
    found = theory_error(evaluate(spec), np.arange(8)).mesh
    base, fine = (
        np.sqrt(build_structure(replace(spec, elements=e)).eigen(8)[0]) for e in (elements, (60, 32))
    )
    exact = np.log(fine / base)
    assert np.all(found < 0)
    assert np.all(np.abs(found) > 0.66 * np.abs(exact))
    assert np.all(np.abs(found) < 3 * np.abs(exact) + 1e-5)


@pytest.mark.long
def test_narrow_regions_and_accepted_theories_are_no_trouble() -> None:
    sliver = Region("sliver", (0.1, 0.1012), (0.0, 0.2))
    spec = replace(PLATE, elements=(64, 8), regions=(sliver,))
    with pytest.raises(StudyError):
        build_structure(spec.with_elements(32, 4))
    assert np.abs(theory_error(evaluate(spec), np.arange(2)).mesh).max() < 1e-3
    shear = Predictor(THIN, blank(POINTS), additions=(lambda p: State(theory="timoshenko"),))
    assert not theory_error(shear, np.arange(3)).theory.any()


def test_remarks_name_what_is_off_by_more_than_the_noise() -> None:
    coarse = evaluate(replace(THIN, elements=(6,)))
    test, order = coarse.measured, np.array([1, 3])
    found = theory_error(coarse, order)
    message = " ".join(notes_on(found, test, coarse.spec))
    assert "use more elements" in message
    assert 'theory = "timoshenko"' in message
    fine = evaluate(replace(BEAM, elements=(80,), width=BEAM.width / 50))  # bends along its length alone
    assert notes_on(theory_error(fine, order), test, fine.spec) == []
    blind = replace(test, repeatability=0.05)
    assert notes_on(found, blind, coarse.spec) == []


@pytest.mark.parametrize("skipped", [1, 2, 4])
@pytest.mark.parametrize("factor", [1.0, 0.8])
def test_a_mode_missing_in_the_middle_is_found(skipped: int, factor: float) -> None:
    model = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness).frequencies(7)
    rng = np.random.default_rng(3)
    test = factor * np.delete(model, skipped)[:5] * np.exp(0.002 * rng.standard_normal(5))
    assert missing_mode(test, model) == skipped
    whole = factor * model[:5] * np.exp(0.01 * rng.standard_normal(5))
    assert missing_mode(whole, model) is None


def bare(frequency: np.ndarray) -> Measured:
    start = blank(POINTS[:0], shapes_only=True)
    n = len(frequency)
    return replace(
        start,
        frequency=frequency,
        frequency_sigma=1e-4 * frequency,
        damping=np.full(n, 0.01),
        damping_sigma=np.full(n, 0.001),
        constants=np.zeros((0, n)),
        constants_sigma=np.zeros((0, n)),
    )


def test_few_and_missing_modes_are_said() -> None:
    model = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness).frequencies(7)
    assert "only 2 modes" in on_modes(bare(model[:2]), model)[0]
    assert on_modes(bare(model[:5]), model) == []
    (message,) = on_modes(bare(np.delete(model, 2)[:5]), model)
    assert hertz(model[2]) in message
    assert on_modes(bare(np.delete(model, 2)[:5]), model, np.array([0, 1, 3, 4, 5])) == [], (
        "paired so already"
    )
    assert on_modes(evaluate(BEAM).measured, model)[0].startswith("only 2 modes"), "shapes pair the modes"


@pytest.mark.parametrize(("slope", "stated"), [(0.0, False), (-3e-6, False), (-3e-5, True)])
def test_a_level_dependence_is_stated_where_it_is_no_chance(slope: float, stated: bool) -> None:
    model = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness).frequencies(5)
    test = replace(bare(model), slope=np.full(5, slope), slope_sigma=np.full(5, 3e-6), level=100.0)
    message = on_levels(test, fluid=True)
    assert bool(message) is stated
    assert all("fluid" in s for s in message)
    assert not any("fluid" in s for s in on_levels(test, fluid=False))
    assert on_levels(bare(model), fluid=True) == []
