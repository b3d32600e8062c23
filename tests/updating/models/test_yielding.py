"""A support of imported matrices that turns, beside the same beam with the spring assembled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import beam_matrices, imported_beam, seen_from, spec_of
from scipy import linalg

from updating import LIBRARY, Tolerances
from updating.models.imported import Imported
from updating.models.imported.groups import rigid_motions
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.update.data.nominal import UpdatedModel
from updating.update.parameters.named import build_parameter_set
from updating.update.parameters.sensitivity import log_frequency_by

SPRING, ELEMENTS, DIVIDED = 300.0, 20, 10
"""Stiffness of the spring [N m/rad], elements of the beam, and those before the middle."""

POINTS = np.array([[0.1, 0.0, 0.0], [0.25, 0.0, 0.0], [0.5, 0.0, 0.0]])
TURN = {"stiffness": SPRING, "direction": "ry"}
MASS_OF_ROW = 3e-4
"""What the mass of the held row, which is not known and estimated from that beside it, may move frequencies [-]."""


def test_the_beam_feels_no_force_when_it_moves_as_a_rigid_body() -> None:
    """Its rows of rotation turn about y as the node table states, so that a support's motion is known from them."""
    known = imported_beam(ELEMENTS, clamped=False)
    rigid = rigid_motions(known.places, known.order)
    assert rigid is not None
    assert np.abs(rigid[:, [2, 4]]).max(axis=0) == pytest.approx([1.0, 1.0])
    forces = np.abs(known.stiffness @ rigid)
    assert forces.max() < 1e-9 * np.abs(known.stiffness.toarray()).max()


def predictor_of(imported: Imported, etas: tuple[float, ...] = ()) -> Predictor:
    """The beam seen from three points; with loss factors of its halves, where these are given."""
    spec = spec_of(imported)
    if etas:
        pairs = zip(spec.regions, etas, strict=True)
        spec = replace(
            spec, regions=tuple(replace(region, loss_factor=eta, beta=1e-6) for region, eta in pairs)
        )
    return Predictor(spec, seen_from(POINTS, np.tile([0.0, 0.0, 1.0], (len(POINTS), 1))))


def turning(predictor: Predictor) -> State:
    (support,) = predictor.spec.imported.supports if predictor.spec.imported else ()
    return LIBRARY["clamp_rotation"].state(predictor, {**TURN, "support": support.name})


def assembled(*factors: float) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """K with the first rotation on the spring, M, and the stiffness of the halves, under factors on these."""
    ends = ((0, DIVIDED), (DIVIDED, ELEMENTS))
    halves = [
        f * beam_matrices(ELEMENTS, *e)[0].toarray()[1:, 1:] for f, e in zip(factors, ends, strict=True)
    ]
    stiffness, mass = sum(halves), beam_matrices(ELEMENTS)[1].toarray()[1:, 1:]
    stiffness[0, 0] += SPRING
    return stiffness, mass, halves


def hertz(*factors: float) -> np.ndarray:
    stiffness, mass, _ = assembled(*factors)
    return np.sqrt(linalg.eigh(stiffness, mass, eigvals_only=True)[:3]) / (2 * np.pi)


@pytest.mark.parametrize(
    ("state", "factors"),
    [
        (State(), (1.0, 1.0)),
        (State(factors={"E": 1.3}), (1.3, 1.3)),
        (State(regional={(0, "E"): 0.7}), (0.7, 1.0)),
        (State(factors={"E": 1.2}, regional={(1, "E"): 0.6}), (1.2, 0.72)),
    ],
)
def test_another_modulus_leaves_the_spring_as_it_is(state: State, factors: tuple[float, float]) -> None:
    predictor = predictor_of(imported_beam(ELEMENTS, parts=(DIVIDED,)))
    whole = predictor.predict(turning(predictor).plus(state), count=3)
    assert whole.frequency == pytest.approx(hertz(*factors), rel=0.005)
    plain = predictor.predict(turning(predictor), count=3).frequency
    assert whole.frequency / plain == pytest.approx(hertz(*factors) / hertz(1.0, 1.0), rel=MASS_OF_ROW)


@pytest.mark.parametrize(("factor", "regions"), [("E", ()), ("E", (0,)), ("E", (1,)), ("density", ())])
def test_sensitivities_are_slopes_of_the_frequencies(factor: str, regions: tuple[int, ...]) -> None:
    predictor = predictor_of(imported_beam(ELEMENTS, parts=(DIVIDED,)))
    state, step = turning(predictor), 1e-3

    def logs(value: float) -> np.ndarray:
        change = (
            State(regional={(i, factor): value for i in regions})
            if regions
            else State(factors={factor: value})
        )
        return np.log(predictor.predict(state.plus(change), count=3).frequency)

    slopes = (logs(np.exp(step)) - logs(np.exp(-step))) / (2 * step)
    now = predictor.predict(state, count=3)
    assert log_frequency_by(predictor.reduced, state, now, factor, regions) == pytest.approx(slopes, abs=1e-6)
    if not regions:
        tolerances = predictor.predict(state, count=3, factors=(factor,)).log_frequency_by.ravel()
        assert tolerances == pytest.approx(slopes, abs=1e-6)


def test_an_accepted_clamp_gives_way_in_an_update_of_the_modulus() -> None:
    plain = predictor_of(imported_beam(ELEMENTS))
    accepted = plain.for_test(plain.measured, (turning,))
    model = UpdatedModel(accepted, build_parameter_set(["E"], accepted, Tolerances(), {}))
    assert model.affine is None  # the support on its spring is no sum of powers of the modulus
    found = accepted.predict(model.parameter_set.state(accepted, [1.3]), count=3).frequency
    assert found == pytest.approx(hertz(1.3, 1.3), rel=0.005)


@pytest.mark.parametrize("etas", [(0.01, 0.01), (0.0101, 0.01), (0.03, 0.0)])
def test_a_spring_at_a_support_is_not_damped_by_the_structure_s_coefficients(
    etas: tuple[float, float],
) -> None:
    """zeta = sum_i eta_i phi^T K_i phi / (2 lambda), with the halves' matrices assembled."""
    stiffness, mass, halves = assembled(1.0, 1.0)
    values, vectors = linalg.eigh(stiffness, mass)
    energy = np.array([np.sum(vectors * (half @ vectors), axis=0) for half in halves])
    lost = np.array(etas) @ energy + 1e-6 * np.sqrt(values) * energy.sum(axis=0)
    expected = (lost / (2 * values))[:3]
    predictor = predictor_of(imported_beam(ELEMENTS, parts=(DIVIDED,)), etas)
    state = turning(predictor)
    assert predictor.predict(state, count=3).damping == pytest.approx(expected, rel=0.01)
    modes = predictor.complex_modes(state)
    assert (-modes.poles.real / np.abs(modes.poles))[:3] == pytest.approx(expected, rel=0.01)
