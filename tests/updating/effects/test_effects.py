"""One body of tests for every effect of the library."""

import re
from dataclasses import replace

import numpy as np
import pytest
from effect_cases import (
    CHANGES,
    CONTRACT,
    LOOK,
    THIN,
    VANISHING,
    admits,
    admitted,
    bound,
    form,
    full_modes,
    scaled,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank

from acquisition.errors import StudyError
from modalkit.output.library import effects_document
from updating import LIBRARY, Environment, Predictor
from updating.effects import accepted_state
from updating.models import PointMass
from updating.problem.candidate import Candidate

RISES = {"E": 1, "density": -1, "thickness": 1, "length": -1, "clamp_rotation": 1, "sensor_mass": -1}
RISES |= {"clamp_translation": 1, "lumped_mass": -1, "local_stiffness": -1, "axial_load": 1}
RISES |= {"fluid_added_mass": -1, "exponential_window": 1, "calibration_gain": 0, "section_scale": 0}
"""Sign of the change of the first frequency with each effect's first size; 0 is none at all."""
RISES |= {"ground_spring": 1, "local_mass": -1}
SIZE = {"local_stiffness": "loss", "lumped_mass": "mass", "ground_spring": "stiffness"}
SIZE |= {"local_mass": "factor"}
HARMLESS = {"clamp_rotation": 1, "clamp_translation": 1, "sensor_mass": 0, "lumped_mass": 0}
"""Prior quantile at which nothing can be seen; a clamp is rigid at its high end."""
HARMLESS |= {"local_stiffness": 0.5, "local_mass": 0.5, "exponential_window": 0}

every = pytest.mark.parametrize("name", list(LIBRARY))
places = pytest.mark.parametrize("place", list(LOOK))


@every
def test_every_effect_speaks_of_itself(name: str) -> None:
    effect = LIBRARY[name]
    assert effect.name == name
    assert effect.channel in ("stiffness", "mass", "damping", "measurement")
    for text in (effect.summary, effect.footprint, effect.separated_by, type(effect).__doc__ or ""):
        assert len(text) > 20
    assert set(effect.models) <= {"beam", "plate", "matrices"}
    assert 0 <= effect.fidelity < 0.2
    assert 0 <= effect.damping_doubt < 1


@every
def test_what_is_mistaken_for_each_other_says_so_of_each_other(name: str) -> None:
    assert name not in LIBRARY[name].equivalent_to
    for other in LIBRARY[name].equivalent_to:
        assert name in LIBRARY[other].equivalent_to, other


def test_the_contract_is_in_the_library() -> None:
    assert set(CONTRACT) <= set(LIBRARY)


@admitted(CONTRACT, places=["beam", "plate"])
def test_names_and_parameters_are_those_of_the_contract(name: str, place: str) -> None:
    names = {p.name for p in LIBRARY[name].parameters(LOOK[place])} | set(LIBRARY[name].labels)
    assert names <= CONTRACT[name]
    assert names >= CONTRACT[name] - ({"y", "dy", "extent_y", "from", "to"} if place == "beam" else set())


@every
@places
def test_an_obstacle_is_a_reason_or_nothing(name: str, place: str) -> None:
    why = LIBRARY[name].why_not(LOOK[place])
    assert why is None or len(str(why)) > 10
    if LOOK[place].spec.kind not in LIBRARY[name].models:
        assert why is not None


def test_the_contract_is_kept_whole() -> None:
    assert set(LIBRARY) >= set(CONTRACT)


@admitted()
def test_forms_have_shares_and_fix_what_is_known(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    forms = effect.variants(predictor)
    assert 0 < sum(f.weight for f in forms) <= 1 + 1e-9
    known = {p.name for p in effect.parameters(predictor)} | {*effect.labels}
    known |= {"channel"} if effect.of_sensor else set()
    known |= set(effect.named) if predictor.spec.kind == "matrices" else set()
    assert all({*f.values, *f.within} <= known and f.weight > 0 for f in forms)
    assert all(0 <= low < high <= 1 for f in forms for low, high in f.within.values())


@admitted(["local_stiffness", "local_mass", "uniform_damping"], ["beam", "plate", "matrices"])
@settings(max_examples=15)
@given(u=st.floats(0.01, 0.99))
def test_values_go_back_to_the_quantiles_they_came_from(name: str, place: str, u: float) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    count = len(effect.parameters(predictor))
    values = effect.values(predictor, [u] * count)
    assert effect.values(predictor, effect.quantiles(predictor, values)) == pytest.approx(values)
    for chosen in effect.variants(predictor):
        candidate = Candidate((effect,), chosen=(chosen,))
        here = np.full(len(candidate.parameters(predictor)), u)
        assert candidate.starts(predictor)
        stated = candidate.values(predictor, here.tolist())
        assert candidate.coordinates(predictor, stated) == pytest.approx(here, abs=1e-9)


def test_what_cannot_be_examined_is_said() -> None:
    assert not admits("clamp_rotation", "free")
    assert admits("shear", "plate")
    assert not admits("sensor_mass", "no shapes")
    assert not admits("calibration_gain", "no shapes")
    thick, unknown = (
        Predictor(BEAM, blank(POINTS)),
        replace(LOOK["beam"].measured, damping=np.full(2, np.nan)),
    )
    assert "already" in str(LIBRARY["shear"].obstacle(thick))
    mindlin = LOOK["plate"].of(LOOK["plate"].spec.with_theory("mindlin"))
    assert "already" in str(LIBRARY["shear"].obstacle(mindlin))
    assert "damping" in str(LIBRARY["exponential_window"].obstacle(LOOK["beam"].for_test(unknown)))


@admitted()
@settings(max_examples=15)
@given(u=st.floats(0.0, 1.0))
def test_priors_have_a_range_and_quantiles_go_there_and_back(name: str, place: str, u: float) -> None:
    effect = LIBRARY[name]
    for parameter in effect.parameters(LOOK[place]):
        assert parameter.low < parameter.high
        assert not parameter.log or parameter.low > 0
        assert parameter.unit
        assert len(parameter.why) > 10
        value = parameter.value(u)
        assert parameter.low * (1 - 1e-12) <= value <= parameter.high * (1 + 1e-12) or not parameter.log
        assert parameter.coordinate(value) == pytest.approx(u, abs=1e-9)
    count = len(effect.parameters(LOOK[place]))
    assert all(
        len(start) == count and all(0 <= v <= 1 for v in start) for start in effect.starts(LOOK[place])
    )
    assert len(effect.values(LOOK[place], [u] * count)) == count


@admitted()
def test_any_state_within_the_prior_has_modes(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    fuller = predictor.spec.fuller
    stage = predictor.under(fuller) if effect.fuller and fuller else predictor
    for u in (0.0, 0.5, 1.0):
        for chosen in effect.variants(predictor)[:6]:
            values = {**form(effect, predictor, u), **chosen.values}
            found = stage.predict(effect.state(stage, values), count=4)
            assert np.isfinite(found.frequency).all(), values
            assert np.isfinite(found.constants).all()
            if name != "calibration_gain":
                assert effect.channel == "measurement" or (found.damping >= 0).all() or place == "no shapes"
            for where in effect.locations(predictor, values):
                assert -1e-9 <= where[0] <= predictor.spec.length + 1e-9
            for value, unit in effect.derived(predictor, values).values():
                assert np.isfinite(value)
                assert unit


@admitted([n for n in LIBRARY if n in CHANGES], ["beam", "timoshenko", "plate", "free"], formed=True)
@pytest.mark.parametrize("quantile", [0.25, 0.6])
def test_the_small_model_agrees_with_the_full_one(name: str, place: str, quantile: float) -> None:
    """Sparse matrices of the whole model, the effect but its dampers put in by hand: to 0.05 % of every frequency.

    Of orthotropy to a fifth of the doubt in it, by the logarithm of its ratio (0.2 and 1.9 here): its modes are put
    together from those of an isotropic plate, which errs by 0.6 and 0.13 %.
    """
    effect, predictor = LIBRARY[name], LOOK[place]
    values = form(effect, predictor, quantile)
    values |= {damper: 0.0 for damper in ("damping", "alpha", "beta") if damper in values}
    values = {
        name: value for name, value in values.items() if name not in ("from", "to")
    }  # clamps along whole edges
    found = predictor.predict(effect.state(predictor, values), count=5).frequency
    full = full_modes(name, predictor, values, 5)
    near = 0.2 * effect.fidelity * abs(np.log(values["ratio"])) if name == "orthotropy" else 0.0
    assert found == pytest.approx(full, rel=max(near, bound(effect, predictor, full)))


@admitted([n for n in VANISHING if n in LIBRARY])
def test_an_effect_of_nothing_is_the_nominal_model(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    values = {k: v for k, v in form(effect, predictor).items() if k not in VANISHING[name]}
    values |= {k: v for k, v in VANISHING[name].items() if k != "dy" or predictor.spec.kind == "plate"}
    close = 3e-5
    if name.startswith("clamp"):  # a clamp is never rigid; ten times the end of the prior is nearly
        close = 5e-4
        values["stiffness"] = 10 * effect.parameters(predictor)[0].high
    found = predictor.predict(effect.state(predictor, values), count=4)
    plain = predictor.predict(count=4)
    assert found.frequency == pytest.approx(plain.frequency, rel=close)
    assert found.damping == pytest.approx(plain.damping, rel=4 * close, nan_ok=True)
    size = np.abs(plain.constants).max(initial=0.0)
    assert np.abs(found.constants) == pytest.approx(np.abs(plain.constants), abs=2e-3 * size)


@admitted(places=["beam", "plate"])
def test_the_order_of_the_points_does_not_matter(name: str, place: str) -> None:
    effect, here = LIBRARY[name], LOOK[place]
    test = here.measured
    turned = np.random.default_rng(4).permutation(len(test.points))
    back = np.argsort(turned)
    nodes = tuple(test.nodes[i] for i in turned)
    other = replace(test, points=test.points[turned], nodes=nodes, seen=back[test.seen], hit=back[test.hit])
    there = Predictor(here.spec, other)
    for values in [form(effect, here, u) for u in (0.2, 0.7)]:
        a, b = (p.predict(effect.state(p, values), count=4) for p in (here, there))
        assert a.frequency == pytest.approx(b.frequency, rel=1e-6)
        assert np.abs(a.constants) == pytest.approx(np.abs(b.constants), rel=1e-5, abs=1e-6)


SCALING = sorted({"E", "thickness", "length", "clamp_rotation", "clamp_translation", "local_stiffness", "orthotropy"}
                 | {"axial_load", "fluid_added_mass", "lumped_mass", "damping_patch", "shear"}
                 | {"ground_spring", "local_mass"})  # fmt: skip


@admitted(SCALING, ["beam", "plate"])
def test_units_are_those_of_the_specimen(name: str, place: str) -> None:
    """Twice as large in all directions of the same material: every prior follows, and every frequency halves."""
    effect, here = LIBRARY[name], LOOK[place]
    test = replace(here.measured, points=2 * here.measured.points, frequency=here.measured.frequency / 2)
    there = Predictor(scaled(here.spec, 2.0), test)
    for quantile in (0.3, 0.6):
        a, b = (p.predict(effect.state(p, form(effect, p, quantile)), count=5) for p in (here, there))
        assert b.frequency == pytest.approx(a.frequency / 2, rel=1e-5)
        assert np.abs(8 * b.constants) == pytest.approx(np.abs(a.constants), rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("name", [n for n in HARMLESS if n in LIBRARY])
@pytest.mark.parametrize("place", ["beam", "plate"])
def test_at_its_harmless_end_an_effect_hardly_shows(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    size = SIZE.get(name) or effect.parameters(predictor)[0].name
    values = form(effect, predictor, **{size: float(HARMLESS[name])})
    found = predictor.predict(effect.state(predictor, values), count=4).frequency
    assert found == pytest.approx(predictor.predict(count=4).frequency, rel=3e-3)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        (name, place)
        for name in LIBRARY
        if name in RISES
        for place in ("beam", "plate")
        if admits(name, place)
    ],
)
def test_frequencies_move_the_way_they_must(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    size = SIZE.get(name) or effect.parameters(predictor)[0].name
    low, high = (
        predictor.predict(effect.state(predictor, form(effect, predictor, **{size: u})), count=3).frequency
        for u in (0.4, 0.6)
    )
    if RISES[name]:
        assert (RISES[name] * np.log(high / low) >= -1e-9).all()
        assert RISES[name] * np.log(high / low).sum() > 1e-4
    else:
        assert high == pytest.approx(low, rel=1e-9)


@pytest.mark.long
def test_shear_turns_a_thin_plate_into_a_thick_one() -> None:
    plate = LOOK["plate"]
    found = plate.predict(LIBRARY["shear"].state(plate, {}), count=5).frequency
    thick = plate.of(plate.spec.with_theory("mindlin")).predict(count=5).frequency
    thin = plate.predict(count=5).frequency
    assert np.log(found / thin) == pytest.approx(np.log(thick / thin), abs=0.06 * np.log(thin / thick).max())
    assert np.all(found < thin)


def test_shear_lowers_the_higher_modes_most() -> None:
    fall = 1 - LOOK["beam"].predict(LIBRARY["shear"].state(LOOK["beam"], {}), count=5).frequency / (
        LOOK["beam"].predict(count=5).frequency
    )
    assert (np.diff(fall) > 0).all()
    assert fall[0] > 0


def test_a_soft_spot_says_its_compliance() -> None:
    """A box of depth p and width d has a compliance of d p / (1 - p); its soft edges change little."""
    values = {"x": 0.2, "extent": 0.05, "loss": 0.5}
    compliance, unit = LIBRARY["local_stiffness"].derived(LOOK["beam"], values)["compliance"]
    assert unit == "m"
    assert compliance == pytest.approx(0.05, rel=0.15)


def test_a_stiffer_place_has_a_compliance_below_nothing() -> None:
    """A box of extent d at four times the stiffness has -3 d / 4; soft edges of what is stiff are wide."""
    values = {"x": 0.2, "extent": 0.1, "loss": -3.0}
    effect = LIBRARY["local_stiffness"]
    assert effect.derived(LOOK["beam"], values)["compliance"][0] == pytest.approx(-0.075, rel=0.2)
    assert "stiffer" in effect.sentence(values)
    assert "softer" in effect.sentence({**values, "loss": 0.3})


def test_a_place_of_a_plate_is_as_wide_as_long_where_its_width_is_not_stated() -> None:
    square = {"x": 0.2, "y": 0.1, "extent": 0.05, "loss": 0.5}
    states = [
        accepted_state(LOOK["plate"], "local_stiffness", v) for v in (square, {**square, "extent_y": 0.05})
    ]
    assert states[0].stiffness[0] == pytest.approx(states[1].stiffness[0])


def test_softer_and_stiffer_are_two_forms_each_uniform_in_log_compliance() -> None:
    effect, predictor = LIBRARY["local_stiffness"], LOOK["beam"]
    for chosen, sign in zip(effect.variants(predictor), (1, -1), strict=True):
        losses = []
        for u in np.linspace(0.05, 0.95, 7):
            q = chosen.quantile("loss", u if sign > 0 else 1 - u)
            losses.append(effect.values(predictor, [0.5, 0.5, q])["loss"])
        compliance = np.array(losses) / (1 - np.array(losses))
        assert (sign * compliance > 0).all()
        assert np.diff(np.log(sign * compliance)) == pytest.approx(np.diff(np.log(sign * compliance))[0])
        assert chosen.quantile("x", 0.3) == 0.3


def test_a_fluid_that_is_told_is_not_searched_for() -> None:
    stated = replace(LOOK["beam"], environment=Environment(998.0, free_surface=0.2, bottom=0.1))
    parameter, wall = LIBRARY["fluid_added_mass"].parameters(stated)
    assert wall.name == "wall"
    assert parameter.low == pytest.approx(0.97 * 998)
    assert parameter.high == pytest.approx(1.03 * 998)


def test_a_mass_of_nothing_says_where_a_sensor_sits() -> None:
    spec = replace(THIN, masses=(PointMass((0.376,), 0.0),))
    predictor = Predictor(spec, blank(POINTS[:0], shapes_only=True))
    assert LIBRARY["sensor_mass"].obstacle(predictor) is None
    assert LIBRARY["sensor_mass"].locations(predictor, {"mass": 0.01}) == ((0.376, 0.0, 0.0),)


@pytest.mark.long
def test_the_record_of_the_library_is_complete() -> None:
    record = effects_document()
    assert record["schema"] == "modalkit.effects/1"
    assert [e["name"] for e in record["effects"]] == list(LIBRARY)
    keys = {
        "name",
        "channel",
        "summary",
        "footprint",
        "models",
        "equivalent_to",
        "separated_by",
        "parameters",
    }
    for entry in record["effects"]:
        assert keys <= set(entry)
        for parameter in entry["parameters"]:
            assert {"name", "unit", "low", "high", "log", "why"} <= set(parameter)


@pytest.mark.parametrize("values", [{}, {"stifness": 4000.0}, {"stiffness": 4000.0, "loss": 0.1}])
def test_an_accepted_effect_takes_its_own_parameters_only(values: dict[str, float]) -> None:
    predictor = Predictor(BEAM, blank(POINTS))
    with pytest.raises(StudyError, match="stiffness"):
        accepted_state(predictor, "clamp_rotation", values)


def test_an_accepted_effect_must_exist() -> None:
    with pytest.raises(StudyError, match="moon_phase"):
        accepted_state(Predictor(BEAM, blank(POINTS)), "moon_phase", {})


@pytest.mark.parametrize(
    ("name", "values", "says"),
    [
        ("lumped_mass", {"mass": 0.01, "x": 99.0}, "x = 99 m is off the structure"),
        ("lumped_mass", {"mass": -0.01, "x": 0.1}, "mass = -0.01 kg must be positive"),
        ("lumped_mass", {"mass": 1e300, "x": 0.1}, "million times outside"),
        ("sensor_mass", {"mass": 0.01, "bulk": -1.0}, "bulk = -1 must not be negative"),
        ("local_stiffness", {"x": 0.1, "extent": 0.02, "loss": 1.0}, "removes all stiffness"),
        ("local_stiffness", {"x": 0.1, "extent": 0.02, "loss": -1e300}, "million times outside"),
        ("clamp_rotation", {"stiffness": -1.0}, "stiffness = -1 N m/rad must be positive"),
        ("E", {"factor": 0.0}, "factor = 0 must be positive"),
        ("length", {"extension": -0.376}, "leaves nothing of the structure"),
    ],
)
def test_values_that_nothing_has_are_refused(name: str, values: dict[str, float], says: str) -> None:
    with pytest.raises(StudyError, match=re.escape(says)):
        accepted_state(LOOK["beam"], name, values)


@pytest.mark.parametrize("place", ["beam", "plate"])
@pytest.mark.parametrize("name", ["lumped_mass", "damping_patch"])
def test_a_balance_shows_the_mass_that_an_effect_adds_to_a_body_moving_as_one(name: str, place: str) -> None:
    free = LOOK[place].of(replace(LOOK[place].spec, clamped=()))
    values = {
        "x": 0.2,
        "y": 0.1,
        "extent": 0.1,
        "mass": 0.1,
        "bulk": 0.0,
        "stiffness": 0.0,
        "loss_factor": 0.1,
    }
    moving = free.reduced.sampled["w"]
    unit = np.linalg.lstsq(moving, np.ones(len(moving)), rcond=None)[0]
    added = sum(LIBRARY[name].state(free, values).mass)
    assert LIBRARY[name].weight(free, values) == pytest.approx(unit @ added @ unit, rel=1e-6)
    assert LIBRARY[name].weight(free, values) > 0
