"""A place that is softer than modelled: a crack, a notch, a loose rivet row."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values
from updating.models.state import State
from updating.prediction import Predictor

COMPLIANCE = (5e-4, 0.6)
"""Range of the compliance, the integral of EI0/EI - 1, relative to the length [-]."""


class LocalStiffness(Effect):
    """Bending stiffness lost over a short stretch of a beam or a small rectangle of a plate."""

    name = "local_stiffness"
    channel = "stiffness"
    summary = "One place is softer than modelled (crack, notch, loose joint)."
    footprint = "Frequencies fall in the modes that bend there, and hardly in those with no curvature there."
    equivalent_to = ("clamp_rotation",)
    separated_by = "more points around the place, or a visual and dye check there"
    fidelity = 0.05

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extent and loss."""
        spec = predictor.spec
        place = [Parameter("x", "m", 0.0, spec.length, "anywhere along the structure")]
        if spec.kind == "plate":
            place.append(Parameter("y", "m", 0.0, spec.width, "anywhere across the structure"))
        low, high = 0.02 * spec.length, 0.15 * spec.length
        return (
            *place,
            Parameter("extent", "m", low, high, "what is longer is a region, not a place", log=True),
            Parameter("loss", "-", 0.0, 0.98, "from invisible to nearly severed; uniform in log compliance"),
        )

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values: the last one is that of the compliance, which the data determine."""
        values = super().values(predictor, coordinates)
        low, high = (share * predictor.spec.length for share in COMPLIANCE)
        compliance = low * (high / low) ** coordinates[-1]
        return values | {"loss": min(compliance / (compliance + values["extent"]), 0.98)}

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places, with a middling loss."""
        along = (np.arange(8) + 0.5) / 8
        if predictor.spec.kind == "beam":
            return tuple((float(u), 0.5, 0.4) for u in along)
        return tuple((float(u), v, 0.5, 0.4) for u in along[::2] for v in (0.2, 0.8))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with its stiffness reduced there."""
        softening = self._softening(predictor, values)
        return State(stiffness=(-predictor.reduced.weighted("stiffness", softening, predictor.base.factors),))

    def _softening(self, predictor: Predictor, values: Values) -> FloatArray:
        """Return the share of the stiffness lost at every quadrature point [-]: a box with soft edges."""
        points = predictor.reduced.fields.points
        centre = np.array([values[name] for name in ("x", "y")[: points.shape[1]]])
        spacing = np.array([predictor.spec.length, predictor.spec.width])[: points.shape[1]]
        edge = np.maximum(values["extent"] / 8, 0.25 * spacing / np.array(predictor.spec.elements))
        distance = values["extent"] / 2 - np.abs(points - centre)
        share = np.prod(0.5 * (1 + np.tanh(distance / edge)), axis=1)
        return np.where(share > 1e-4, values["loss"] * share, 0.0)

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the place."""
        return ((values["x"], values.get("y", 0.0), 0.0),)

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the compliance, the integral of EI0/EI - 1: what the data determine."""
        lost = self._softening(predictor, values)
        weights = predictor.reduced.fields.weights
        across = 1.0 if predictor.spec.kind == "beam" else values["extent"]
        compliance = float(weights @ (1 / (1 - lost) - 1)) / across
        return {"compliance": (compliance, "m")}
