"""Clamps that give."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, bending_stiffness
from updating.effects.length import clamped_places
from updating.models.base import Structure
from updating.models.fields import Sparse
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.prediction import Predictor


class ClampRotation(Effect):
    """The clamp turns: a rotational spring in place of a built-in edge."""

    name = "clamp_rotation"
    channel = "stiffness"
    summary = "The clamp turns with the structure instead of holding its slope."
    footprint = "All frequencies fall, the lowest most; shapes tilt about the clamp."
    equivalent_to = ("length", "E")
    separated_by = (
        "points near the clamp, a free-free test of the same specimen, or re-clamping at another torque"
    )
    fidelity = 0.02
    freed = "rotation"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the spring's stiffness."""
        spec = predictor.spec
        scale = bending_stiffness(spec) / spec.length
        unit = "N m/rad" if spec.kind == "beam" else "N m/rad per m"
        why = "from nearly a hinge to 2000 times the structure's own E I / L, where nothing can see it"
        return (Parameter("stiffness", unit, scale, 2000 * scale, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need a clamp."""
        return None if predictor.spec.clamped else "the model has no clamped edge"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure on the spring."""
        spring = values["stiffness"] * predictor.once("edge slopes", lambda: _edge_slopes(predictor))
        return State(stiffness=(spring,), released=frozenset({self.freed}))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the clamped edges."""
        return clamped_places(predictor)


def _edge_slopes(predictor: Predictor) -> FloatArray:
    """Integrate the square of the slope across every clamped edge, as an (r, r) matrix [m in w]."""
    reduced = predictor.reduced
    return np.asarray(reduced.basis.T @ (edge_slopes(reduced.structure) @ reduced.basis))


def edge_slopes(structure: Structure) -> Sparse:
    """Integrate the square of the slope across every clamped edge of the full model [m in w]."""
    assert isinstance(structure, FieldStructure)
    spec, fields = structure.spec, structure.fields
    total = Sparse((fields.n_dofs, fields.n_dofs))
    for edge in spec.clamped:
        name = "wx" if edge[0] == "x" else "wy"
        place = {"x0": 0.0, "x1": spec.length, "y0": 0.0, "y1": spec.width}[edge]
        if spec.kind == "beam":
            slope = "r" if spec.theory == "timoshenko" else "wx"
            rows = fields.components[-1].at(np.array([[place]]), fields.n_dofs)[slope]
            weights = np.ones(1)
        else:
            size = spec.width if edge[0] == "x" else spec.length
            nodes, weights = np.polynomial.legendre.leggauss(40)
            span, weights = (nodes + 1) * size / 2, weights * size / 2
            ends = (np.full(40, place), span) if edge[0] == "x" else (span, np.full(40, place))
            rows = fields.at(np.stack(ends, axis=1))[name]
        total = total + rows.T @ sparse.diags_array(weights) @ rows
    return Sparse(total)
