"""Updating by FRFs: sensitivities against differences, recovery of known parameters, what cannot be told."""

from dataclasses import replace

import numpy as np
import pytest
from conforming import departures
from stage_cases import slopes_and_differences, stage_of

from acquisition.errors import StudyError
from modalkit.output.schemas import UpdateDocument
from modalkit.output.update import to_json
from modalkit.output.whole import plain
from updating import Case, Material, Measured, Predictor, Region, Spec
from updating.frf_update import FrfUpdate, bootstrap_frf_update, update_frfs
from updating.frf_update.lines import choose_lines
from updating.frf_update.solve import increment
from updating.frf_update.stage import nominal
from updating.test_data.measured_frfs import MeasuredFrfs

STEEL = Material(210e9, 7860.0, 0.3)
START = {
    "area": (144.9e-6, 151.2e-6),
    "inertia": (255.5e-12, 290.3e-12),
    "alpha": (3.0, 3.0),
    "beta": (1e-7, 1e-7),
}
TRUTH = {
    "area": (160e-6, 175e-6),
    "inertia": (275e-12, 330e-12),
    "alpha": (5.0, 9.6),
    "beta": (1.2e-6, 6.7e-6),
}
STRUCTURE = ["bare.area", "bare.inertia", "taped.area", "taped.inertia"]
DAMPING = ["bare.alpha", "bare.beta", "taped.alpha", "taped.beta"]
POINTS = np.linspace(0.0, 1.0, 11)[:, None]


def beam(values: dict[str, tuple[float, float]], *, elements: int = 20) -> Spec:
    """Return paper B's free beam: segments 6-8 taped."""
    bare, taped = ({k: v[i] for k, v in values.items()} for i in range(2))
    regions = (
        Region("bare", (0.0, 0.5), **bare),
        Region("taped", (0.5, 0.8), **taped),
        Region("bare", (0.8, 1.0), **bare),
    )
    return Spec(
        "beam",
        length=1.0,
        width=0.0315,
        thickness=0.0046,
        elements=(elements,),
        clamped=(),
        theory="euler-bernoulli",
        material=STEEL,
        regions=regions,
    )


def taken(
    truth: Spec, *, noise: float = 1e-3, decay: float = 0.0, seed: int = 0, roving: bool = False
) -> tuple[Measured, MeasuredFrfs]:
    """Measure a beam whose modes are known: eleven points, one of them excited (or seen, with a roving hammer)."""
    many, one = np.arange(11), np.full(11, 3)
    seen, hit = (one, many) if roving else (many, one)
    nothing = np.full(6, np.nan)
    blank = Measured(
        frequency=np.linspace(20, 450, 6), frequency_sigma=nothing, damping=nothing, damping_sigma=nothing,
        points=POINTS, nodes=tuple(range(1, 12)), seen=seen, hit=hit, constants=np.ones((11, 6)),
        constants_sigma=np.ones((11, 6)), absolute=True,
    )  # fmt: skip
    there = Predictor(truth, blank)
    modes, poles = there.predict(count=6), there.complex_modes().poles[:6]
    s = 2j * np.pi * np.arange(8.0, 600.0, 0.5) + decay
    h = there.receptance(s)
    sigma = noise * np.sqrt(np.mean(np.abs(h * s**2) ** 2, axis=1, keepdims=True)) / np.abs(s**2)
    rng = np.random.default_rng(seed)
    scatter = (rng.standard_normal(h.shape) + 1j * rng.standard_normal(h.shape)) / np.sqrt(2)
    measured = replace(
        blank,
        frequency=modes.frequency,
        frequency_sigma=1e-4 * modes.frequency,
        damping=-poles.real / np.abs(poles),
        damping_sigma=np.full(6, 1e-4),
        constants=modes.constants,
        constants_sigma=1e-3 * np.ones((11, 6)),
        calibration=1e-4,
        repeatability=0.0,  # one mounting, whose frequencies are the truth's
    )
    return measured, MeasuredFrfs(s, h + sigma * scatter, sigma**2 * np.ones(h.shape), seen, hit, "test")


def updated(truth: Spec, **options: object) -> FrfUpdate:
    measured, frfs = taken(truth, **options)  # type: ignore[arg-type]
    return update_frfs(Case("tape", beam(START), measured), frfs, stages=[STRUCTURE, DAMPING], lines=60)


def wanted(name: str) -> float:
    region, quantity = name.split(".")
    return TRUTH[quantity][("bare", "taped").index(region)]


@pytest.fixture(scope="module")
def result() -> FrfUpdate:
    return updated(beam(TRUTH))


@pytest.mark.long
def test_section_and_damping_of_both_regions_come_back(result: FrfUpdate) -> None:
    assert result.converged
    for p in result.parameters:
        assert p.value == pytest.approx(wanted(p.name), abs=4 * p.sigma + 1e-4 * wanted(p.name))
        assert p.sigma < (0.2 if "alpha" in p.name or "beta" in p.name else 0.003) * wanted(p.name)
    assert result.undetermined == ()
    assert max(result.discrepancy) < 0.01


def test_frac_and_damping_are_told_before_and_after(result: FrfUpdate) -> None:
    assert result.frac["before"].max() < 0.9
    assert result.frac["after"].min() > 0.999
    assert (result.frac["after stage 1"] > result.frac["before"]).all()
    assert result.damping_error_percent("before") > 50
    assert result.damping_error_percent("after") < 1
    assert result.rms_percent("before") > 1
    assert result.rms_percent("after") < 0.02


def test_the_document_is_what_is_declared(result: FrfUpdate) -> None:
    assert not departures(plain(to_json(result)), UpdateDocument)


def test_the_history_is_complete(result: FrfUpdate) -> None:
    assert list(result.history.columns) == STRUCTURE + DAMPING
    assert len(result.history) == 1 + sum(result.stages) == 1 + result.iterations
    first = result.history.iloc[: 1 + result.stages[0]]
    assert (first[DAMPING].nunique() == 1).all()
    assert result.history.iloc[-1]["bare.alpha"] == result.parameters[4].value


@pytest.mark.long
def test_a_window_s_decay_is_in_the_model_too() -> None:
    windowed = updated(beam(TRUTH), decay=6.0)
    for p in windowed.parameters:
        assert p.value == pytest.approx(wanted(p.name), abs=4 * p.sigma + 1e-3 * wanted(p.name))


@pytest.mark.long
def test_a_roving_hammer_gives_what_roving_sensors_give() -> None:
    both = [updated(beam(TRUTH), noise=1e-6, roving=roving) for roving in (False, True)]
    first, second = ([p.value for p in one.parameters] for one in both)
    assert first == pytest.approx(second, rel=1e-3)


@pytest.mark.long
def test_intervals_cover_over_noise() -> None:
    hits = []
    for seed in range(6):
        one = updated(beam(TRUTH), noise=5e-3, seed=seed)
        hits += [abs(p.value - wanted(p.name)) < 1.96 * p.sigma for p in one.parameters]
    assert sum(hits) >= 40  # of 48; 45.6 are expected, 38 would be as rare as one in ten thousand


NAMES = [
    *STRUCTURE,
    *DAMPING,
    "taped.loss_factor",
    "E",
    "density",
    "length",
    "sensor_mass",
    "calibration_gain",
    "alpha",
]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("decay", [0.0, 5.0])
def test_sensitivities_against_differences(name: str, decay: float) -> None:
    spec = beam(TRUTH)
    if name in ("length", "alpha"):
        own = replace(spec, clamped=("x0",) if name == "length" else ())
        spec = replace(own, regions=tuple(replace(r, alpha=None) for r in spec.regions))
    stage = stage_of(spec, *taken(spec, decay=decay, roving=name == "sensor_mass"), [name])
    stage = stage.lines(np.arange(0, len(stage.frfs.laplace), 40))
    (parameter,) = stage.model_parameters
    value = {"sensor_mass": 0.01, "length": 0.004}.get(name, parameter.start or 0.01)
    step = 1e-4 * min(parameter.doubt, parameter.span() / 10)
    by, difference = slopes_and_differences(stage, np.array([parameter.coordinate(value)]), step)
    assert by == pytest.approx(difference, abs=1e-4 * np.abs(by).max())


def test_equation_9_is_exact_where_every_degree_of_freedom_is_measured() -> None:
    """With displacements and slopes known at every node the measured column needs no expansion: one step is enough.

    Here the measured points are many enough that the expansion cannot err: ten elements, points at every quarter.
    """
    start, truth = (
        replace(beam(v), elements=(4,), regions=(Region("all", (0.0, 1.0), area=v["area"][0], alpha=5.0),))
        for v in (START, TRUTH)
    )
    points = np.linspace(0.0, 1.0, 21)[:, None]
    count = len(points)
    blank = replace(
        taken(beam(TRUTH))[0], points=points, nodes=tuple(range(1, 22)), seen=np.arange(count),
        hit=np.full(count, 3), constants=np.ones((count, 6)), constants_sigma=np.ones((count, 6)),
    )  # fmt: skip
    s = 2j * np.pi * np.linspace(30, 300, 9)
    h = Predictor(truth, blank).receptance(s)
    frfs = MeasuredFrfs(s, h, 1e-30 * np.abs(h) ** 2, blank.seen, blank.hit)
    stage = stage_of(start, blank, frfs, ["all.area"])
    theta = nominal(stage.model_parameters)
    at = stage.evaluate(theta)
    by = stage.slopes(theta, at, measured=True)[0]
    # Z is linear in the area itself; C = alpha M follows it
    factor = float((np.vdot(by, stage.residual(at)) / np.vdot(by, by)).real)
    assert 1 + factor == pytest.approx(TRUTH["area"][0] / START["area"][0], rel=2e-3)


@pytest.mark.long
def test_lines_are_chosen_for_what_they_tell() -> None:
    measured, frfs = taken(beam(TRUTH))
    stage = stage_of(beam(START), measured, frfs, STRUCTURE)
    theta = nominal(stage.model_parameters)

    def volume(chosen: np.ndarray) -> float:
        """Return the logarithm of the determinant of the information on the parameters, in their doubts."""
        few = stage.lines(chosen)
        at = few.evaluate(theta)
        slopes = few.slopes(theta, at, measured=False) * stage.doubt[:, None, None]
        information = np.einsum("pfl,qfl,fl->pq", slopes, slopes.conj(), 1 / few.variance(at, 0.05))
        return float(np.linalg.slogdet(information.real)[1])

    best = volume(choose_lines(stage, theta, 0.05, 20))
    rng = np.random.default_rng(1)
    others = [volume(np.sort(rng.choice(len(frfs.laplace), 20, replace=False))) for _ in range(20)]
    assert best > max(others)


@pytest.mark.long
def test_lines_may_be_given() -> None:
    measured, frfs = taken(beam(TRUTH))
    given = [20.0, 40.0, 60.0, 90.0, 150.0, 180.0, 250.0, 400.0]
    one = update_frfs(Case("tape", beam(START), measured), frfs, parameters=STRUCTURE, lines=given)
    assert one.lines[0] == pytest.approx(given)
    with pytest.raises(StudyError, match=r"lines: \[900\.0\] Hz is outside the band"):
        update_frfs(Case("tape", beam(START), measured), frfs, parameters=["E"], lines=[900.0])
    with pytest.raises(StudyError, match="at least one line"):
        update_frfs(Case("tape", beam(START), measured), frfs, parameters=["E"], lines=0)


@pytest.mark.long
def test_parameters_fall_into_stages_by_themselves() -> None:
    measured, frfs = taken(beam(TRUTH))
    case = Case("tape", beam(START), measured)
    one = update_frfs(case, frfs, parameters=[DAMPING[0], STRUCTURE[0]], lines=20)
    assert [p.name for p in one.parameters] == [STRUCTURE[0], DAMPING[0]]
    with pytest.raises(StudyError, match="both parameters and stages"):
        update_frfs(case, frfs, parameters=["E"], stages=[["E"]])
    with pytest.raises(StudyError, match="names no parameters"):
        update_frfs(case, frfs)
    with pytest.raises(StudyError, match="no 'volume' to update"):
        update_frfs(case, frfs, parameters=["taped.volume"])


@pytest.mark.long
def test_what_level_and_section_share_is_not_told_apart() -> None:
    """A factor on stiffness and mass alike is the gain of the measurement: nothing moves, and it is said."""
    measured, frfs = taken(beam(TRUTH))
    case = Case("tape", beam(TRUTH), measured)
    one = update_frfs(case, frfs, parameters=["section_scale", "calibration_gain"], lines=30)
    assert set(one.undetermined) == {"section_scale", "calibration_gain"}
    sigma = {p.name: p.sigma for p in one.parameters}
    assert min(sigma.values()) > 0.1


@pytest.mark.long
def test_without_any_damping_the_identified_ratios_stand_in() -> None:
    plain = {k: v for k, v in START.items() if k in ("area", "inertia")}
    measured, frfs = taken(beam(TRUTH))
    one = update_frfs(Case("tape", beam(plain), measured), frfs, parameters=STRUCTURE, lines=40)
    assert one.frac["after"].min() > 0.99
    assert one.state.ratios is not None
    for p in one.parameters:
        assert p.value == pytest.approx(wanted(p.name), rel=0.03)


def test_a_step_never_leaves_the_bounds() -> None:
    stage = stage_of(beam(START), *taken(beam(START)), ["bare.beta"])
    down = increment(stage, stage.low, np.array([[1.0]]) / stage.doubt, np.array([-3.0]))
    up = increment(stage, stage.low, 10 * np.array([[1.0]]) / stage.doubt, np.array([3.0]))
    assert down == pytest.approx([0.0])
    assert up[0] > 0


@pytest.mark.long
def test_redrawn_data_scatter_as_the_standard_deviations_say() -> None:
    measured, frfs = taken(beam(TRUTH), noise=5e-3)
    case, rng = Case("tape", beam(START), measured), np.random.default_rng(0)
    found = bootstrap_frf_update(case, frfs, rng=rng, n=24, stages=[STRUCTURE, DAMPING], lines=40)
    for p, drawn in zip(found.update.parameters, found.values.T, strict=True):
        nominal = p.value / (p.factor or p.value)
        assert 0.55 < np.std(nominal * drawn) / p.sigma < 1.6
        assert p.interval is not None
        assert p.interval[0] < p.value < p.interval[1]
    with pytest.raises(StudyError, match="5 draws are too few"):
        bootstrap_frf_update(case, frfs, rng=rng, n=5, parameters=["E"])
