"""Updating by FRFs where it is hard: unknown windows, far starts, stages in any order, bad channels."""

from dataclasses import replace

import numpy as np
import pytest
from stage_cases import slopes_and_differences, stage_of
from test_frf_update import DAMPING, START, STRUCTURE, TRUTH, beam, taken, wanted

from updating import Case, Damping, Material, Measured, Predictor, Region, Spec
from updating.effects import accepted_state
from updating.frf_update import FrfUpdate, update_frfs
from updating.frf_update.columns import columns
from updating.frf_update.evaluation import evaluate
from updating.frf_update.mounting import resonances, shifted
from updating.models.response import receptance
from updating.models.state import NOMINAL, State
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.tolerances import Tolerances
from updating.update.parameters.named import build_parameter_set, only_damps

STEEL = Material(210e9, 7850.0, 0.3)
CANTILEVER = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(20,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
    damping=Damping(1.0, 5e-7),
)
SPANS = {"root": (0.0, 0.15), "middle": (0.15, 0.27), "tip": (0.27, 0.4)}


def clamped(factors: dict[str, float]) -> Spec:
    """Return a cantilever so fine that its reduced basis is not the whole of it."""
    regions = tuple(Region(name, SPANS[name], E=210e9 * f) for name, f in factors.items())
    return replace(CANTILEVER, elements=(60,), regions=regions)


def hit_beam(
    spec: Spec, effect: str = "", *, order: int = 0, repeatability: float = 0.0, **values: float
) -> tuple[Measured, MeasuredFrfs]:
    """Measure a cantilever with an effect at eight points with a sensor at its tip; noise is 0.1 %."""
    points, some = np.linspace(0.05, 0.4, 8)[:, None], np.full(5, 0.005)
    ends = np.full(8, 7), np.arange(8)
    blank = Measured(
        frequency=np.linspace(25, 800, 5),
        frequency_sigma=some,
        damping=some,
        damping_sigma=some,
        points=points,
        nodes=tuple(range(1, 9)),
        seen=ends[0],
        hit=ends[1],
        constants=np.ones((8, 5)),
        constants_sigma=np.ones((8, 5)),
        absolute=True,
        calibration=1e-4,
        repeatability=repeatability,
    )
    there = Predictor(spec, blank)
    state = accepted_state(there, effect, values) if effect else NOMINAL
    modes = there.predict(state, count=5)
    s = 2j * np.pi * np.arange(0.5 * modes.frequency[0], 1.05 * modes.frequency[-1], 1.0)
    decay = values.get("decay", 0.0)
    # by hand, so that nothing is assumed of how the model treats a window or the form of the file
    h = receptance(there.matrices(state), *there.frf_rows(state), s + decay) * ((s + decay) / s) ** order
    sigma = 1e-3 * np.sqrt(np.mean(np.abs(h * s**2) ** 2, axis=1, keepdims=True)) / np.abs(s**2)
    noise = np.random.default_rng(3).standard_normal((2, *h.shape)) / np.sqrt(2)
    measured = replace(
        blank,
        frequency=modes.frequency,
        frequency_sigma=1e-5 * modes.frequency,
        damping=modes.damping,
        damping_sigma=1e-2 * modes.damping,
        constants=modes.constants,
        constants_sigma=np.full((8, 5), 1e-3),
    )
    frfs = MeasuredFrfs(
        s, h + sigma * (noise[0] + 1j * noise[1]), sigma**2 + 0 * h.real, *ends, "test", order
    )
    return measured, frfs


def found(result: FrfUpdate) -> dict[str, tuple[float, float]]:
    return {p.name: (p.value, p.sigma) for p in result.parameters}


@pytest.mark.long
@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_window_that_nobody_stated_comes_back(order: int) -> None:
    measured, frfs = hit_beam(CANTILEVER, "exponential_window", order=order, decay=6.0)
    result = update_frfs(Case("c", CANTILEVER, measured), frfs, parameters=["E", "exponential_window"])
    value, sigma = found(result)["exponential_window"]
    assert value == pytest.approx(6.0, abs=4 * sigma)
    assert sigma < 0.1
    assert result.undetermined == ()
    assert result.frac["after"].iloc[-1] > 0.9999  # at the tip; noise rules near the clamp


def test_a_parameter_of_an_effect_is_staged_as_damping_by_what_it_does() -> None:
    names = [
        "uniform_damping.alpha",
        "exponential_window",
        "alpha",
        "tip.beta",
        "E",
        "damping_patch",
        "damping_patch.x",
    ]
    assert [n for n in names if only_damps(n)] == names[:4]
    predictor = Predictor(CANTILEVER, hit_beam(CANTILEVER)[0])
    values = {"uniform_damping": {"beta": 0.0, "loss_factor": 0.0}}
    parameter_set = build_parameter_set(["uniform_damping.alpha", "E"], predictor, Tolerances(), values)
    assert [p.damps for p in parameter_set.model_parameters] == [True, False]


@pytest.mark.long
def test_an_accepted_window_is_in_the_model_s_frfs() -> None:
    measured, frfs = hit_beam(CANTILEVER, "exponential_window", decay=6.0)
    case = Case("c", CANTILEVER, measured, accepted=(("exponential_window", {"decay": 6.0}),))
    result = update_frfs(case, frfs, parameters=["alpha", "beta"])
    assert result.frac["before"].iloc[-1] > 0.9999
    assert found(result)["beta"][0] == pytest.approx(5e-7, rel=0.01)


def test_the_derivative_by_a_window_s_decay_against_differences() -> None:
    measured, frfs = hit_beam(CANTILEVER, "exponential_window", order=2, decay=6.0)
    stage = stage_of(CANTILEVER, measured, frfs, ["exponential_window"])
    stage = stage.lines(np.arange(0, len(frfs.laplace), 20))
    (parameter,) = stage.model_parameters
    by, difference = slopes_and_differences(stage, np.array([parameter.coordinate(6.0)]), 1e-4)
    assert by == pytest.approx(difference, abs=1e-5 * np.abs(by).max())


@pytest.mark.long
@pytest.mark.parametrize(
    ("effect", "name", "true"), [("sensor_mass", "mass", 0.02), ("clamp_rotation", "stiffness", 2000.0)]
)
def test_peaks_far_apart_do_not_end_in_a_hollow_between(effect: str, name: str, true: float) -> None:
    """From 0 kg the mass of 0.02 kg was taken for 0.0005 kg, all said to have converged."""
    measured, frfs = hit_beam(CANTILEVER, effect, **{name: true})
    names = [effect, "E"] if effect == "sensor_mass" else [effect]
    result = update_frfs(Case("c", CANTILEVER, measured), frfs, parameters=names, lines=40)
    assert found(result)[effect][0] == pytest.approx(true, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize(
    "stages",
    [
        [["alpha", "sensor_mass", "root.E"], ["middle.E", "tip.E", "beta"]],
    ],
)
def test_stages_in_any_order_end_in_one_place(stages: list[list[str]]) -> None:
    factors = {"root": 0.7, "middle": 1.4, "tip": 0.8}
    measured, frfs = hit_beam(clamped(factors), "sensor_mass", mass=0.02)
    case = Case("c", clamped(dict.fromkeys(factors, 1.0)), measured)
    result = update_frfs(case, frfs, stages=stages, lines=30)
    got = found(result)
    assert result.converged
    assert max(result.discrepancy) < 0.01
    assert got["sensor_mass"][0] == pytest.approx(0.02, rel=2e-3)
    for name, factor in factors.items():
        assert got[f"{name}.E"][0] == pytest.approx(210e9 * factor, rel=5e-3)


@pytest.mark.long
@pytest.mark.parametrize(
    ("factor", "message"),
    [(2.0, "times the level"), (-1.0, "the opposite sign")],
)
def test_one_bad_channel_is_named_and_left_out(factor: float, message: str) -> None:
    """All parameters were four to eight standard deviations off, and no channel was named."""
    measured, frfs = taken(beam(TRUTH))
    values = frfs.values.copy()
    values[6] *= factor
    case = Case("tape", beam(START), measured)
    result = update_frfs(case, replace(frfs, values=values), stages=[STRUCTURE, DAMPING], lines=40)
    assert [message in w and "node 7 by the force at node 4" in w for w in result.warnings] == [True]
    for p in result.parameters:
        assert p.value == pytest.approx(wanted(p.name), abs=4 * p.sigma)
    assert len(result.frac) == 11


@pytest.mark.long
def test_good_channels_are_all_kept() -> None:
    measured, frfs = taken(beam(TRUTH), noise=2e-2)
    result = update_frfs(Case("tape", beam(START), measured), frfs, stages=[STRUCTURE, DAMPING], lines=60)
    assert not any("left out" in w for w in result.warnings)


@pytest.mark.long
def test_the_order_of_frfs_and_their_precision_do_not_matter() -> None:
    measured, frfs = taken(beam(TRUTH))
    case, mixed = Case("tape", beam(START), measured), np.random.default_rng(1).permutation(11)
    single = replace(frfs, values=frfs.values.astype(np.complex64).astype(complex)).select(mixed)
    first, second = (update_frfs(case, f, parameters=STRUCTURE, lines=40) for f in (frfs, single))
    for p, q in zip(first.parameters, second.parameters, strict=True):
        assert q.value == pytest.approx(p.value, abs=0.05 * p.sigma)


def test_moved_resonances_are_those_of_a_stiffer_structure() -> None:
    """All frequencies 1 % up are a modulus 2.01 % up, where no damping goes with the stiffness."""
    spec = replace(CANTILEVER, damping=Damping(alpha=2.0))
    measured, frfs = hit_beam(spec)
    predictor, ends, s = Predictor(spec, measured), columns(frfs), frfs.laplace[frfs.frequency < 300]
    here = evaluate(predictor, NOMINAL, ends, s)
    stiffer = evaluate(predictor, State(factors={"E": 1.01**2}), ends, s)
    moved = shifted(here, ends, np.full(len(resonances(here)), 0.01)).sum(axis=0)
    change = stiffer.receptance - here.receptance
    assert np.linalg.norm(moved - change) < 2e-3 * np.linalg.norm(change)


@pytest.mark.long
def test_the_scatter_of_mountings_is_in_the_standard_deviations() -> None:
    """A modulus goes as the square of frequencies: its sigma is no less than twice their scatter over sqrt(modes)."""
    sigmas = []
    for repeatability in (0.0, 2e-3):
        measured, frfs = hit_beam(CANTILEVER, repeatability=repeatability)
        result = update_frfs(Case("c", CANTILEVER, measured), frfs, parameters=["E"])
        sigmas.append(found(result)["E"][1] / 210e9)
    assert sigmas[0] < 1e-4
    assert 2 * 2e-3 / np.sqrt(5) * 0.99 < sigmas[1] < 2 * 2e-3
