"""Damping of the whole and of layers beside closed forms and the complex eigenproblem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import LOOK
from imported_cases import DEPTH as THICKNESS
from imported_cases import LENGTH, WIDTH, beam_matrices, clamp
from scipy import linalg
from updating_cases import BEAM, blank

from acquisition.errors import StudyError
from updating import LIBRARY, Material, Predictor, Spec
from updating.models.state import State
from updating.problem.candidate import Candidate


@pytest.mark.parametrize("place", ["beam", "plate", "matrices"])
def test_uniform_damping_has_a_closed_form(place: str) -> None:
    predictor, alpha, beta, eta = LOOK[place], 3.0, 2e-6, 0.004
    state = LIBRARY["uniform_damping"].state(predictor, {"alpha": alpha, "beta": beta, "loss_factor": eta})
    plain, found = predictor.predict(count=4), predictor.predict(state, count=4)
    omega = 2 * np.pi * plain.frequency
    added = alpha / (2 * omega) + beta * omega / 2 + eta / 2
    assert found.damping - plain.damping == pytest.approx(added, rel=1e-6)
    window = LIBRARY["exponential_window"].state(predictor, {"decay": 4.0})
    alone = LIBRARY["uniform_damping"].state(predictor, {"alpha": 8.0, "beta": 0.0, "loss_factor": 0.0})
    both = [predictor.predict(s, count=4).damping for s in (window, alone)]
    # the same decay; a window leaves the frequency of ringing, a damper that without damping
    ringing = omega * np.sqrt(1 - plain.damping**2)
    assert both[0] == pytest.approx(both[1] * omega / np.hypot(both[1] * omega, ringing), rel=1e-9)


@pytest.mark.parametrize("place", ["beam", "plate", "matrices"])
def test_less_damping_than_expected_leaves_the_same_share_of_every_mode(place: str) -> None:
    """Of Rayleigh damping alpha M + beta K a share less of both is that share less of every ratio."""
    predictor, effect = LOOK[place], LIBRARY["uniform_damping"]
    less = Candidate((effect,), chosen=(effect.variants(predictor)[-1],))
    plain = predictor.predict(count=4).damping
    for left in (0.0, 0.3, 0.9):
        found = predictor.predict(less.state(predictor, [left]), count=4).damping
        assert found == pytest.approx(left * plain, rel=1e-6, abs=1e-9)
    ((_, values),) = less.split(predictor, [0.3])
    stated = predictor.spec.damping
    assert values["alpha"] == pytest.approx(-0.7 * (stated.alpha or 0.0), rel=1e-6)
    assert values["beta"] == pytest.approx(-0.7 * (stated.beta or 0.0), rel=1e-6)
    assert "less" in effect.sentence(values)
    named = {"alpha", "beta"} - {name.split(".")[1] for name, _ in less.parameters(predictor)}
    assert set(effect.derived(predictor, values)) == {n for n in named if values[n]}
    with pytest.raises(StudyError, match="removes more than the expected damping"):
        effect.state(predictor, {"alpha": 0.0, "beta": 0.0, "loss_factor": -2.5 * float(plain.max())})


def complex_beam(
    first: int, last: int, values: dict[str, float], *, clamped: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and damping ratios of (K + i eta K_patch) by 100 textbook elements, some of them covered."""
    (k, m), (kp, mp) = beam_matrices(100), beam_matrices(100, first, last)
    if clamped:
        k, m, kp, mp = (clamp(a) for a in (k, m, kp, mp))
    kp = (1 + values["stiffness"]) * kp, values["stiffness"] * kp
    stiff = k.toarray() + kp[1].toarray() + 1j * values["loss_factor"] * kp[0].toarray()
    squares = linalg.eig(stiff, m.toarray() + values["mass"] * mp.toarray(), right=False)
    squares = squares[np.argsort(squares.real)][0 if clamped else 2 :][:6]
    return np.sqrt(squares.real) / (2 * np.pi), squares.imag / squares.real / 2


@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize("layer", [(0.0, 0.0), (0.12, 0.05)])
def test_a_patch_beside_the_complex_eigen_solution(*, clamped: bool, layer: tuple[float, float]) -> None:
    """Tape on segments 6 to 8 of ten, as in paper B, and a longer one."""
    edges = ("x0",) if clamped else ()
    spec = Spec(
        "beam",
        length=LENGTH,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(40,),
        clamped=edges,
        theory="euler-bernoulli",
        material=Material(210e9, 7850.0),
    )
    spec = replace(spec, damping=replace(BEAM.damping, alpha=0.0, beta=0.0))
    predictor = Predictor(spec, blank(np.linspace(0.05, 0.5, 6)))
    for first, last in ((50, 80), (20, 55)):
        size = {"x": (first + last) / 200 * LENGTH, "extent": (last - first) / 100 * LENGTH}
        values = {**size, "loss_factor": 0.03, "mass": layer[0], "stiffness": layer[1]}
        found = predictor.predict(LIBRARY["damping_patch"].state(predictor, values), count=6)
        frequency, damping = complex_beam(first, last, values, clamped=clamped)
        assert found.frequency == pytest.approx(frequency, rel=5e-4)
        assert found.damping == pytest.approx(damping, rel=0.015)


@pytest.mark.parametrize("law", [{"alpha": 40.0}, {"beta": 1e-5}])
def test_a_viscous_patch_beside_the_complex_eigen_solution(law: dict[str, float]) -> None:
    """C = alpha M + beta K of the covered part with its layer, by 100 textbook elements."""
    spec = Spec(
        "beam",
        length=LENGTH,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(40,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=Material(210e9, 7850.0),
    )
    spec = replace(spec, damping=replace(BEAM.damping, alpha=0.0, beta=0.0))
    predictor = Predictor(spec, blank(np.linspace(0.05, 0.5, 6)))
    (k, m), (kp, mp) = (
        [clamp(a).toarray() for a in pair] for pair in (beam_matrices(100), beam_matrices(100, 20, 55))
    )
    k, m = k + 0.05 * kp, m + 0.12 * mp
    c = law.get("alpha", 0.0) * 1.12 * mp + law.get("beta", 0.0) * 1.05 * kp
    squares, shapes = linalg.eigh(k, m)
    shapes = shapes[:, :30]  # modes of some kHz more change nothing below
    below = np.hstack([-np.diag(squares[:30]), -shapes.T @ c @ shapes])
    poles = linalg.eigvals(np.vstack([np.hstack([np.zeros((30, 30)), np.eye(30)]), below]))
    poles = sorted(poles[poles.imag > 0], key=lambda p: p.imag)[:5]
    values = {
        "x": 0.375 * LENGTH,
        "extent": 0.35 * LENGTH,
        "loss_factor": 0.0,
        "mass": 0.12,
        "stiffness": 0.05,
    }
    found = predictor.predict(LIBRARY["damping_patch"].state(predictor, values | law), count=5)
    assert found.frequency == pytest.approx(np.abs(poles) / (2 * np.pi), rel=5e-4)
    assert found.damping == pytest.approx(-np.real(poles) / np.abs(poles), rel=0.015)


def test_two_halves_of_a_layer_are_the_whole() -> None:
    predictor, effect = LOOK["plate"], LIBRARY["damping_patch"]
    width = predictor.spec.width
    at = {"x": 0.2, "extent": 0.1, "loss_factor": 0.05, "mass": 0.0, "stiffness": 0.0}

    def damping(*layers: tuple[float, float]) -> np.ndarray:
        state = State()
        for middle, across in layers:
            state = state.plus(
                effect.state(predictor, {**at, "y": middle * width, "extent_y": across * width})
            )
        return predictor.predict(state, count=6).damping

    halves = damping((0.25, 0.5), (0.75, 0.5))
    assert halves == pytest.approx(damping((0.5, 1.0)), rel=0.02)
    assert (damping((0.5, 0.5)) < halves).all()
