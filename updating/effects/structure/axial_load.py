"""A tension or a thrust along the structure."""

from __future__ import annotations

import numpy as np
from scipy import linalg, sparse

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.base import Structure
from updating.models.fields import Sparse
from updating.models.spec import Spec
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.prediction.predict import Predictor

NEAR_BUCKLING = 0.95
"""Largest thrust, of the load that buckles the model [-]: it leaves 5 % of the lowest mode's stiffness, and less would
be less than tolerances of the stiffness are."""


MOST_TENSION = 5.0
"""Largest tension, of the load that buckles the model [-]: it raises the lowest frequency 2.2 to 2.4 times. Judged.
Doubled: every force loses ln 1.8 in all odds."""


class AxialLoad(Effect):
    """A force along the structure that keeps its direction: heat between two clamps, a cable, a dead weight.

    Its potential energy is N/2 the integral of w'^2 (Timoshenko and Gere, Theory of Elastic Stability, 1961). On
    plates the force is spread evenly over the edge and acts along x, or along y where y edges alone are clamped.
    """

    name = "axial_load"
    channel = "stiffness"
    summary = "A tension or thrust along the structure stiffens or softens it in bending."
    footprint = (
        "Frequencies rise with tension, the lowest most: by force over bending stiffness at the wavelength."
    )
    equivalent_to = ("ground_spring",)
    separated_by = "loosen one end and retighten it, or repeat the test at another temperature"
    phrase = "an axial load"
    fidelity = 0.02

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the force."""
        critical = buckling_load(predictor)
        why = (
            f"from {NEAR_BUCKLING} of the load that buckles the model, {critical:.3g} N, to {MOST_TENSION:g} times it "
            "in tension"
        )
        return (
            Parameter(
                "force", "N", -NEAR_BUCKLING * critical, MOST_TENSION * critical, why, natural=("low",)
            ),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a support to push against."""
        if predictor.spec.clamped:
            return None
        return Obstacle(Lack.MODEL, "a free structure has no support that could take an axial force")

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a thrust, and from a small and a large tension."""
        return ((0.08,), (0.2,), (0.5,))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure under the force."""
        along = "width" if _along_y(predictor.spec) else "length"
        # slopes along the force fall with that length; across it the area grows, and the force is spread over as much
        longer = predictor.base.factors.get(along, 1.0)
        return State(stiffness=(values["force"] / longer * unit_tension(predictor),))


def _along_y(spec: Spec) -> bool:
    """Return whether the force acts along y: on plates that y edges alone clamp."""
    return bool(spec.clamped) and all(edge[0] == "y" for edge in spec.clamped)


def buckling_load(predictor: Predictor) -> float:
    """Return the thrust that makes the clamped model buckle [N]."""
    return float(predictor.once("buckling", lambda: np.array(_buckling(predictor))))


def _buckling(predictor: Predictor) -> float:
    reduced = predictor.reduced.small
    n = reduced.ranks[frozenset()]
    stiffness = np.zeros((n, n))
    for term, whole in zip(reduced.structure.terms, reduced.sums, strict=True):
        if term.kind == "stiffness":
            stiffness += whole[:n, :n]
    return 1 / float(
        linalg.eigh(reduced.project(tension(reduced.structure))[:n, :n], stiffness, eigvals_only=True)[-1]
    )


def unit_tension(predictor: Predictor) -> FloatArray:
    """Return the stiffness of a tension of 1 N, (r, r) [1/m in w]."""
    reduced = predictor.reduced

    def build() -> FloatArray:
        return reduced.project(tension(reduced.structure))

    return predictor.once("tension", build)


def tension(structure: Structure) -> Sparse:
    """Return the stiffness of the full model under a tension of 1 N [1/m in w]."""
    assert isinstance(structure, FieldStructure)
    spec, fields = structure.spec, structure.fields
    along_y = _along_y(spec)
    rows = fields.sampled["wy" if along_y else "wx"]
    spread = 1.0 if spec.kind == "beam" else (spec.length if along_y else spec.width)
    return Sparse(rows.T @ sparse.diags_array(fields.weights / spread) @ rows)
