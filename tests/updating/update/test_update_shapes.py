"""Shapes as data: their sensitivities, and what they add."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import StudyError
from updating import Case, Material, Measured, PointMass, Region, Spec, Tolerances, build_structure
from updating.update import bootstrap, update
from updating.update.building import build_specimen
from updating.update.run import fit

STEEL = Material(210e9, 7850.0, 0.3)
PARTS = (Region("root", (0.0, 0.1)), Region("middle", (0.1, 0.3)), Region("tip", (0.3, 0.4)))
BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(16,),
    clamped=(),
    theory="euler-bernoulli",
    material=STEEL,
    regions=PARTS,
)
POINTS = np.linspace(0.0, 0.4, 9)[:, None]
COUNT = 5


def measured_on(spec: Spec, points: np.ndarray = POINTS) -> Measured:
    structure = build_structure(spec)
    values, vectors = structure.eigen(2 + COUNT)
    shape = np.asarray(structure.rows(points)["w"] @ vectors[:, 2:])
    constants = shape * shape[-1]
    f = np.sqrt(values[2:]) / (2 * np.pi)
    nothing = np.full(COUNT, np.nan)
    size = 1e-3 * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    return Measured(
        frequency=f, frequency_sigma=1e-4 * f, damping=nothing, damping_sigma=nothing, points=POINTS,
        nodes=tuple(range(1, 10)), seen=np.full(9, 8), hit=np.arange(9), constants=constants,
        constants_sigma=size, absolute=True, position_sigma=0.0,
    )  # fmt: skip


def turned(**factors: float) -> Spec:
    regions = tuple(replace(r, E=factors.get(r.name, 1.0) * 210e9) for r in PARTS)
    return replace(BEAM, regions=regions)


def case_of(measured: Measured) -> Case:
    return Case("bar", BEAM, measured, baseline=None, tolerances=Tolerances({"E": 0.3, "density": 0.3}))


@pytest.mark.parametrize("name", ["root", "middle", "tip"])
def test_slopes_of_constants_are_those_of_rebuilt_models(name: str) -> None:
    specimen = build_specimen(case_of(measured_on(BEAM)), [f"{name}.E"], lean=True)
    at, step = 1.2, 1e-4
    slopes = specimen.shape_slopes([at], specimen.evaluate([at]))[:, :, 0]
    ends = [measured_on(turned(**{name: at * np.exp(s)})).constants for s in (-step, step)]
    assert slopes == pytest.approx((ends[1] - ends[0]) / (2 * step), abs=2e-4 * np.abs(ends[0]).max())


@pytest.mark.parametrize("level", ["shapes", "constants"])
def test_linear_problem_is_the_derivative_of_its_residual(level: str) -> None:
    fitted = fit(
        case_of(measured_on(turned(root=0.8))), parameters=["root.E", "tip.E"], data=("frequencies", level)
    )
    system, step = fitted.system, 1e-5
    theta = np.array([-0.1, 0.05])
    linear = system.linear(theta, system.evaluations(theta))
    cost = [
        [
            system.cost(
                theta + sign * step * np.eye(2)[i], system.evaluations(theta + sign * step * np.eye(2)[i])
            )
            for sign in (-1, 1)
        ]
        for i in range(2)
    ]
    slope = np.array([(high - low) / (2 * step) for low, high in cost])
    # the gradient of the cost is exact, whatever Kaufman leaves out of the sensitivities themselves
    expected = -2 * linear.sensitivity.T @ (linear.weight * linear.residual) + 2 * system.prior * theta
    assert slope == pytest.approx(expected, rel=1e-4)


def test_shapes_tell_a_beam_from_its_mirror_image() -> None:
    truth = measured_on(turned(root=0.7, tip=1.3))
    other = measured_on(turned(root=1.3, tip=0.7))
    assert truth.frequency == pytest.approx(other.frequency, rel=1e-9)  # frequencies cannot tell
    names = ["root.E", "middle.E", "tip.E"]
    result = update(case_of(truth), parameters=names, data=("frequencies", "shapes"))
    assert [p.factor for p in result.parameters] == pytest.approx([0.7, 1.0, 1.3], rel=2e-3)
    assert result.undetermined == ()


@pytest.mark.long
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


def heavier(spec: Spec, modulus: float, density: float) -> Spec:
    return replace(spec, material=Material(modulus * 210e9, density * 7850.0, 0.3), regions=())


def test_modulus_and_density_come_apart_by_constants_as_far_as_the_calibration_goes() -> None:
    plain, calibration = replace(BEAM, regions=()), 0.02
    truth = measured_on(heavier(BEAM, 1.15, 0.8))
    names = ["E", "density"]
    case = Case(
        "bar",
        plain,
        replace(truth, calibration=calibration),
        baseline=None,
        tolerances=Tolerances({"E": 0.3, "density": 0.3}),
    )
    alone = update(case, parameters=names, data=("frequencies", "shapes"))
    assert set(alone.undetermined) == set(names)
    both = update(case, parameters=names, data=("frequencies", "constants"))
    assert both.undetermined == ()
    assert [p.factor for p in both.parameters] == pytest.approx([1.15, 0.8], rel=2e-3)
    # constants go with the inverse of the mass: its doubt is the calibration's, and the modulus follows by the ratio
    assert [p.sigma / p.value for p in both.parameters] == pytest.approx([calibration] * 2, rel=0.02)


@pytest.mark.parametrize("error", [-0.05, 0.03])
def test_an_error_of_the_calibration_goes_to_the_mass_in_full(error: float) -> None:
    truth = measured_on(heavier(BEAM, 1.0, 1.0))
    off = replace(truth, constants=(1 + error) * truth.constants, calibration=0.02)
    case = Case(
        "bar",
        replace(BEAM, regions=()),
        off,
        baseline=None,
        tolerances=Tolerances({"E": 3.0, "density": 3.0}),
    )
    result = update(case, parameters=["E", "density"], data=("frequencies", "constants"))
    assert [p.factor for p in result.parameters] == pytest.approx([1 / (1 + error)] * 2, rel=1e-3)
    pull = np.log(result.parameters[1].factor or np.nan) / (
        result.parameters[1].sigma / result.parameters[1].value
    )
    assert pull == pytest.approx(-np.log(1 + error) / 0.02, rel=0.03)


@pytest.mark.parametrize("name", ["length", "sensor_mass", "root.E"])
@pytest.mark.parametrize("level", ["shapes", "constants"])
def test_effects_are_found_by_shapes_and_constants(name: str, level: str) -> None:
    spec = replace(BEAM, masses=(PointMass((0.4,), 0.0),))
    moved = {
        "length": replace(spec, length=0.41, masses=(PointMass((0.41,), 0.0),)),
        "sensor_mass": replace(spec, masses=(PointMass((0.4,), 0.01),)),
        "root.E": replace(spec, regions=(replace(PARTS[0], E=0.8 * 210e9), *PARTS[1:])),
    }[name]
    shift = 0.005 if name == "length" else 0.0  # a free beam grows at both ends
    truth = measured_on(replace(moved, regions=moved.regions if name == "root.E" else ()), POINTS + shift)
    case = Case(
        "bar",
        replace(spec, regions=PARTS if name == "root.E" else ()),
        truth,
        baseline=None,
        tolerances=Tolerances({"E": 0.3}),
    )
    names = (
        [name] if name != "root.E" else ["root.E", "length"]
    )  # beside an effect, everything goes by differences
    result = update(case, parameters=names, data=("frequencies", level))
    found = result.parameters[0].factor if name == "root.E" else result.parameters[0].value
    assert found == pytest.approx({"length": 0.01, "sensor_mass": 0.01, "root.E": 0.8}[name], rel=0.01)


@pytest.mark.parametrize("name", ["E", "length", "sensor_mass"])
def test_differences_of_constants_are_those_of_rebuilt_models(name: str) -> None:
    spec = replace(BEAM, regions=(), masses=(PointMass((0.4,), 0.0),))
    case = Case("bar", spec, measured_on(spec), baseline=None, tolerances=Tolerances({"E": 0.3}))
    names = list(dict.fromkeys([name, "length"]))
    specimen = build_specimen(case, names, lean=True)
    at = {"E": 1.1, "length": 0.0, "sensor_mass": 0.008}[name]
    values = [at, 0.0][: len(names)]
    slopes = specimen.shape_slopes(values, specimen.evaluate(values))[:, :, 0]
    step = {"E": 1e-3, "length": 1e-4, "sensor_mass": 1e-5}[name]

    def rebuilt(value: float) -> np.ndarray:
        if name == "E":
            return measured_on(heavier(spec, value, 1.0)).constants
        if name == "length":
            longer = replace(spec, length=0.4 + value, masses=(PointMass((0.4 + value,), 0.0),))
            return measured_on(longer, POINTS + value / 2).constants
        return measured_on(replace(spec, masses=(PointMass((0.4,), value),))).constants

    ends = [rebuilt(at * np.exp(s) if name == "E" else at + s) for s in (-step, step)]
    expected = (ends[1] - ends[0]) / (2 * step)
    size = np.abs(expected).max() + np.abs(ends[0]).max()
    assert slopes == pytest.approx(expected, abs=2e-3 * size)


def test_constants_need_a_level() -> None:
    case = case_of(replace(measured_on(BEAM), absolute=False))
    with pytest.raises(StudyError, match="not their level"):
        update(case, parameters=["root.E"], data=("frequencies", "constants"))


def as_shapes(test: Measured) -> Measured:
    """Return the mass-normalised shapes behind constants whose reference is the last point, with any signs."""
    shapes = test.constants / np.sqrt(test.constants[-1]) * np.array([1, -1, -1, 1, -1])
    size = 1e-3 * np.sqrt(np.mean(shapes**2, axis=0)) * np.ones_like(shapes)
    return replace(
        test,
        constants=shapes,
        constants_sigma=size,
        seen=np.arange(len(shapes)),
        hit=np.full(len(shapes), -1),
    )


@pytest.mark.parametrize("extra", [[], ["sensor_mass"]])
def test_mass_normalised_shapes_tell_modulus_from_density_as_constants_do(extra: list[str]) -> None:
    calibration = 0.02
    truth = replace(as_shapes(measured_on(heavier(BEAM, 1.15, 0.8))), calibration=calibration)
    plain = replace(BEAM, regions=(), masses=(PointMass((0.4,), 0.0),))
    doubts = Tolerances({"E": 0.3, "density": 0.3})
    result = update(
        Case("bar", plain, truth, baseline=None, tolerances=doubts),
        parameters=["E", "density", *extra],
        data=("frequencies", "constants"),
    )
    assert [p.factor for p in result.parameters[:2]] == pytest.approx([1.15, 0.8], rel=2e-3)
    assert [p.sigma / p.value for p in result.parameters[:2]] == pytest.approx([calibration] * 2, rel=0.1)


def test_the_slopes_of_mass_normalised_shapes_are_those_of_their_residual() -> None:
    truth = as_shapes(measured_on(turned(root=0.8)))
    fitted = fit(case_of(truth), parameters=["root.E", "tip.E"], data=("frequencies", "constants"))
    system, step = fitted.system, 1e-5
    theta = np.array([-0.1, 0.05])
    linear = system.linear(theta, system.evaluations(theta))
    ends = [
        [system.cost(theta + s * e, system.evaluations(theta + s * e)) for s in (-step, step)]
        for e in np.eye(2)
    ]
    slope = np.array([(high - low) / (2 * step) for low, high in ends])
    expected = -2 * linear.sensitivity.T @ (linear.weight * linear.residual) + 2 * system.prior * theta
    assert slope == pytest.approx(expected, rel=1e-4)
