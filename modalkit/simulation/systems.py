"""What the hammer hits: poles and residues between the points of a rig, mounted anew if so wished."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from acquisition import Dof, ModalSystem
from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.simulation.setup import MeasurementSetup
from modalkit.study.read import Study
from updating import Predictor
from updating.models.state import NOMINAL, State
from updating.simulation import Simulated, modal_system
from updating.test_data.chain import measurement_chain

AtHit = Callable[[int, int, float], ModalSystem]
"""Row of the point, hit and peak force [N] to the structure at that hit."""


def systems(model: Simulated, test_setup: MeasurementSetup, state: State = NOMINAL) -> list[ModalSystem]:
    """Return the poles and residues between the points, one system for all points that share their responses.

    Parameters
    ----------
    model : Simulated
        The model; where points were misplaced, seen from all places of
        :func:`updating.test_data.chain.measurement_chain`.
    test_setup : MeasurementSetup
        How it is hit.
    state : State
        What is wrong with the measurement of single points: signs, labels, places; and the delay.
    """
    read = measurement_chain(test_setup.measured, replace(state, gain=1.0))
    rows_of: dict[Dof, dict[Dof, int]] = {}
    for row, (response, reference) in enumerate(
        zip(test_setup.responses, test_setup.references, strict=True)
    ):
        rows_of.setdefault(reference, {})[response] = row
    groups: dict[tuple[Dof, ...], list[Dof]] = {}
    for reference, own in rows_of.items():
        groups.setdefault(tuple(own), []).append(reference)
    found = []
    for responses, references in groups.items():
        rows = np.array([[rows_of[at][seen] for at in references] for seen in responses])
        system = modal_system(
            model,
            seen=read.seen[rows[:, 0]],
            hit=read.hit[rows[0]],
            responses=responses,
            points=references,
            signs=test_setup.signs[rows] * read.gain[rows],
        )
        found.append(_late(system, state.delay))
    return found


def drifting(found: Sequence[ModalSystem], rate: float) -> list[AtHit | None]:
    """Return what each hit meets where frequencies drift as the hammer goes from point to point, None where they stay.

    Parameters
    ----------
    found : sequence of ModalSystem
        As :func:`systems` returns them, in the order in which they are hit.
    rate : float
        Relative change of the frequencies from the first point to the last, about those of the systems [-].

    Raises
    ------
    StudyError
        If fewer than two points are hit.
    """
    if not rate:
        return [None] * len(found)
    counts = [len(system.points) for system in found]
    if sum(counts) < 2:
        raise StudyError(
            "drift has no effect: one point is hit, and all responses to it are measured at once"
        )
    factors = np.split(1.0 + rate * np.linspace(-0.5, 0.5, sum(counts)), np.cumsum(counts)[:-1])
    return [partial(_drifted, system, own) for system, own in zip(found, factors, strict=True)]


def _drifted(system: ModalSystem, factors: FloatArray, point: int, hit: int, level: float) -> ModalSystem:
    return system.with_frequencies(float(factors[point]))


def _late(system: ModalSystem, delay: float) -> ModalSystem:
    """Return a system whose responses lag: each residue holds exp(-s tau) at its pole."""
    if not delay:
        return system
    factor = np.exp(-system.poles * delay)
    gradients = None if system.gradients is None else system.gradients * factor
    return replace(system, residues=system.residues * factor, gradients=gradients)


def remounted(system: ModalSystem, factors: FloatArray) -> ModalSystem:
    """Return a system whose poles are multiplied by factors (n_modes,), its modal constants as they were."""
    gradients = None if system.gradients is None else system.gradients / factors
    return replace(
        system, poles=system.poles * factors, residues=system.residues / factors, gradients=gradients
    )


def known_sensors(study: Study, test_setup: MeasurementSetup) -> list[Callable[[Predictor], State]]:
    """Return the masses that the study takes out of its FRFs again, to be put on the model before.

    Raises
    ------
    StudyError
        If one sits at no point of the test.
    """
    return [_carrying(test_setup, name, mass) for name, mass in study.test.sensor_masses.items()]


def _carrying(test_setup: MeasurementSetup, name: str, mass: float) -> Callable[[Predictor], State]:
    node = Dof.of(name).node
    if node not in test_setup.measured.nodes:
        raise StudyError(f"[test] sensor_masses: {name} is not a point of the test")
    place = test_setup.measured.points[[test_setup.measured.nodes.index(node)]]
    return lambda predictor: State(mass=(mass * predictor.reduced.unit_mass(place),))
