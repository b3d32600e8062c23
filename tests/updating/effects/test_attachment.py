"""What sits at a node of imported matrices, on a small basis, beside the same on all degrees of freedom."""

from __future__ import annotations

import numpy as np
import pytest
from imported_cases import imported_beam, seen_from, spec_of
from scipy.linalg import eigh

from updating import LIBRARY, Predictor, Spec
from updating.effects.structure.attachment import Attachment, attachment_of, with_body, with_spring
from updating.models.build import build_structure
from updating.models.fields import Sparse
from updating.models.reduced import reduce_structure

ELEMENTS, NODE, MODES = 60, 39, 5
HEAVY, STIFF = 0.2, 3e4
"""A third of the beam's mass [kg], and a spring that holds it like a stop [N/m]."""


def specimen(*, clamped: bool) -> Predictor:
    """Return the beam on its lowest modes and what its end answers; nothing sits at the end."""
    spec: Spec = spec_of(imported_beam(ELEMENTS, clamped=clamped))
    end, along = np.array([[0.5, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    basis = reduce_structure(build_structure(spec), end, along, modes=MODES)
    assert basis.basis.shape[1] < 20
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


def test_a_body_on_a_seat_is_one_of_the_structure_and_no_mode_of_its_own() -> None:
    predictor = specimen(clamped=True)
    state = with_body(predictor, attachment(predictor), HEAVY)
    assert len(state.absorbers) == 1
    plain, loaded = predictor.predict(count=MODES), predictor.predict(state, count=MODES)
    assert (loaded.frequency < plain.frequency * (1 + 1e-9)).all()
