"""Bootstrap updates: their spread is the one that the covariance states, and hits may be drawn anew."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import (
    Dof,
    Geometry,
    HammerPlan,
    ModalData,
    StudyError,
    estimate_frfs,
    hammer_test,
    modal_system,
)
from identification import identify
from updating import Axes, Case, Material, Region, Spec, Tolerances, build_structure, measured_from_modes
from updating.update import bootstrap, redrawn_frequencies, update

STEEL = Material(210e9, 7850.0, 0.3)
PARTS = (Region("root", (0.0, 0.1)), Region("middle", (0.1, 0.25)), Region("tip", (0.25, 0.4)))
BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(12,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
    regions=PARTS,
)
NAMES = ["root.E", "tip.E"]


def case_of(tolerance: float = 0.3, repeatability: float = 0.0) -> Case:
    spec = replace(BEAM, regions=(replace(PARTS[0], E=0.9 * 210e9), *PARTS[1:]))
    f = np.sqrt(build_structure(spec).eigen(6)[0]) / (2 * np.pi)
    test = measured_from_modes(
        ModalData(frequency=f, frequency_sigma=1e-3 * f), Axes(), BEAM, repeatability=repeatability
    )
    return Case(
        "bar", BEAM, test, baseline=None, tolerances=Tolerances({"E": tolerance, "density": tolerance})
    )


@pytest.mark.long
@pytest.mark.parametrize("names", [NAMES, ["E", "density"]], ids=["determined", "a pair"])
def test_the_spread_of_the_draws_is_the_sigma_of_the_update(names: list[str]) -> None:
    result = bootstrap(case_of(0.05), parameters=names, n=400, rng=np.random.default_rng(3))
    spread = np.std(np.log(result.draws.values), axis=0)
    stated = np.array([p.sigma / p.value for p in result.update.parameters])
    assert spread == pytest.approx(stated, rel=0.15)  # four standard deviations of a spread from 400 draws
    assert result.draws.converged == 400
    for p in result.update.parameters:
        assert p.interval is not None
        assert p.interval[0] < p.value < p.interval[1]


def test_without_draws_the_update_is_that_of_update() -> None:
    plain = update(case_of(), parameters=NAMES)
    drawn = bootstrap(case_of(), parameters=NAMES, n=20, rng=np.random.default_rng(1)).update
    assert [p.value for p in drawn.parameters] == [p.value for p in plain.parameters]
    assert drawn.draws == 20
    assert "95 %" in drawn.report()


def test_given_frequencies_are_used() -> None:
    case = case_of(0.3)
    same = np.tile(case.measured.frequency, (20, 1))
    result = bootstrap(
        case, parameters=NAMES, n=20, frequencies=[same], regularise=False, rng=np.random.default_rng(1)
    )
    assert np.ptp(result.draws.values, axis=0) == pytest.approx(0.0, abs=1e-6)


def test_bad_draws_are_refused() -> None:
    rng = np.random.default_rng(1)
    with pytest.raises(StudyError, match="5 draws"):
        bootstrap(case_of(), parameters=NAMES, n=5, rng=rng)
    with pytest.raises(StudyError, match="shape"):
        bootstrap(case_of(), parameters=NAMES, n=20, frequencies=[np.ones((20, 2))], rng=rng)


def test_hits_drawn_anew_scatter_as_the_identification_says() -> None:
    rng = np.random.default_rng(7)
    dofs = tuple(Dof(i, 3) for i in range(1, 5))
    shapes = rng.standard_normal((4, 3))
    system = modal_system(
        frequency=np.array([40.0, 95.0, 160.0]), damping=np.full(3, 0.01), response_shapes=shapes[-1:],
        point_shapes=shapes, responses=dofs[-1:], points=dofs,
    )  # fmt: skip
    plan = HammerPlan(rate=512.0, samples=1024, hits=12, width=4e-3, decay=2.0, response_noise=0.01)
    geometry = Geometry((1, 2, 3, 4), np.zeros((4, 3)))
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    model = identify(estimate_frfs(test), band=(20.0, 200.0))
    drawn = redrawn_frequencies(model, test, rng=rng, n=60)
    assert drawn.shape == (60, 3)
    spread = np.std(drawn, axis=0)
    assert np.mean(drawn, axis=0) == pytest.approx(model.modal.frequency, abs=float(np.max(spread)))
    # a spread from 12 hits and 60 draws is good to some 25 %, a sigma from 12 hits too
    assert np.all(np.abs(np.log(spread / model.modal.frequency_sigma)) < 0.8)
