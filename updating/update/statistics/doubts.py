"""What not to trust in an update: nothing left to test it by, pairs that are none, mirrored places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from updating.effects.box import mirror_images
from updating.prediction.assignment import mac_of_constants
from updating.update.data.nominal import Evaluation
from updating.update.data.specimen import Specimen
from updating.update.data.system import System
from updating.update.solve import Solution
from updating.update.statistics.leverage import leverage

LEFT = 0.05
"""Share of the data that parameters must leave free for these to test a model [-]. Doubled: a tolerance a third of what
data would leave in doubt is none."""

POOR_MAC = 0.9
"""MAC of a pair after an update under which it may be no pair, or something that no parameter turns is wrong. With the
distance from 1 doubled, a body in the wrong place goes unseen [-]."""


def doubts(system: System, solution: Solution, dof: int) -> Iterator[str]:
    """State what the numbers of an update do not show.

    Parameters
    ----------
    system : System
        What was solved.
    solution : Solution
        The parameters, and the specimens with them.
    dof : int
        Data less parameters that no tolerance holds [-].
    """
    if dof <= 0 or _taken_up(system, solution):
        yield untested(system.count, len(system.model_parameters))
    for specimen, evaluation, index in zip(system.specimens, solution.evaluations, system.index, strict=True):
        yield from _poor_pairs(specimen, evaluation)
        if not system.shapes:
            model_parameters = specimen.parameter_set.model_parameters
            at = [k.value(float(t)) for k, t in zip(model_parameters, solution.theta[index], strict=True)]
            yield from _mirrored(specimen, at)


def _taken_up(system: System, solution: Solution) -> bool:
    """Return whether parameters as many as data, held by wide tolerances at most, take all of these up."""
    if len(system.model_parameters) < system.count:
        return False
    linear = system.linear(solution.theta, solution.evaluations)
    return bool(system.count - leverage(system, linear).sum() < LEFT * system.count)


def untested(data: int, parameters: int) -> str:
    """Return what to say where no degree of freedom is left."""
    return (
        f"the fit is not tested: {data} data and {parameters} parameters leave no degree of freedom, so a "
        "wrong model would fit as well; name fewer parameters, or give more modes, or shapes as data"
    )


def _poor_pairs(specimen: Specimen, evaluation: Evaluation) -> Iterator[str]:
    """Name the pairs whose shapes do not agree, by the channels by which modes were paired."""
    test = specimen.measured
    if not test.has_shapes:
        return
    mac = np.diag(mac_of_constants(test, evaluation.prediction, test.trusted))
    poor = np.flatnonzero(mac < POOR_MAC)
    if len(poor):
        named = ", ".join(f"{specimen.number[i]} (MAC {mac[i]:.2f})" for i in poor[:6].tolist())
        yield (
            f"{specimen.title}: the updated model's shape is not that of test mode "
            f"{named}{', ...' * (len(poor) > 6)}: the pairing may be wrong, or the model has an error that "
            "none of the parameters describes; `diagnose` the study"
        )


def _mirrored(specimen: Specimen, values: list[float]) -> Iterator[str]:
    """Name places that have a mirror image which frequencies do not separate from them, known masses left aside."""
    spec = replace(specimen.predictor.spec, masses=())
    found: dict[str, dict[str, float]] = {}
    for model_parameter, value in zip(specimen.parameter_set.model_parameters, values, strict=True):
        if model_parameter.effect and model_parameter.parameter in ("x", "y"):
            found.setdefault(model_parameter.effect, {})[model_parameter.parameter] = value
    for effect, at in found.items():
        here = (at.get("x", 0.0), at.get("y", 0.0), 0.0)
        for x, y, _ in mirror_images(spec, here)[1:]:
            where = {"x": x, "y": y}
            image = ", ".join(f"{axis} = {where[axis]:.4g} m" for axis in at)
            yield (
                f"{effect}: the structure is symmetric end to end, so frequencies hardly separate its "
                f"place from the mirror image at {image}; compare shapes, or give the place"
            )
