"""Hypotheses of a study as effects: compared with the data as any other cause is."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values
from updating.effects.box import Place
from updating.effects.mechanism import Channel
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import on_basis, region_centre
from updating.models.deck_states import deck_state
from updating.models.fields import Sparse
from updating.models.imported.hypothesis import Hypothesis
from updating.models.spec import Spec
from updating.models.state import State
from updating.prediction.predict import Predictor


class Supposed(Effect):
    """What the study states may be so, from not at all to in full, or beyond.

    Parameters
    ----------
    hypothesis : Hypothesis
        As the study states it.
    """

    models = ("matrices",)
    repeats = False
    fidelity = 0.03  # what comes loose does not do so quite as supposed, as other idealisations

    def __init__(self, hypothesis: Hypothesis) -> None:
        """Take name and reasons from the study."""
        self.hypothesis = hypothesis
        self.name = hypothesis.name
        self.phrase = hypothesis.name
        self.channel: Channel = _channel(hypothesis)
        why = f": {hypothesis.why}" if hypothesis.why else ""
        self.summary = f"The hypothesis of the study holds{why}."
        self.footprint = (
            "The change of the model by the study's other matrices, or by the other value of its parameter."
        )
        self.separated_by = "inspect that place, repair it, and repeat the test"

    def _of(self, spec: Spec) -> Hypothesis:
        """Return the hypothesis as the study of a specimen states it."""
        return next(one for one in spec.hypotheses if one.name == self.name)

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return how far it is so, or the value of the parameter."""
        own = self.hypothesis
        if own.of_parameter:
            return (Parameter("value", own.unit, own.low, own.high, "as the study states it", natural=EDGES),)
        why = "as the study states it: 0 is the unchanged model, 1 the full change"
        return (Parameter("amount", "-", own.low, own.high, why, natural=EDGES),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need to be a hypothesis of this very study."""
        if self.name in {one.name for one in predictor.spec.hypotheses}:
            return None
        return Obstacle(Lack.MODEL, "the study of this specimen does not state it")

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a little of it, from much, and from all of it."""
        return ((0.2,), (0.6,), (0.97,))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with so much of the change."""
        own = self._of(predictor.spec)
        if own.of_deck is not None:
            return deck_state(
                predictor.reduced, {own.of_deck: float(values["value"]) / own.nominal}, predictor.base
            )
        if own.factor:
            factor = float(values["value"]) / own.nominal
            return State(factors={own.factor: factor}) if own.region < 0 else State(
                regional={(own.region, own.factor): factor}
            )  # fmt: skip
        amount = float(values["amount"])
        return State(
            stiffness=_part(predictor, f"{own.name}: stiffness", own.stiffness, amount),
            mass=_part(predictor, f"{own.name}: mass", own.mass, amount),
        )

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the middle of what changes, each row with its share of the change."""
        imported = predictor.spec.imported
        assert imported is not None
        own = self._of(predictor.spec)
        if own.factor:
            return () if own.region < 0 else (region_centre(predictor, {"region": float(own.region)}),)
        share = sum(
            np.abs(change.diagonal()) / max(float(np.abs(change.diagonal()).max()), 1e-300)
            for change in own.differences
        )
        weight = share * np.isfinite(imported.row_places).all(axis=1)
        if not weight.sum() > 0:
            return ()
        x, y, z = (np.nan_to_num(imported.row_places).T @ weight / weight.sum()).tolist()
        return ((float(x), float(y), float(z)),)


def _part(predictor: Predictor, name: str, change: Sparse | None, amount: float) -> tuple[FloatArray, ...]:
    """Return so much of a change on the basis, nothing of none."""
    if change is None:
        return ()
    return (amount * on_basis(predictor, ("supposed", name), lambda: change),)


def hypotheses_of(spec: Spec) -> tuple[Effect, ...]:
    """Return the hypotheses of a model as effects."""
    return tuple(Supposed(one) for one in spec.hypotheses)


def _channel(hypothesis: Hypothesis) -> Channel:
    if hypothesis.of_deck is not None:
        return "mass" if hypothesis.of_deck.kind == "mass" else "stiffness"
    if hypothesis.factor:
        return "mass" if hypothesis.factor == "density" else "stiffness"
    return "mass" if hypothesis.stiffness is None else "stiffness"
