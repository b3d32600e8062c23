"""What other numbers in a deck do to its reduced model: departures made of the matrices of a few runs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.decks.model import DeckModel
from updating.models.decks.parameters import DeckParameter
from updating.models.fields import Sparse
from updating.models.imported.structure import ImportedStructure
from updating.models.reduced import Reduced
from updating.models.state import NOMINAL, State

LOWEST = 12
"""Modes whose static answers to a changed number join the basis: beyond them, what a number does to the modes that a
test sees is smaller than the error that is corrected at the end; twice as many are twice the columns [-]."""


def deck_of(reduced: Reduced) -> DeckModel:
    """Return the deck of a reduced model.

    Raises
    ------
    StudyError
        If it comes from none.
    """
    structure = reduced.structure
    deck = structure.imported.deck if isinstance(structure, ImportedStructure) else None
    if deck is None:
        raise StudyError("only a model of type calculix has numbers of a deck")
    return deck


def deck_state(reduced: Reduced, values: Mapping[DeckParameter, float], beside: State = NOMINAL) -> State:
    """Return the departure that numbers of a deck make.

    On a reduced basis each number is by itself, its matrices a combination of those of a few runs of the deck, exact
    for springs, masses and the thickness of flat shells. Over all degrees of freedom the deck is run with all of them.

    Parameters
    ----------
    reduced : Reduced
        The model.
    values : mapping of DeckParameter to float
        Factors and shifts.
    beside : State
        Factors on modulus and density that act on what the numbers change, too.
    """
    turned = {p: v for p, v in values.items() if v != p.start}
    if not turned:
        return NOMINAL
    deck = deck_of(reduced)
    if reduced.whole:
        return _on_all(reduced, turned, beside)
    stiff, heavy = [], []
    for parameter, value in turned.items():
        k, m = _sampled(reduced, parameter)
        shares = parameter.weights(value)
        factors = _factors(deck, parameter, beside)
        stiff.append(factors[0] * np.tensordot(shares, k, axes=1))
        heavy.append(factors[1] * np.tensordot(shares, m, axes=1))
    return State(stiffness=tuple(stiff), mass=tuple(heavy))


def _on_all(reduced: Reduced, turned: Mapping[DeckParameter, float], beside: State) -> State:
    """Run the deck with all numbers whose elements have the same factors on modulus and density at once."""
    deck = deck_of(reduced)
    together: dict[tuple[float, float], dict[DeckParameter, float]] = {}
    for parameter, value in turned.items():
        together.setdefault(_factors(deck, parameter, beside), {})[parameter] = value
    stiff, heavy = [], []
    for (modulus, density), values in together.items():
        stiffness, mass = deck.change(values)
        stiff.append(reduced.project(Sparse(modulus * stiffness)))
        heavy.append(reduced.project(Sparse(density * mass)))
    return State(stiffness=tuple(stiff), mass=tuple(heavy))


def deck_answers(reduced: Reduced, parameter: DeckParameter) -> FloatArray:
    """Return static answers (n_dofs, n) to a number of the deck at the ends of its samples, in the lowest modes.

    The forces that appear are dK phi - lambda dM phi; what they move is what the modes become to first order.
    """
    deck, structure = deck_of(reduced), reduced.structure
    values, vectors = structure.eigen(structure.rigid_modes + LOWEST)
    first = structure.rigid_modes
    low, lam = vectors[:, first:], values[first:]
    loads = []
    for value in (parameter.samples[0], parameter.samples[-1]):
        if value == parameter.start:
            continue
        stiffness, mass = deck.change({parameter: value})
        loads.append(stiffness @ low - (mass @ low) * lam)
    answers = structure.solve(np.hstack(loads), 0.0)
    size = np.sqrt(np.einsum("ij,ij->j", answers, structure.matrix("mass") @ answers))
    return np.asarray(answers[:, size > 0] / size[size > 0])


def _sampled(reduced: Reduced, parameter: DeckParameter) -> tuple[FloatArray, FloatArray]:
    """Return the changes of stiffness and mass at the samples on the basis, each (n, r, r), kept for the next call."""
    key = ("deck", parameter.name)
    if key not in reduced.kept:
        deck = deck_of(reduced)
        r = reduced.basis.shape[1]
        found = []
        for value in parameter.samples:
            if value == parameter.start:
                found.append((np.zeros((r, r)), np.zeros((r, r))))
                continue
            stiffness, mass = deck.change({parameter: value})
            found.append((reduced.project(stiffness), reduced.project(mass)))
        reduced.kept[key] = tuple(np.stack(matrices) for matrices in zip(*found, strict=True))
    stiff, heavy = reduced.kept[key]
    return stiff, heavy


def _factors(deck: DeckModel, parameter: DeckParameter, beside: State) -> tuple[float, float]:
    """Return the factors on modulus and density of what a number changes [-]."""
    if parameter.kind in ("stiffness", "mass"):
        return 1.0, 1.0
    region = deck.region_of(parameter)
    of = [
        beside.factors.get(name, 1.0) * (1.0 if region is None else beside.regional.get((region, name), 1.0))
        for name in ("E", "density")
    ]
    return of[0], of[1]
