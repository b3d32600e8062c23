"""Motion under a force: beside an independent integration, and beside the FRFs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg, signal
from simulation_cases import (
    CLAMPED,
    EI,
    FREE,
    LENGTH,
    MIXED,
    MU,
    seen_from,
)

from acquisition import FORMS, Dof, HammerPlan, hammer_test
from updating import Damping, Spec
from updating.models.damping import Matrices
from updating.simulation import (
    Simulated,
    damped_modes,
    modal_system,
    receptances,
    time_response,
)


def force_record(rng: np.random.Generator, count: int, samples: int) -> np.ndarray:
    """Random forces that begin at zero."""
    forces = rng.standard_normal((count, samples))
    forces[:, 0] = 0.0
    return forces


def assembled(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K, M and C of MIXED in n elements by the textbook formulas (Przemieniecki 1968), clamped at x = 0."""
    h = LENGTH / n
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                  [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])  # fmt: skip
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                  [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])  # fmt: skip
    k, m = k * EI / h**3, m * MU * h / 420
    total = np.zeros((3, 2 * n + 2, 2 * n + 2))
    for element in range(n):
        alpha, beta = (3.0, 1e-6) if element < n // 2 else (60.0, 2e-5)
        place = np.ix_(*[np.arange(2 * element, 2 * element + 4)] * 2)
        for whole, part in zip(total, (k, m, alpha * m + beta * k), strict=True):
            whole[place] += part
    k, m, c = total[:, 2:, 2:]
    return k, m, c


def test_motion_is_that_of_an_independent_integration(rng: np.random.Generator) -> None:
    """Matrix exponential of the full state matrix with a first-order hold (Van Loan 1978), no modes involved."""
    model = seen_from(replace(MIXED, elements=(8,)), [0.25, 0.5])
    rate, forces = 5000.0, force_record(rng, 2, 200)
    k, m, c = assembled(8)
    n = len(m)
    rows = np.zeros((2, n))
    rows[0, 6], rows[1, 14] = 1.0, 1.0
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-linalg.solve(m, k), -linalg.solve(m, c)]])
    b = np.vstack([np.zeros((n, 2)), linalg.solve(m, rows.T)])
    van_loan = np.zeros((2 * n + 4, 2 * n + 4))
    van_loan[: 2 * n, : 2 * n], van_loan[: 2 * n, 2 * n : 2 * n + 2] = a / rate, b / rate
    van_loan[2 * n : 2 * n + 2, 2 * n + 2 :] = np.eye(2)
    whole = linalg.expm(van_loan)
    step, now, slope = whole[: 2 * n, : 2 * n], whole[: 2 * n, 2 * n : 2 * n + 2], whole[: 2 * n, 2 * n + 2 :]
    state, states = np.zeros(2 * n), [np.zeros(2 * n)]
    for f, after in zip(forces.T[:-1], forces.T[1:], strict=True):
        state = step @ state + now @ f + slope @ (after - f)
        states.append(state)
    states = np.array(states).T
    moved = [states[:n], states[n:], (a @ states + b @ forces)[n:]]
    both = {"hit": np.array([0, 1]), "seen": np.array([0, 1])}
    for form, expected in zip(FORMS, moved, strict=True):
        found = time_response(model, forces, rate, form=form, **both)
        exact = rows @ expected
        assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()


def test_motion_of_one_mass_is_lsim_s(rng: np.random.Generator) -> None:
    one = Matrices(np.array([[4e4]]), np.array([[1.0]]), np.array([[8.0]]), np.zeros((1, 1)))
    model = Simulated(one, np.eye(1), np.zeros((1, 1, 1)))
    force, rate = force_record(rng, 1, 300), 400.0
    _, expected, _ = signal.lsim(([1.0], [1.0, 8.0, 4e4]), force[0], np.arange(300) / rate)
    found = time_response(model, force, rate, hit=np.array([0]), seen=np.array([0]), form="receptance")
    assert found[0] == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_a_mass_that_creeps_back_does_so() -> None:
    """Overdamped: poles are real, and a constant force ends at its static value."""
    one = Matrices(np.array([[100.0]]), np.array([[1.0]]), np.array([[50.0]]), np.zeros((1, 1)))
    model = Simulated(one, np.eye(1), np.zeros((1, 1, 1)))
    modes = damped_modes(model)
    assert np.sort(modes.poles.real) == pytest.approx(np.roots([1.0, 50.0, 100.0]))
    force = np.ones((1, 4000))
    found = time_response(model, force, 1000.0, hit=np.array([0]), seen=np.array([0]), form="receptance")
    time = np.arange(4000) / 1000
    p, q = np.roots([1.0, 50.0, 100.0])
    expected = 0.01 * (1 + (q * np.exp(p * time) - p * np.exp(q * time)) / (p - q))
    assert found[0] == pytest.approx(expected, abs=1e-12)


def test_fourier_transform_of_the_windowed_impulse_response_is_the_frf_off_the_axis() -> None:
    """H(i omega + sigma) is the transform of h(t) exp(-sigma t)."""
    whole = seen_from(replace(CLAMPED, damping=Damping(alpha=30.0)))
    few = {n: getattr(whole.matrices, n)[:4, :4] for n in ("stiffness", "mass", "viscous", "structural")}
    model = replace(whole, matrices=Matrices(**few), rows=whole.rows[:, :4], slopes=whole.slopes[:, :, :4])
    modes, sigma, rate = damped_modes(model), 12.0, 4e5
    time = np.arange(int(0.7 * rate)) / rate
    residues = (model.rows[0] @ modes.vectors) * (model.rows[1] @ modes.vectors)
    impulse = 2 * (residues @ np.exp(modes.poles[:, None] * time)).real
    windowed = impulse * np.exp(-sigma * time)
    lines = slice(2, 600, 7)
    found = np.fft.rfft(windowed)[lines] / rate
    frequency = np.fft.rfftfreq(len(time), 1 / rate)[lines]
    exact = receptances(model, 2j * np.pi * frequency + sigma, seen=np.array([0]), hit=np.array([1]))
    assert np.abs(found - exact[0]).max() < 1e-4 * np.abs(exact).max()


@pytest.mark.long
@pytest.mark.parametrize("spec", [MIXED, FREE], ids=["by region", "free"])
def test_the_hammer_test_and_the_motion_under_its_force_agree(spec: Spec, rng: np.random.Generator) -> None:
    model = seen_from(spec).hung()
    dofs = [Dof(1, 3), Dof(2, -3)]
    system = modal_system(
        model,
        seen=np.array([1]),
        hit=np.array([0]),
        responses=dofs[1:],
        points=dofs[:1],
        signs=-np.ones((1, 1)),
    )
    plan = HammerPlan(rate=4096.0, samples=1024, hits=1, width=3e-3, adc_bits=None)
    hits = hammer_test(system, plan, rng=rng).points[0]
    fine = 32  # the recorded force is band-limited: between samples it is what its Fourier series says
    force = signal.resample(np.asarray(hits.force), fine * plan.samples, axis=1)
    found = time_response(model, force, fine * plan.rate, hit=np.array([0]), seen=np.array([1]))
    recorded = np.asarray(hits.motion)[0, 0]
    assert np.abs(found[0, ::fine] + recorded).max() < 2e-4 * np.abs(recorded).max()
