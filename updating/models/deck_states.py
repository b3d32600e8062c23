"""What other numbers in a deck do to its reduced model: departures made of the matrices of a few runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.decks.model import DeckModel
from updating.models.imported.decks.parameters import DeckParameter
from updating.models.imported_structure import ImportedStructure
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
        shares = parameter.weights(value)
        for region, factors in _factors(deck, (parameter,), beside).items():
            k, m = _sampled(reduced, parameter, region)
            stiff.append(factors[0] * np.tensordot(shares, k, axes=1))
            heavy.append(factors[1] * np.tensordot(shares, m, axes=1))
    return State(stiffness=tuple(stiff), mass=tuple(heavy))


def _on_all(reduced: Reduced, turned: Mapping[DeckParameter, float], beside: State) -> State:
    """Run the deck with all springs and masses at once, and with all else that changes elements at once."""
    deck = deck_of(reduced)
    points = {p: v for p, v in turned.items() if p.kind in ("stiffness", "mass")}
    others = {p: v for p, v in turned.items() if p not in points}
    stiff, heavy = [], []
    for values in (points, others):
        for region, (modulus, density) in _factors(deck, tuple(values), beside).items():
            inside = {p: v for p, v in values.items() if region is None or region in deck.regions_of(p)}
            stiffness, mass = deck.change(inside, region)
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
    answers, rigid, whole = (
        structure.solve(np.hstack(loads), 0.0),
        vectors[:, :first],
        structure.matrix("mass"),
    )
    for _ in range(2):  # the answer of a free body is nearly all rigid motion: once leaves its rounding
        answers = answers - rigid @ (rigid.T @ (whole @ answers))
    size = np.sqrt(np.einsum("ij,ij->j", answers, whole @ answers))
    return np.asarray(answers[:, size > 0] / size[size > 0])


def _sampled(reduced: Reduced, parameter: DeckParameter, region: int | None) -> tuple[FloatArray, FloatArray]:
    """Return the changes of stiffness and mass of the deck, or of a region, at the samples on the basis.

    Each is (n, r, r), and kept for the next call.
    """
    key = ("deck", parameter.name, region)
    if key not in reduced.kept:
        deck = deck_of(reduced)
        r = reduced.basis.shape[1]
        found = []
        for value in parameter.samples:
            if value == parameter.start:
                found.append((np.zeros((r, r)), np.zeros((r, r))))
                continue
            stiffness, mass = deck.change({parameter: value}, region)
            found.append((reduced.project(stiffness), reduced.project(mass)))
        reduced.kept[key] = tuple(np.stack(matrices) for matrices in zip(*found, strict=True))
    stiff, heavy = reduced.kept[key]
    return stiff, heavy


def _factors(
    deck: DeckModel, parameters: Sequence[DeckParameter], beside: State
) -> dict[int | None, tuple[float, float]]:
    """Return what to add up of what numbers change: factors on stiffness and mass [-] by region, None of all.

    Where all that changes has the same modulus and density, that is one change of the deck; else the regions that
    differ add their share of it.
    """
    regions = frozenset[int | None]().union(*(deck.regions_of(p) for p in parameters))
    if not regions:
        return {}
    of = {region: _beside(region, beside) for region in regions}
    first = of[None] if None in of else of[min(region for region in of if region is not None)]
    more = {r: (own[0] - first[0], own[1] - first[1]) for r, own in of.items() if own != first}
    return {None: first, **more}


def _beside(region: int | None, beside: State) -> tuple[float, float]:
    """Return the factors on modulus and density of a region [-]; what is in none has neither."""
    if region is None:
        return 1.0, 1.0
    modulus, density = (
        beside.factors.get(name, 1.0) * beside.regional.get((region, name), 1.0) for name in ("E", "density")
    )
    return modulus, density
