"""Damped modes and receptances against textbook formulas, time integration and each other."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg
from updating_cases import blank

from updating import Damping, Material, PointMass, Predictor, Region, Spec
from updating.models.complex_modes import complex_modes
from updating.models.damping import Matrices, damping_matrices, modal_damping
from updating.models.response import receptance
from updating.models.state import Loss, State

STEEL = Material(210e9, 7860.0, 0.3)
POINTS = np.linspace(0.0, 1.0, 11)
HALVES = (
    Region("bare", (0.0, 0.5), alpha=3.0, beta=1e-7),
    Region("taped", (0.5, 0.8), alpha=9.6, beta=6.7e-6, loss_factor=0.004),
    Region("bare", (0.8, 1.0), alpha=3.0, beta=1e-7),
)
BEAM = Spec(
    "beam",
    length=1.0,
    width=0.0315,
    thickness=0.0046,
    elements=(20,),
    clamped=(),
    theory="euler-bernoulli",
    material=STEEL,
    regions=HALVES,
)
LINES = 2j * np.pi * np.linspace(5.0, 500.0, 60) + 2.0


def channel_group(rng: np.random.Generator, n: int) -> Matrices:
    """Return a random chain of masses with dashpots that couple its modes."""
    springs = rng.uniform(1e4, 3e4, n)
    links = np.eye(n) - np.eye(n, k=-1)
    return Matrices(
        links.T @ np.diag(springs) @ links,
        np.diag(rng.uniform(0.5, 2.0, n)),
        links.T @ np.diag(rng.uniform(0.0, 20.0, n)) @ links,
        links.T @ np.diag(springs * rng.uniform(0.0, 0.02, n)) @ links,
    )


def test_one_mass_on_a_spring() -> None:
    one = Matrices(np.array([[4e4]]), np.array([[1.0]]), np.array([[8.0]]), np.zeros((1, 1)))
    modes = complex_modes(one)
    assert modes.poles[0] == pytest.approx(-4.0 + 1j * np.sqrt(4e4 - 16))
    assert (modes.vectors[0, 0] ** 2) == pytest.approx(1 / (2j * np.sqrt(4e4 - 16)))


def test_structural_damping_turns_the_stiffness() -> None:
    one = Matrices(np.array([[4e4]]), np.array([[1.0]]), np.zeros((1, 1)), np.array([[4e4 * 0.02]]))
    assert complex_modes(one).poles[0] == pytest.approx(1j * 200 * np.sqrt(1 + 0.02j))


@pytest.mark.parametrize("seed", range(5))
def test_the_modes_add_up_to_the_receptance(seed: int) -> None:
    system = channel_group(np.random.default_rng(seed), 6)
    viscous = replace(system, structural=np.zeros((6, 6)))
    modes = complex_modes(viscous)
    s = 2j * np.pi * np.linspace(1.0, 60.0, 40) + 0.5
    exact = receptance(viscous, np.eye(6), np.eye(6)[[2] * 6], s)
    upper = (modes.vectors * modes.vectors[2]) @ (1 / (s - modes.poles[:, None]))
    residues = (modes.vectors * modes.vectors[2]).conj()
    lower = residues @ (1 / (s - modes.poles.conj()[:, None]))
    assert upper + lower == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_every_line_solves_its_equation(seed: int) -> None:
    system = channel_group(np.random.default_rng(seed), 5)
    s = np.array([3.0 + 40j, 100j])
    found = receptance(system, np.eye(5), np.eye(5)[[1] * 5], s)
    for line, column in zip(s, found.T, strict=True):
        z = line**2 * system.mass + line * system.viscous + system.stiffness + 1j * system.structural
        assert z @ column == pytest.approx(np.eye(5)[1], abs=1e-9)


def test_proportional_damping_keeps_the_undamped_shapes() -> None:
    predictor = Predictor(replace(BEAM, regions=(), damping=Damping(alpha=5.0, beta=2e-6)), blank(POINTS))
    modes = predictor.complex_modes()
    plain = predictor.predict(count=6)
    assert np.abs(modes.poles[:6]) / (2 * np.pi) == pytest.approx(plain.frequency, rel=1e-9)
    assert -modes.poles.real[:6] / np.abs(modes.poles[:6]) == pytest.approx(plain.damping, rel=1e-6)


def test_damping_by_region_agrees_with_the_complex_modes_to_first_order() -> None:
    predictor = Predictor(BEAM, blank(POINTS))
    modes = predictor.complex_modes()
    ratio = -modes.poles.real[:6] / np.abs(modes.poles[:6])
    assert ratio == pytest.approx(predictor.predict(count=6).damping, rel=5e-3)


def test_a_region_beam_against_matrices_assembled_by_hand() -> None:
    """Paper B's elements by the textbook formulas (Przemieniecki 1968), two to a segment, on all unknowns."""
    n, h = 20, 0.05
    area, inertia = 0.0315 * 0.0046, 0.0315 * 0.0046**3 / 12
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                  [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])  # fmt: skip
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                  [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])  # fmt: skip
    k, m = k * 210e9 * inertia / h**3, m * 7860 * area * h / 420
    total = {name: np.zeros((2 * n + 2, 2 * n + 2)) for name in "kmcd"}
    for element in range(n):
        taped = 10 <= element < 16
        alpha, beta, eta = (9.6, 6.7e-6, 0.004) if taped else (3.0, 1e-7, 0.0)
        place = np.ix_(*[np.arange(2 * element, 2 * element + 4)] * 2)
        for name, matrix in zip("kmcd", (k, m, alpha * m + beta * k, eta * k), strict=True):
            total[name][place] += matrix
    measured = replace(blank(POINTS), seen=np.arange(11), hit=np.full(11, 3))
    found = Predictor(BEAM, measured).receptance(LINES)
    for i, s in enumerate(LINES):
        z = s**2 * total["m"] + s * total["c"] + total["k"] + 1j * total["d"]
        load = np.zeros(2 * n + 2)
        load[2 * 6] = 1.0
        exact = linalg.solve(z, load)[0::4]
        assert found[:, i] == pytest.approx(exact, rel=1e-6)


def test_dampers_of_a_state_take_the_place_of_the_model_s() -> None:
    predictor = Predictor(replace(BEAM, masses=(PointMass((1.0,), 0.01),)), blank(POINTS))
    twice = State(dampers={(1, "alpha"): 19.2})
    base = damping_matrices(predictor.reduced, predictor.spec.damping, State())[0]
    more = damping_matrices(predictor.reduced, predictor.spec.damping, twice)[0]
    regions = tuple(replace(r, alpha=9.6 if r.name == "taped" else 0.0, beta=0.0) for r in HALVES)
    only = Predictor(replace(predictor.spec, regions=regions), blank(POINTS))
    extra = damping_matrices(only.reduced, only.spec.damping, State())[0]
    assert more - base == pytest.approx(extra, abs=1e-9 * np.abs(extra).max())


def test_ratios_by_mode_enter_the_receptance() -> None:
    ratios = (0.013, 0.008, 0.006, 0.005)
    predictor = Predictor(replace(BEAM, regions=(), damping=Damping(ratios=ratios)), blank(POINTS))
    modes = predictor.complex_modes()
    assert -modes.poles.real[:4] / np.abs(modes.poles[:4]) == pytest.approx(ratios, rel=1e-6)


@pytest.mark.parametrize("regions", [(), HALVES], ids=["uniform", "by region"])
def test_modal_damping_is_that_of_the_damping_matrices(regions: tuple[Region, ...]) -> None:
    spec = replace(BEAM, regions=regions, damping=Damping(2.0, 3e-6, loss_factor=0.01))
    reduced = Predictor(spec, blank(POINTS)).reduced
    row = reduced.rows(np.array([[0.3]]))["w"]
    body, spring = row.T @ row, 4e3 * row.T @ row
    added = State(
        mass=(0.2 * body,), stiffness=(spring,), damping=(0.1 * body,), losses=(Loss(2.0 * body), Loss(spring, -1.0))
    )  # fmt: skip
    values, vectors = reduced.eigen(added)
    matrices = damping_matrices(reduced, spec.damping, added)
    found = modal_damping(reduced, spec.damping, added, values[2:12], vectors[:, 2:12])
    for modal, matrix in zip(found, matrices, strict=True):
        assert modal == pytest.approx(np.diag(vectors.T @ matrix @ vectors)[2:12], rel=1e-9)
