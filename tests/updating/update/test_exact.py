"""The full model with every effect, beside the reduced one: parameter by parameter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from effect_cases import CHANGES, LOOK, admitted, bound, form, full_modes

from updating import LIBRARY, Parameter, Predictor
from updating.effects.base import Effect, Values
from updating.models.parts import Region
from updating.models.state import State
from updating.update.parameters.exact import full_modes as exact_modes

CONDENSED = {"fluid_added_mass", "fluid_damping"}
"""Effects whose full matrices are dense, and known on a reduced basis alone."""

COUNT = 5
NO_FULL = CONDENSED | {"shear", "absorber"}

COARSE = {("local_stiffness", "plate")}
"""Effects on models whose own mesh does not resolve them."""
PLACES = ["beam", "timoshenko", "plate", "free", "matrices"]


def undamped(effect: Effect, values: Mapping[str, Any], predictor: Predictor) -> State:
    """The effect without its dampers."""
    return replace(effect.state(predictor, values), losses=())


def exact(effect: Effect, predictor: Predictor, values: Mapping[str, Any]) -> np.ndarray | None:
    found = exact_modes(predictor, lambda on: effect.state(on, values), COUNT)
    return None if found is None else found[0]


def reduced(effect: Effect, predictor: Predictor, values: Mapping[str, Any]) -> np.ndarray:
    return predictor.predict(effect.state(predictor, values), count=COUNT).frequency


@admitted([n for n in LIBRARY if n not in NO_FULL], PLACES)
def test_every_parameter_moves_the_full_model_as_the_reduced_one(name: str, place: str) -> None:
    """The shift of ln f by each parameter alone, to 10 % of the largest; and the frequencies to 0.05 %.

    A reduced basis has no static answer to a place without a test point, and sums up a plate's boxes from cells; a
    parameter that is lost on the way shifts nothing at all.
    """
    effect, predictor = LIBRARY[name], LOOK[place]
    start = form(effect, predictor, 0.35)
    if (name, place) in COARSE:
        assert exact(effect, predictor, start) is None
        return
    before, lower = exact(effect, predictor, start), reduced(effect, predictor, start)
    assert before is not None
    np.testing.assert_allclose(before, lower, rtol=bound(effect, predictor, before))
    for parameter in effect.parameters(predictor):
        values = {**start, parameter.name: parameter.value(0.3 if parameter.name == "from" else 0.6)}
        after, higher = exact(effect, predictor, values), reduced(effect, predictor, values)
        assert after is not None
        one, other = np.log(after / before), np.log(higher / lower)
        np.testing.assert_allclose(one, other, atol=0.1 * np.abs(other).max() + 1e-7)


@admitted(sorted(NO_FULL), PLACES)
def test_what_has_no_full_model_has_none(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    assert exact(effect, predictor, form(effect, predictor, 0.35)) is None


@admitted([n for n in LIBRARY if n in CHANGES], ["beam", "timoshenko", "plate", "free"])
def test_the_full_model_is_the_one_put_together_by_hand(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    stretch = {"from", "to"}  # of clamps, which are put in by hand along whole edges
    start = {key: value for key, value in form(effect, predictor, 0.35).items() if key not in stretch}
    varied = [{**start, p.name: p.value(0.6)} for p in effect.parameters(predictor) if p.name not in stretch]
    if (name, place) in COARSE:
        assert exact(effect, predictor, start) is None
        return
    for values in (start, *varied):
        by_hand = full_modes(name, predictor, values, COUNT)
        # the tails of a place's edges are cut off at 1e-4, which a gain makes more of
        close = 2e-5 if values.get("loss", 0.0) < 0 else 1e-6
        found = exact_modes(predictor, partial(undamped, effect, values), COUNT)
        assert found is not None
        assert found[0] == pytest.approx(by_hand, rel=close)


@pytest.mark.parametrize("place", ["beam", "plate"])
def test_a_bulky_sensor_weighs_as_one_in_the_full_model(place: str) -> None:
    """50 g of bulk 6: the rotary inertia alone is per cents of the higher modes, by matrices put together by hand."""
    effect, predictor = LIBRARY["sensor_mass"], LOOK[place]
    values = {"mass": 0.05, "bulk": 6.0}
    found = exact(effect, predictor, values)
    flat = exact(effect, predictor, values | {"bulk": 0.0})
    assert found is not None and flat is not None
    assert np.abs(found / flat - 1).max() > 0.01
    assert found == pytest.approx(full_modes("sensor_mass", predictor, values, COUNT), rel=1e-6)


@admitted(["lumped_mass", "axial_load", "clamp_rotation", "local_stiffness", "orthotropy"], PLACES)
def test_an_effect_in_the_model_beforehand_acts_on_the_full_one(name: str, place: str) -> None:
    effect, plain = LIBRARY[name], LOOK[place]
    values = form(effect, plain, 0.6, loss=0.85)
    predictor = replace(plain, additions=(lambda on: effect.state(on, values),))
    found = exact_modes(predictor, lambda on: State(factors={"E": 1.1}), COUNT)
    if (name, place) in COARSE:
        assert found is None
        return
    assert found is not None
    np.testing.assert_allclose(
        found[0], predictor.predict(State(factors={"E": 1.1}), count=COUNT).frequency, rtol=5e-4
    )
    assert np.abs(found[0] / plain.predict(State(factors={"E": 1.1}), count=COUNT).frequency - 1).max() > 1e-3


class Dense(Effect):
    """A user's effect, written for dense matrices."""

    name = "dense"
    channel = "mass"
    summary = footprint = separated_by = ""

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        return ()

    def state(self, predictor: Predictor, values: Values) -> State:
        row = np.asarray(predictor.reduced.rows(np.array([[0.2]]))["w"])
        return State(mass=(np.outer(row, row),))


def test_an_effect_written_for_dense_matrices_is_said_to_have_no_exact_form() -> None:
    assert exact(Dense(), LOOK["beam"], {}) is None


def test_regions_and_factors_act_on_the_full_model() -> None:
    predictor = LOOK["beam"]
    spec = replace(predictor.spec, regions=(Region("root", (0.0, 0.1)), Region("rest", (0.1, 0.376))))
    own = Predictor(spec, predictor.measured)
    state = State(regional={(0, "E"): 0.7}, factors={"density": 1.2, "length": 1.01})
    found = exact_modes(own, lambda on: state, COUNT)
    assert found is not None
    np.testing.assert_allclose(found[0], own.predict(state, count=COUNT).frequency, rtol=1e-4)
