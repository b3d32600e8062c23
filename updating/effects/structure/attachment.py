"""The flexibility of the place at which something sits, as far as the reduced basis leaves it out.

A basis of modes is too stiff where a force acts that none of its static answers includes (residual flexibility:
MacNeal, Computers & Structures 1, 581, 1971): what sits there seems to move more modes than it does. With F the
flexibility at the place on all degrees of freedom, and F_r on the basis, a spring k acts there with k / (1 + k (F -
F_r)), and a body hangs on a spring of 1 / (F - F_r).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.absorbers import Absorber
from updating.models.fields import Sparse
from updating.models.imported_structure import ImportedStructure
from updating.models.reduced import Reduced
from updating.models.state import NOMINAL, Loss, State
from updating.prediction.predict import Predictor

YIELDS = 1e-3
"""From here on a place gives way under a body: its flexibility times m omega^2 of the highest measured mode [-], by
which the body's share in that mode grows. Ten times it would leave frequencies off by some tenth of a per cent where a
body shifts them by a tenth; doubled, a body on a stiff place costs a degree of freedom less."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """A place, along directions in which forces there move nothing but what they push.

    Parameters
    ----------
    rows : (k, r) array
        Displacement along each direction in the coordinates of the basis [kg^-1/2].
    flexibility : (k,) array
        What the basis leaves out along each [m/N].
    """

    rows: FloatArray
    flexibility: FloatArray


def attachment_of(predictor: Predictor, key: Hashable, motions: Callable[[], Sparse]) -> Attachment:
    """Return a place of a model given by its matrices as an attachment, computed the first time it is asked for.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    key : hashable
        Names the place and the directions.
    motions : callable
        Returns the displacements there, (k, n_dofs), one row for each direction.
    """
    reduced = predictor.reduced
    if ("attachment", key) not in reduced.kept:
        reduced.kept["attachment", key] = _build(reduced, motions())
    found: Attachment = reduced.kept["attachment", key]
    return found


def _build(reduced: Reduced, motions: Sparse) -> Attachment:
    """Return the attachment of displacements (k, n_dofs)."""
    structure, rows = reduced.structure, reduced.generalised(Sparse(motions.T)).T
    assert isinstance(structure, ImportedStructure)
    if reduced.whole or reduced.basis.shape[1] >= structure.unknowns:
        return Attachment(rows, np.zeros(motions.shape[0]))
    left_out = structure.left_out(motions, reduced.basis, reduced.matrices(NOMINAL)[0])
    flexibility, along = np.linalg.eigh((left_out + left_out.T) / 2)
    return Attachment(along.T @ rows, np.maximum(flexibility, 0.0))


def with_body(predictor: Predictor, attachment: Attachment, mass: float) -> State:
    """Return the state with a body [kg] that moves along all directions of an attachment."""
    top = (2 * np.pi * float(np.max(predictor.measured.frequency))) ** 2
    yields = mass * top * attachment.flexibility > YIELDS
    stiff = attachment.rows[~yields]
    hung = zip(attachment.rows[yields], attachment.flexibility[yields], strict=True)
    return State(
        mass=(mass * (stiff.T @ stiff),),
        absorbers=tuple(
            Absorber(row, mass, 1 / flexibility, 0.0, attached=True) for row, flexibility in hung
        ),
    )


def with_spring(attachment: Attachment, stiffness: float, damping: float = 0.0) -> State:
    """Return the state with springs [N/m] and dashpots [N s/m] to the ground along all directions of an attachment.

    The spring takes part of the place's motion from the dashpot beside it: to first order in the damping c there acts
    c / (1 + k (F - F_r))^2.
    """
    rows, held = attachment.rows, 1 + stiffness * attachment.flexibility

    return State(
        stiffness=(rows.T @ ((stiffness / held)[:, None] * rows),) if stiffness else (),
        losses=(Loss(rows.T @ ((damping / held**2)[:, None] * rows)),) if damping else (),
    )
