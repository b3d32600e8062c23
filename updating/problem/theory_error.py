"""How far a model's frequencies are from those of an endless mesh and a fuller theory, mode by mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.base import Structure
from updating.models.build import build_structure
from updating.models.reduced import Reduced
from updating.models.spec import Spec
from updating.models.state import NOMINAL
from updating.models.width import across_width
from updating.prediction.predict import Predictor
from updating.problem.shear import slackening

MANY_ELEMENTS = 500
"""Plates with more elements are compared with a coarser mesh and extrapolated, which costs less."""


@dataclass(frozen=True, eq=False)
class TheoryError:
    """How far the base model's frequencies are from those of an endless mesh and a fuller theory.

    Parameters
    ----------
    mesh, theory : (n_modes,) arrays
        ln of the better frequency over the model's; theory is 0 where nothing fuller is known [-].
    width : (n_modes,) array
        The same by bending across the width of a beam, see :mod:`updating.models.width` [-].
    shear : (n_modes,) array
        The same by a section that is softer in shear than a rectangle, see :mod:`updating.problem.shear` [-].
    known : bool
        Whether anything is known; imported matrices cannot be refined.
    """

    mesh: FloatArray
    theory: FloatArray
    width: FloatArray
    shear: FloatArray
    known: bool = True

    @property
    def total(self) -> FloatArray:
        """Mesh and theory together, (n_modes,) [-]."""
        return self.mesh + self.theory


def left_out(found: TheoryError | None, count: int) -> tuple[FloatArray, FloatArray]:
    """Return what mesh and theory leave off in ln f: columns common to all modes, variance mode by mode.

    Nothing where nothing is known of it. Half of the mesh's own error is in doubt mode by mode, beside all of it in
    common (judged).

    Parameters
    ----------
    found : TheoryError, optional
        What is known of mesh and theory.
    count : int
        How many modes there are.

    Returns
    -------
    columns : (n_modes, k) array
        Shifts of ln f by one standard deviation of each cause [-].
    variance : (n_modes,) array
        Of ln f [-].
    """
    if found is None or not found.known:
        return np.zeros((count, 0)), np.zeros(count)
    columns = [found.mesh, *(column for column in (found.width, found.shear) if column.any())]
    return np.stack(columns, axis=1), (0.5 * found.mesh) ** 2


def discrepancy(predictor: Predictor, order: IntArray, *, count: int | None = None) -> FloatArray:
    """Return by how much mesh and theory leave each mode's frequency off, (n_modes,) [-].

    Parameters
    ----------
    predictor : Predictor
        The model; its additions are left aside, but for a fuller theory among them.
    order : (n_modes,) int array
        Rank of each mode among the model's elastic modes.
    count : int, optional
        How many of the model's modes to look at; left out, as many as ``order`` needs.

    Returns
    -------
    (n_modes,) array
        ln(better frequency / model's): what a nuisance has to be able to take up.
    """
    return theory_error(predictor, order, count=count).total


def theory_error(predictor: Predictor, order: IntArray, *, count: int | None = None) -> TheoryError:
    """Return the parts of `discrepancy`; parameters as there."""
    needed = max(count or 0, int(order.max()) + 1)
    reduced = predictor.reduced
    if not reduced.structure.refinable:
        nothing = np.zeros(len(order))
        return TheoryError(nothing, nothing, nothing, nothing, known=False)
    base, vectors = _elastic(reduced, needed)
    mesh, theory = _mesh(predictor.spec, base), _theory(predictor, base, vectors)
    of_section = (
        across_width(predictor.spec, order, np.zeros(0)).stiffening,
        slackening(predictor.spec, order),
    )
    return TheoryError(mesh[order], theory[order], *of_section)


def _elastic(reduced: Reduced, count: int) -> tuple[FloatArray, FloatArray]:
    """Return circular frequencies [rad/s] and shapes of the lowest elastic modes of the bare model."""
    values, vectors = reduced.eigen(NOMINAL)
    first = reduced.structure.rigid_modes
    return np.sqrt(values[first : first + count]), vectors[:, first : first + count]


def _mesh(spec: Spec, base: FloatArray) -> FloatArray:
    """Compare with a mesh twice as fine, or of half as many elements each way where that costs too much.

    Near free corners thin-plate elements converge as the square of their size, elsewhere as the fourth power: the
    extrapolation takes the square, which errs on the side of more doubt.
    """
    if int(np.prod(spec.elements)) > MANY_ELEMENTS and min(spec.elements) > 3:
        elements = tuple((n + 1) // 2 for n in spec.elements)
        ratio = min(n / m for n, m in zip(spec.elements, elements, strict=True))
        try:
            coarse = build_structure(spec.with_elements(*elements))
        except StudyError:  # a region falls between the points of a mesh so coarse
            pass
        else:
            return np.asarray(-np.log(_frequencies(coarse, len(base)) / base) / (ratio**2 - 1))
    finer = build_structure(spec.with_elements(*(2 * n for n in spec.elements)))
    return np.asarray(np.log(_frequencies(finer, len(base)) / base))


def _frequencies(structure: Structure, count: int) -> FloatArray:
    first = structure.rigid_modes
    return np.asarray(np.sqrt(structure.eigen(first + count)[0][first:]))


def _theory(predictor: Predictor, base: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return what shear and rotary inertia take from each mode, (n_modes,) [-].

    Of beams by rank, on the same mesh; of plates, whose modes may change places, by the nearest on the same basis.
    """
    fuller = predictor.spec.fuller
    if fuller is None or fuller == predictor.base.theory:
        return np.zeros(len(base))
    if predictor.spec.kind == "beam":
        better = build_structure(predictor.spec.with_theory(fuller))
        return np.asarray(np.log(_frequencies(better, len(base)) / base))
    values, others = predictor.bare.under(fuller).reduced.eigen(NOMINAL)
    first = predictor.reduced.structure.rigid_modes
    partner = first + np.argmax(np.abs(vectors.T @ others[:, first : first + 2 * len(base) + 5]), axis=1)
    return np.asarray(np.log(np.sqrt(values[partner]) / base))
