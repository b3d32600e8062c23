"""What sits at a node of imported matrices, on a small basis, beside the same on all degrees of freedom."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import imported_beam, seen_from, spec_of
from scipy.linalg import eigh

from acquisition.errors import StudyError
from updating import LIBRARY, Predictor, Spec
from updating.effects.structure.attachment import Attachment, attachment_of, with_body, with_spring
from updating.models import Damping
from updating.models.build import build_structure
from updating.models.fields import Sparse
from updating.models.reduction import reduce_structure
from updating.models.state import State
from updating.simulation.model import simulated

ELEMENTS, NODE, MODES = 60, 39, 5
HEAVY, STIFF = 0.2, 3e4
"""A third of the beam's mass [kg], and a spring that holds it like a stop [N/m]."""


def specimen(*, clamped: bool, elements: int = ELEMENTS, modes: int = MODES) -> Predictor:
    """Return the beam on its lowest modes and what its end answers; nothing sits at the end."""
    spec: Spec = spec_of(imported_beam(elements, clamped=clamped))
    end, along = np.array([[0.5, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    basis = reduce_structure(build_structure(spec), end, along, modes=modes)
    assert basis.basis.shape[1] < modes + 15
    return Predictor(spec, seen_from(end, along, np.array([20.0, 130.0, 370.0])), basis=basis)


def solved(predictor: Predictor, *, mass: float = 0.0, stiffness: float = 0.0) -> np.ndarray:
    """Return the lowest elastic frequencies of the beam with something at the node, on all its rows [Hz]."""
    imported = predictor.spec.imported
    assert imported is not None
    row = imported.places.moves[2][[NODE]]
    unit = (row.T @ row).toarray()
    k, m = imported.stiffness.toarray() + stiffness * unit, imported.mass.toarray() + mass * unit
    values = eigh(k, m, eigvals_only=True)[predictor.reduced.structure.rigid_modes :][:3]
    return np.sqrt(values) / (2 * np.pi)


def attachment(predictor: Predictor) -> Attachment:
    imported = predictor.spec.imported
    assert imported is not None
    return attachment_of(predictor, "node", lambda: Sparse(imported.places.moves[2][[NODE]]))


@pytest.mark.parametrize("clamped", [True, False])
def test_a_body_and_a_spring_move_frequencies_as_on_all_degrees_of_freedom(clamped: bool) -> None:
    """The basis alone, which knows no answer to a force there, is off at least twenty times as far."""
    predictor = specimen(clamped=clamped)
    here = attachment(predictor)
    bare = Attachment(here.rows, np.zeros_like(here.flexibility))
    for exact, right, stiff in (
        (solved(predictor, mass=HEAVY), with_body(predictor, here, HEAVY), with_body(predictor, bare, HEAVY)),
        (solved(predictor, stiffness=STIFF), with_spring(here, STIFF), with_spring(bare, STIFF)),
    ):
        off, before = (
            np.abs(predictor.predict(state, count=3).frequency / exact - 1) for state in (right, stiff)
        )
        assert off.max() < 5e-4
        assert before.max() > 20 * off.max()


def test_a_place_whose_answer_the_basis_knows_yields_no_further() -> None:
    predictor = specimen(clamped=True)
    imported = predictor.spec.imported
    assert imported is not None
    there = attachment_of(predictor, "end", lambda: Sparse(imported.places.moves[2][[ELEMENTS]]))
    inside = attachment(predictor)
    assert there.flexibility[0] < 1e-4 * inside.flexibility[0]


def test_the_effects_sit_on_it() -> None:
    """A mass by name of the effect is the mass in the matrices, a body's own turning left out."""
    predictor = specimen(clamped=True)
    at = {"x": 0.5 * NODE / ELEMENTS, "y": 0.0, "z": 0.0}
    body = LIBRARY["lumped_mass"].state(predictor, {**at, "mass": HEAVY, "bulk": 0.0})
    held = LIBRARY["ground_spring"].state(predictor, {**at, "along": "z", "stiffness": STIFF})
    for state, exact in (
        (body, solved(predictor, mass=HEAVY)),
        (held, solved(predictor, stiffness=STIFF)),
    ):
        assert predictor.predict(state, count=3).frequency == pytest.approx(exact, rel=5e-4)


def test_an_attached_body_belongs_to_the_structure_and_adds_no_mode() -> None:
    predictor = specimen(clamped=True)
    state = with_body(predictor, attachment(predictor), HEAVY)
    assert len(state.absorbers) == 1
    plain, loaded = predictor.predict(count=MODES), predictor.predict(state, count=MODES)
    assert (loaded.frequency < plain.frequency * (1 + 1e-9)).all()


def test_what_the_basis_leaves_out_of_a_free_structure_is_no_rounding() -> None:
    """It is what the elastic modes of all rows yield beyond those of the basis; the rigid body on the shift yields more
    by orders of magnitude."""
    predictor = specimen(clamped=False, modes=40)
    imported = predictor.spec.imported
    assert imported is not None
    row = imported.places.moves[2][[NODE]]
    every = eigh(imported.stiffness.toarray(), imported.mass.toarray())
    kept = predictor.reduced.eigen(predictor.base)
    yields, known = (
        np.sum((r @ vectors)[0, 2:] ** 2 / values[2:])
        for r, (values, vectors) in ((row, every), (row @ predictor.reduced.basis, kept))
    )
    here = attachment_of(predictor, "there", lambda: Sparse(row))
    assert here.flexibility[0] == pytest.approx(yields - known, rel=0.01)


def test_a_spring_takes_motion_from_the_dashpot_beside_it() -> None:
    """Decay of the modes on all rows, c (row phi)^2 / 2."""
    predictor, dashpot = specimen(clamped=True), 0.5
    state = with_spring(attachment(predictor), 10 * STIFF, dashpot)
    imported = predictor.spec.imported
    assert imported is not None
    row = imported.places.moves[2][[NODE]]
    k = imported.stiffness.toarray() + 10 * STIFF * (row.T @ row).toarray()
    _, exact = eigh(k, imported.mass.toarray(), subset_by_index=(0, 2))
    _, modes = predictor.reduced.eigen(state)
    found = np.sum(modes * (state.losses[0].matrix @ modes), axis=0)[:3]
    assert found == pytest.approx(dashpot * (row @ exact)[0] ** 2, rel=0.02)


@pytest.mark.parametrize("damping", [Damping(alpha=5.0), Damping(beta=1e-5), Damping(loss_factor=0.02)])
def test_the_flexibility_under_a_body_is_damped_as_the_structure(damping: Damping) -> None:
    plain = specimen(clamped=True)
    predictor = replace(plain, spec=replace(plain.spec, damping=damping))
    state = with_body(predictor, attachment(predictor), 4 * HEAVY)
    imported = predictor.spec.imported
    assert imported is not None
    row = imported.places.moves[2][[NODE]]
    k, m = imported.stiffness.toarray(), imported.mass.toarray()
    values, modes = eigh(k, m + 4 * HEAVY * (row.T @ row).toarray(), subset_by_index=(0, 2))
    alpha, beta, loss = (value or 0.0 for value in (damping.alpha, damping.beta, damping.loss_factor))
    omega = np.sqrt(values)
    exact = (alpha * np.sum(modes * (m @ modes), axis=0) / omega + beta * omega + loss) / 2
    assert predictor.predict(state, count=3).damping == pytest.approx(exact, rel=2e-3)
    poles = predictor.complex_modes(state).poles[:3]
    assert -poles.real / np.abs(poles) == pytest.approx(exact, rel=3e-3)


def test_what_hangs_on_another_basis_is_refused() -> None:
    predictor, other = specimen(clamped=True), specimen(clamped=True, modes=2 * MODES)
    hung = State(absorbers=with_body(other, attachment(other), HEAVY).absorbers)
    with pytest.raises(StudyError, match="other points"):
        simulated(predictor, hung)
