"""Shapes as data: their sensitivities, and what they add."""

from dataclasses import replace

import numpy as np
import pytest

from updating import Case, Material, Measured, Region, Spec, Tolerances, build_structure
from updating.update import bootstrap, update
from updating.update.building import build_specimen
from updating.update.run import fit

STEEL = Material(210e9, 7850.0, 0.3)
PARTS = (Region("root", (0.0, 0.1)), Region("middle", (0.1, 0.3)), Region("tip", (0.3, 0.4)))
BEAM = Spec("beam", 0.4, 0.03, 0.005, (16,), (), "euler-bernoulli", STEEL, regions=PARTS)
POINTS = np.linspace(0.0, 0.4, 9)[:, None]
COUNT = 5


def measured_on(spec: Spec) -> Measured:
    structure = build_structure(spec)
    values, vectors = structure.eigen(2 + COUNT)
    shape = np.asarray(structure.rows(POINTS)["w"] @ vectors[:, 2:])
    constants = shape * shape[-1]
    f = np.sqrt(values[2:]) / (2 * np.pi)
    nothing = np.full(COUNT, np.nan)
    size = 1e-3 * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    return Measured(
        f, 1e-4 * f, nothing, nothing, POINTS, tuple(range(1, 10)), np.full(9, 8), np.arange(9), constants, size,
        absolute=True, position_sigma=0.0,
    )  # fmt: skip


def turned(**factors: float) -> Spec:
    regions = tuple(replace(r, E=factors.get(r.name, 1.0) * 210e9) for r in PARTS)
    return replace(BEAM, regions=regions)


def case_of(measured: Measured) -> Case:
    return Case("bar", BEAM, measured, None, Tolerances({"E": 0.3, "density": 0.3}))


@pytest.mark.parametrize("name", ["root", "middle", "tip"])
def test_slopes_of_constants_are_those_of_rebuilt_models(name: str) -> None:
    specimen = build_specimen(case_of(measured_on(BEAM)), [f"{name}.E"], lean=True)
    at, step = 1.2, 1e-4
    slopes = specimen.shape_slopes([at], specimen.look([at]))[:, :, 0]
    ends = [measured_on(turned(**{name: at * np.exp(s)})).constants for s in (-step, step)]
    assert slopes == pytest.approx((ends[1] - ends[0]) / (2 * step), abs=2e-4 * np.abs(ends[0]).max())


def test_linear_problem_with_shapes_is_the_derivative_of_its_residual() -> None:
    fitted = fit(
        case_of(measured_on(turned(root=0.8))), parameters=["root.E", "tip.E"], data=("frequencies", "shapes")
    )
    system, step = fitted.system, 1e-5
    theta = np.array([-0.1, 0.05])
    linear = system.linear(theta, system.looks(theta))
    across = linear.sensitivity
    for i in range(2):
        moved = np.eye(2)[i] * step
        ends = [system.residual(system.looks(theta + s * moved)) for s in (-1, 1)]
        difference = -(ends[1] - ends[0]) / (2 * step)
        # the frequencies exactly; the shapes but for the change of their own factor, along the shape
        assert across[:COUNT, i] == pytest.approx(difference[:COUNT], abs=1e-6)
        weight = linear.weight[COUNT:]
        gap = (across[COUNT:, i] - difference[COUNT:]).reshape(9, COUNT)
        shape = linear.looks[0].prediction.constants
        along = np.sum(weight.reshape(9, COUNT) * gap * shape, axis=0) / np.sum(
            weight.reshape(9, COUNT) * shape**2, axis=0
        )
        assert gap - along * shape == pytest.approx(np.zeros_like(gap), abs=1e-5 * np.abs(shape).max())


def test_shapes_tell_a_beam_from_its_mirror_image() -> None:
    truth = measured_on(turned(root=0.7, tip=1.3))
    other = measured_on(turned(root=1.3, tip=0.7))
    assert truth.frequency == pytest.approx(other.frequency, rel=1e-9)  # frequencies cannot tell
    names = ["root.E", "middle.E", "tip.E"]
    result = update(case_of(truth), parameters=names, data=("frequencies", "shapes"))
    assert [p.factor for p in result.parameters] == pytest.approx([0.7, 1.0, 1.3], rel=2e-3)
    assert result.undetermined == ()


def test_draws_of_frequencies_and_shapes_scatter_as_the_update_says() -> None:
    case = case_of(measured_on(turned(root=0.8)))
    result = bootstrap(
        case,
        parameters=["root.E", "tip.E"],
        data=("frequencies", "shapes"),
        n=300,
        rng=np.random.default_rng(2),
    )
    spread = np.std(np.log(result.draws.values), axis=0)
    stated = np.array([p.sigma / p.value for p in result.update.parameters])
    # four standard deviations of a spread from 300 draws
    assert spread == pytest.approx(stated, rel=0.17)
