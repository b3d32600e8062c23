"""One body of tests for every effect of the library, and how an outsider adds one."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, PLATE, POINTS, blank, case_of, specimen, struck

from acquisition.errors import StudyError
from modalkit.records import effects_record
from updating import LIBRARY, Effect, Environment, Parameter, Predictor, diagnose, register
from updating.effects import accepted_state
from updating.models import PointMass
from updating.models.state import NOMINAL, State

CONTRACT = {
    "E": {"factor"},
    "density": {"factor"},
    "thickness": {"factor"},
    "section_scale": {"factor"},
    "length": {"extension"},
    "clamp_rotation": {"stiffness"},
    "clamp_translation": {"stiffness"},
    "sensor_mass": {"mass"},
    "lumped_mass": {"mass", "x", "y"},
    "local_stiffness": {"x", "y", "extent", "loss"},
    "shear": set(),
    "orthotropy": {"ratio"},
    "axial_load": {"force"},
    "fluid_added_mass": {"fluid_density"},
    "fluid_damping": {"viscosity"},
    "damping_patch": {"x", "y", "extent", "loss_factor", "mass", "stiffness"},
    "uniform_damping": {"alpha", "beta", "loss_factor"},
    "joint_nonlinearity": {"slope"},
    "exponential_window": {"decay"},
    "calibration_gain": {"gain"},
    "time_delay": {"delay"},
    "polarity": {"points"},
    "swapped_points": {"points"},
    "position_error": {"point", "dx", "dy"},
}
RISES = {"E": 1, "density": -1, "thickness": 1, "length": -1, "clamp_rotation": 1, "sensor_mass": -1}
RISES |= {"clamp_translation": 1, "lumped_mass": -1, "local_stiffness": -1, "axial_load": 1}
RISES |= {"fluid_added_mass": -1, "exponential_window": 0, "calibration_gain": 0, "section_scale": 0}
"""Sign of the change of the first frequency with each effect's first size; 0 is none at all."""
SIZE = {"local_stiffness": "loss", "lumped_mass": "mass"}
HARMLESS = {"clamp_rotation": 1, "clamp_translation": 1, "sensor_mass": 0, "lumped_mass": 0}
"""End of the prior, 0 low or 1 high, at which nothing can be seen; a clamp is rigid at its high end."""
HARMLESS |= {"local_stiffness": 0, "exponential_window": 0}

THIN = replace(BEAM, theory="euler-bernoulli")
CORNERS = np.array([[x, y] for x in np.linspace(0.09, 0.376, 4) for y in (0.0, 0.11, 0.2)])
LOOK = {
    "beam": Predictor(THIN, blank(POINTS)),
    "plate": Predictor(PLATE, blank(CORNERS)),
    "no shapes": Predictor(THIN, blank(POINTS[:0], shapes_only=True)),
    "free": Predictor(replace(THIN, clamped=()), blank(POINTS)),
}
every = pytest.mark.parametrize("name", list(LIBRARY))
places = pytest.mark.parametrize("place", list(LOOK))


def admits(name: str, place: str) -> bool:
    return LIBRARY[name].obstacle(LOOK[place]) is None


def middle(effect: Effect, predictor: Predictor, **ends: float) -> dict[str, float]:
    parameters = effect.parameters(predictor)
    return effect.values(predictor, [ends.get(p.name, 0.45) for p in parameters])


@every
def test_every_effect_speaks_of_itself(name: str) -> None:
    effect = LIBRARY[name]
    assert effect.name == name
    assert effect.channel in ("stiffness", "mass", "damping", "measurement")
    for text in (effect.summary, effect.footprint, effect.separated_by, type(effect).__doc__ or ""):
        assert len(text) > 20
    assert set(effect.models) <= {"beam", "plate", "matrices"}
    assert set(effect.equivalent_to) <= set(CONTRACT), "an equivalent that nobody knows"
    assert 0 <= effect.fidelity < 0.2


@every
@pytest.mark.parametrize("place", ["beam", "plate"])
def test_names_and_parameters_are_those_of_the_contract(name: str, place: str) -> None:
    if admits(name, place):
        names = {p.name for p in LIBRARY[name].parameters(LOOK[place])}
        assert name in CONTRACT
        assert names <= CONTRACT[name]
        assert names >= CONTRACT[name] - ({"y"} if place == "beam" else set())


@every
@places
def test_an_obstacle_is_a_reason_or_nothing(name: str, place: str) -> None:
    why = LIBRARY[name].obstacle(LOOK[place])
    assert why is None or (isinstance(why, str) and len(why) > 10)
    if why is None:
        assert LOOK[place].spec.kind in LIBRARY[name].models


def test_what_cannot_be_examined_is_said() -> None:
    assert not admits("clamp_rotation", "free")
    assert not admits("shear", "plate")
    assert not admits("sensor_mass", "no shapes")
    assert not admits("calibration_gain", "no shapes")
    thick, unknown = (
        Predictor(BEAM, blank(POINTS)),
        replace(LOOK["beam"].measured, damping=np.full(2, np.nan)),
    )
    assert "already" in (LIBRARY["shear"].obstacle(thick) or "")
    assert "damping" in (LIBRARY["exponential_window"].obstacle(LOOK["beam"].looking(unknown)) or "")


@every
@places
@settings(max_examples=15, deadline=None)
@given(u=st.floats(0.0, 1.0))
def test_priors_have_a_range_and_quantiles_go_there_and_back(name: str, place: str, u: float) -> None:
    if not admits(name, place):
        return
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


@every
@places
def test_any_state_within_the_prior_has_modes(name: str, place: str) -> None:
    if not admits(name, place):
        return
    effect, predictor = LIBRARY[name], LOOK[place]
    count = len(effect.parameters(predictor))
    for u in (0.0, 0.5, 1.0):
        values = effect.values(predictor, [u] * count)
        found = predictor.predict(effect.state(predictor, values), count=4)
        assert np.isfinite(found.frequency).all(), values
        assert np.isfinite(found.constants).all()
        for where in effect.locations(predictor, values):
            assert -1e-9 <= where[0] <= predictor.spec.length + 1e-9
        for value, unit in effect.derived(predictor, values).values():
            assert np.isfinite(value)
            assert unit


@pytest.mark.parametrize("name", [n for n in HARMLESS if n in LIBRARY])
@pytest.mark.parametrize("place", ["beam", "plate"])
def test_at_its_harmless_end_an_effect_hardly_shows(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    size = SIZE.get(name) or effect.parameters(predictor)[0].name
    values = middle(effect, predictor, **{size: float(HARMLESS[name])})
    found = predictor.predict(effect.state(predictor, values), count=4).frequency
    assert found == pytest.approx(predictor.predict(count=4).frequency, rel=3e-3)


@every
@pytest.mark.parametrize("place", ["beam", "plate"])
def test_frequencies_move_the_way_they_must(name: str, place: str) -> None:
    if name not in RISES or not admits(name, place):
        pytest.skip("needs nothing of the kind, or a sign is not its business")
    effect, predictor = LIBRARY[name], LOOK[place]
    size = SIZE.get(name) or effect.parameters(predictor)[0].name
    low, high = (
        predictor.predict(effect.state(predictor, middle(effect, predictor, **{size: u})), count=3).frequency
        for u in (0.4, 0.6)
    )
    if RISES[name]:
        assert (RISES[name] * np.log(high / low) >= -1e-9).all()
        assert RISES[name] * np.log(high / low).sum() > 1e-4
    else:
        assert high == pytest.approx(low, rel=1e-9)


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


def test_a_fluid_that_is_told_is_not_searched_for() -> None:
    told = replace(LOOK["beam"], environment=Environment(fluid_density=998.0))
    (parameter,) = LIBRARY["fluid_added_mass"].parameters(told)
    assert parameter.low == pytest.approx(0.97 * 998)
    assert parameter.high == pytest.approx(1.03 * 998)


def test_a_mass_of_nothing_says_where_a_sensor_sits() -> None:
    spec = replace(THIN, masses=(PointMass((0.376,), 0.0),))
    predictor = Predictor(spec, blank(POINTS[:0], shapes_only=True))
    assert LIBRARY["sensor_mass"].obstacle(predictor) is None
    assert LIBRARY["sensor_mass"].locations(predictor, {"mass": 0.01}) == ((0.376, 0.0, 0.0),)


def test_the_record_of_the_library_is_complete() -> None:
    record = effects_record()
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


class GroundSpring(Effect):
    """A cable that holds the middle of the structure against the ground."""

    name = "ground_spring"
    channel = "stiffness"
    summary = "A cable holds the middle of the structure."
    footprint = "Frequencies rise, most in the lowest mode; shapes flatten about the cable."
    separated_by = "take the cable off"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        return (Parameter("stiffness", "N/m", 10.0, 1e5, "from a thread to a strut", log=True),)

    def state(self, predictor: Predictor, values: dict[str, float]) -> State:  # type: ignore[override]
        row = predictor.reduced.rows(np.array([[predictor.spec.length / 2]]))["w"]
        return State(stiffness=(values["stiffness"] * row.T @ row,))


@pytest.fixture
def library() -> Iterator[dict[str, Effect]]:
    before = dict(LIBRARY)
    yield LIBRARY
    LIBRARY.clear()
    LIBRARY.update(before)


def test_an_outsiders_effect_is_registered_and_named(library: dict[str, Effect]) -> None:
    rng = np.random.default_rng(3)
    beam = specimen(rng)
    held = replace(beam, masses=((beam.length / 2, 0.0),))
    frequency = beam.frequencies(5)
    assert held.frequencies(5) == pytest.approx(frequency, rel=1e-9)
    register(GroundSpring())
    assert "ground_spring" in library
    predictor = Predictor(BEAM.with_elements(60), struck(beam, rng))
    truth = predictor.predict(library["ground_spring"].state(predictor, {"stiffness": 3000.0}), count=5)
    test = replace(
        predictor.measured,
        frequency=truth.frequency * (1 + 5e-4 * rng.standard_normal(5)),
        frequency_sigma=1e-4 * truth.frequency,
        constants=truth.constants * (1 + 0.003 * rng.standard_normal(truth.constants.shape)),
    )
    found = diagnose(case_of(test, BEAM.with_elements(20)))
    assert (found.verdict, found.sets) == ("named", (("ground_spring",),))
    estimate = found.ranking[0].parameters["ground_spring.stiffness"]
    assert estimate.low95 < 3000 < estimate.high95
    assert predictor.predict(NOMINAL, count=1).frequency[0] < truth.frequency[0]


@pytest.mark.parametrize("values", [{}, {"stifness": 4000.0}, {"stiffness": 4000.0, "loss": 0.1}])
def test_an_accepted_effect_takes_its_own_parameters_only(values: dict[str, float]) -> None:
    predictor = Predictor(BEAM, blank(POINTS))
    with pytest.raises(StudyError, match="stiffness"):
        accepted_state(predictor, "clamp_rotation", values)


def test_an_accepted_effect_must_exist() -> None:
    with pytest.raises(StudyError, match="moon_phase"):
        accepted_state(Predictor(BEAM, blank(POINTS)), "moon_phase", {})
