"""How far a model's frequencies are from those of an endless mesh and a fuller theory, mode by mode."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.base import Structure
from updating.models.build import build_structure
from updating.models.reduced import Reduced
from updating.models.spec import Spec
from updating.models.state import NOMINAL
from updating.prediction.predict import Predictor

MANY_ELEMENTS = 500
"""Plates with more elements are compared with a coarser mesh and extrapolated, which costs less."""

SHEAR_COEFFICIENT = 5 / 6
"""Of plates; Reissner, J. Appl. Mech. 12 (1945) A69 [-]."""


@dataclass(frozen=True, eq=False)
class TheoryError:
    """How far the base model's frequencies are from those of an endless mesh and a fuller theory.

    Parameters
    ----------
    mesh, theory : (n_modes,) arrays
        ln of the better frequency over the model's; theory is 0 where nothing fuller is known [-].
    known : bool
        Whether anything is known; imported matrices cannot be refined.
    """

    mesh: FloatArray
    theory: FloatArray
    known: bool = True

    @property
    def total(self) -> FloatArray:
        """Both together, (n_modes,) [-]."""
        return self.mesh + self.theory


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
        return TheoryError(np.zeros(len(order)), np.zeros(len(order)), known=False)
    base, vectors = _elastic(reduced, needed)
    theory = (
        _beam_theory(predictor, base)
        if predictor.spec.kind == "beam"
        else _plate_theory(reduced, base, vectors)
    )
    return TheoryError(_mesh(predictor.spec, base)[order], theory[order])


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


def _beam_theory(predictor: Predictor, base: FloatArray) -> FloatArray:
    """Return what shear and rotary inertia take from each mode: Timoshenko's beam on the same mesh."""
    fuller = replace(predictor.spec, theory="timoshenko")
    if "timoshenko" in (predictor.spec.theory, predictor.base.theory):
        return np.zeros(len(base))
    return np.asarray(np.log(_frequencies(build_structure(fuller), len(base)) / base))


def _plate_theory(reduced: Reduced, base: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return an estimate of what Mindlin's plate takes from each mode of Kirchhoff's, accurate to half itself.

    Inside, shear and rotary inertia take (k h)^2 / 24 (1 + 2 / (kappa (1 - nu))) from a wave of number k: Mindlin's
    dispersion (J. Appl. Mech. 18 (1951) 31-38) to second order, with k^2 = omega sqrt(rho h / D). Along free edges the
    twisting moment dies out over h / sqrt(12 kappa), to first order in the thickness: a strip twists as if it were
    narrower by 0.63 h (Timoshenko and Goodier, Theory of Elasticity, 1970, article 109).
    """
    spec = reduced.structure.spec
    material, h = spec.material, spec.thickness
    rigidity = material.E * h**3 / (12 * (1 - material.poisson**2))
    wave = base * np.sqrt(material.density * h / rigidity)
    inside = wave * h**2 / 24 * (1 + 2 / (SHEAR_COEFFICIENT * (1 - material.poisson)))
    energy = _edge_energy(reduced, vectors)
    return np.asarray(-inside - h / np.sqrt(12 * SHEAR_COEFFICIENT) * energy / base**2)


def _edge_energy(reduced: Reduced, vectors: FloatArray) -> FloatArray:
    """Return the twisting energy per metre of free edge, summed along the edges, (n_modes,) [J/m per kg m^2]."""
    spec, points = reduced.structure.spec, reduced.fields.points
    (term,) = [
        t for t in reduced.structure.terms if t.kind == "stiffness" and getattr(t, "left", "") == "wxy"
    ]
    twist = reduced.sampled["wxy"][:, : len(vectors)]
    density = getattr(term, "coefficient")[:, None] / 2 * (twist @ vectors) ** 2  # noqa: B009
    total = np.zeros(vectors.shape[1])
    for axis, (size, count) in enumerate(zip((spec.length, spec.width), spec.elements, strict=True)):
        for end in (end for end in "01" if "xy"[axis] + end not in spec.clamped):
            row = np.abs(points[:, axis] - size * int(end)) < size / count
            total += density[row].sum(axis=0) / (size / count)
    return total
