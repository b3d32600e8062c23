"""Ridges of the likelihood: where the data determine only a combination of parameters, followed as it bends.

A fully clamped plate feels shear and Poisson's coupling as one sum; of water near a wall density and distance go
together. A parabola through one place of such a ridge lies along its tangent there and misses the rest of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.fit import Peak, maximise
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate
from updating.thresholds import PEAK_BEHIND, RIDGE_FLAT, RIDGE_STEEP, RIDGE_STEP, RIDGE_STEPS, STEPS_TRIED


def along_ridge(problem: DiagnosisProblem, candidate: Candidate, peak: Peak) -> list[Peak]:
    """Return places of the ridge that leads on from a maximum, with the curvature there; none where there is no ridge.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    candidate : Candidate
        Effects.
    peak : Peak
        The maximum.
    """
    values, vectors = np.linalg.eigh(peak.normal)
    if len(values) < 2 or values[0] > RIDGE_FLAT or values[-1] < RIDGE_STEEP:
        return []
    found = []
    for forward in (vectors[:, 0], -vectors[:, 0]):
        here, direction = peak, forward
        for _ in range(RIDGE_STEPS):
            step = _inside(here.point.coordinates, RIDGE_STEP * direction)
            if np.abs(step).max() < 0.25 * RIDGE_STEP:
                break
            here = _back_on_top(problem, candidate, here.point.coordinates + step, direction)
            behind = peak.point.marginal.log_likelihood - here.point.marginal.log_likelihood
            if not behind < PEAK_BEHIND:
                break
            tangent = np.linalg.eigh(here.normal)[1][:, 0]
            direction = tangent if tangent @ direction > 0 else -tangent
            found.append(_as_short_as_a_step(here, direction))
    return found


def _as_short_as_a_step(peak: Peak, tangent: FloatArray) -> Peak:
    """Return a place of a ridge that reaches to the next one and no further, as its tangent does not bend."""
    return replace(peak, normal=peak.normal + np.outer(tangent, tangent) / RIDGE_STEP**2)


def _inside(place: FloatArray, step: FloatArray) -> FloatArray:
    """Return a step cut short where it leaves the range of a parameter."""
    room = np.where(step > 0, 1.0 - place, place)
    share = np.min(np.where(step != 0, room / np.maximum(np.abs(step), 1e-300), np.inf))
    return np.asarray(min(1.0, float(share)) * step)


def _back_on_top(
    problem: DiagnosisProblem, candidate: Candidate, place: FloatArray, direction: FloatArray
) -> Peak:
    """Return the top of the ridge beside a place, some of Newton's steps across it, and the curvature there."""
    across = np.linalg.svd(direction[None, :])[2][1:].T
    here, share = maximise(problem, candidate, place, rounds=0), 1.0
    for _ in range(2 * STEPS_TRIED):
        if not here.point.possible:
            break
        normal = across.T @ here.normal @ across
        step = across @ np.linalg.solve(normal + np.eye(len(normal)), across.T @ here.gradient)
        step *= share * min(1.0, RIDGE_STEP / max(np.abs(step).max(), 1e-300))
        there = np.clip(here.point.coordinates + step, 0.0, 1.0)
        top = evaluate(problem, candidate, there, about=here.point.about)
        gain = top.marginal.log_likelihood - here.point.marginal.log_likelihood
        if gain > 1.0:
            here, share = maximise(problem, candidate, top, rounds=0), 1.0
        elif gain > 0:
            here = replace(here, point=top)
            break
        else:
            share *= 0.5
    return replace(here, gradient=np.zeros(len(place)))
