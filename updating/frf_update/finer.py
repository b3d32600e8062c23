"""The reduced model made anew at the current parameters, until it agrees with the full one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import splu

from acquisition.arrays import FloatArray
from updating.frf_update.step import Step, last_steps
from updating.models.columns import extend_basis
from updating.models.reduced import Reduced
from updating.models.reduction import SMALL
from updating.models.state import State, combine
from updating.prediction.predict import Predictor
from updating.update.data.specimen import Specimen

AGREES = 1e-5
"""Relative change of the frequencies and of the FRFs by a new basis under which the old one will do [-]."""


def finer(specimen: Specimen, steps: Sequence[Step]) -> tuple[Specimen, list[Step]] | None:
    """Return specimen and steps on a basis made at the solution, or None where their own agrees with that.

    A basis of the nominal model's modes and static answers is exact there, and within some per mille of the FRFs
    with parameters that are a third off. Modes and static answers of the *updated* full model take their place, and
    the iteration goes on from where it rested.

    Parameters
    ----------
    specimen : Specimen
        The specimen.
    steps : sequence of Step
        Every stage as often as it was gone through; the lines of the last are compared.
    """
    step = steps[-1]
    predictor = specimen.predictor
    state = predictor.base.plus(step.state)
    if predictor.reduced.structure.unknowns <= SMALL or state.released or state.theory is not None:
        return None
    basis = basis_at(predictor.reduced, state, _loads(specimen))
    new = predictor.for_test(specimen.measured).on(basis)
    moved = [_moved(s, new) for s in steps]
    there = replace(combine([s.own for s in last_steps(moved)]), ratios=step.state.ratios)
    laplace = step.stage.frfs.laplace
    old_frfs, new_frfs = predictor.receptance(laplace, step.state), new.receptance(laplace, there)
    if np.abs(new_frfs - old_frfs).max() <= AGREES * np.abs(new_frfs).max():
        return None
    return replace(specimen, model=replace(specimen.model, predictor=new)), moved


def _moved(step: Step, predictor: Predictor) -> Step:
    """Return a step whose effects are matrices on the basis of another predictor."""
    values = step.stage.values(step.solved.theta)
    return replace(step, own=step.stage.parameter_set.state(predictor, values))


def _loads(specimen: Specimen) -> FloatArray:
    structure, test = specimen.predictor.reduced.structure, specimen.measured
    rows = structure.rows(test.points, test.directions)["w"]
    return np.asarray(rows.toarray().T)


def basis_at(reduced: Reduced, state: State, loads: FloatArray) -> Reduced:
    """Build a basis of modes and static answers at a state.

    Parameters
    ----------
    reduced : Reduced
        The model on the basis it had, which determines how many modes to take.
    state : State
        Where; only its factors are used.
    loads : (n_dofs, n) array
        Forces whose static answers join [-].
    """
    structure = reduced.structure
    stiffness, mass = structure.matrices(state)
    first = structure.rigid_modes
    values, modes = structure.eigen(first + MODES, stiffness=stiffness, mass=mass)
    free = structure.free()
    shift = 1e-3 * float(values[first]) if first else 0.0
    factor = splu((stiffness + shift * mass)[free][:, free].tocsc())
    load = np.hstack([loads, structure.softenings(modes[:, first:])])[free]
    answers = np.zeros((structure.n_dofs, load.shape[1]))
    answers[free] = factor.solve(load)
    moves = np.einsum("ij,ij->j", answers, mass @ answers) > 0
    basis = extend_basis(modes, answers[:, moves], mass)
    return Reduced(structure, basis, {frozenset[str](): basis.shape[1]})


MODES = 40
"""Modes of the updated model beside its rigid-body modes."""
