"""Sensitivities of the update (Eqs. 16, 17) against finite differences of freshly built full models."""

from dataclasses import replace

import numpy as np
import pytest

from updating import Case, Material, Measured, Region, Spec, build_structure
from updating.update.building import build_specimen

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam", length=0.4, width=0.03, thickness=0.005, elements=(12,), clamped=("x0",), theory="timoshenko",
    material=STEEL, regions=(Region("root", (0.0, 0.1)), Region("tip", (0.3, 0.4), density=7000.0)),
)  # fmt: skip
PLATE = Spec(
    "plate", length=0.4, width=0.2, thickness=0.004, elements=(10, 6), clamped=("x0",), theory="kirchhoff",
    material=STEEL, regions=(Region("root", (0.0, 0.1)), Region("corner", (0.2, 0.4), (0.1, 0.2))),
)  # fmt: skip


def frequencies(spec: Spec, count: int) -> np.ndarray:
    return np.sqrt(build_structure(spec).eigen(count)[0]) / (2 * np.pi)


def case_of(spec: Spec, count: int = 5) -> Case:
    f = frequencies(spec, count)
    nothing = np.full(count, np.nan)
    measured = Measured(
        frequency=f, frequency_sigma=1e-4 * f, damping=nothing, damping_sigma=nothing,
        points=np.zeros((0, len(spec.elements))), nodes=(), seen=np.zeros(0, dtype=int),
        hit=np.zeros(0, dtype=int), constants=np.zeros((0, count)), constants_sigma=np.zeros((0, count)),
        absolute=False,
    )  # fmt: skip
    return Case("test", spec, measured)


def scaled(spec: Spec, name: str, factor: float) -> Spec:
    """Return another model, in which a property of the whole or of a region is scaled."""
    head, _, tail = name.partition(".")
    if not tail:
        if head in ("E", "density"):
            own = {"E": spec.material.E, "density": spec.material.density}[head] * factor
            regions = tuple(
                r if getattr(r, head) is None else replace(r, **{head: getattr(r, head) * factor})
                for r in spec.regions
            )
            return replace(spec, material=replace(spec.material, **{head: own}), regions=regions)
        return replace(spec, **{head: getattr(spec, head) * factor})
    general = {"E": spec.material.E, "density": spec.material.density, "thickness": spec.thickness}[tail]
    return replace(
        spec,
        regions=tuple(
            replace(r, **{tail: factor * (getattr(r, tail) or general)}) if r.name == head else r
            for r in spec.regions
        ),
    )


def differences(spec: Spec, name: str, at: float, step: float) -> np.ndarray:
    ends = [frequencies(scaled(spec, name, at * np.exp(s)), 5) for s in (-step, step)]
    return np.asarray((np.log(ends[1]) - np.log(ends[0])) / (2 * step))


@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
@pytest.mark.parametrize("name", ["E", "density", "thickness"])
@pytest.mark.parametrize("at", [1.0, 1.3])
def test_sensitivities_to_the_whole_are_those_of_rebuilt_models(spec: Spec, name: str, at: float) -> None:
    specimen = build_specimen(case_of(replace(spec, regions=())), [name], lean=True)
    slope = specimen.slopes([at], specimen.evaluate([at]))[:, 0]
    assert slope == pytest.approx(differences(replace(spec, regions=()), name, at, 3e-3), abs=1e-5)


@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
@pytest.mark.parametrize("name", ["width", "root.E", "root.thickness", "last.density"])
def test_sensitivities_on_the_nominal_model_are_exact(spec: Spec, name: str) -> None:
    name = name.replace("last", spec.regions[1].name)
    specimen = build_specimen(case_of(spec), [name], lean=True)
    slope = specimen.slopes([1.0], specimen.evaluate([1.0]))[:, 0]
    assert slope == pytest.approx(differences(spec, name, 1.0, 3e-3), abs=2e-5)


@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
@pytest.mark.parametrize("name", ["root.E", "root.thickness", "last.density"])
def test_sensitivities_to_regions_stay_good_on_the_reduced_basis(spec: Spec, name: str) -> None:
    name = name.replace("last", spec.regions[1].name)
    specimen = build_specimen(case_of(spec), [name], lean=True)
    slope = specimen.slopes([1.3], specimen.evaluate([1.3]))[:, 0]
    assert slope == pytest.approx(differences(spec, name, 1.3, 3e-3), abs=3e-3)


@pytest.mark.parametrize(
    "spec", [replace(BEAM, regions=()), replace(PLATE, regions=())], ids=["beam", "plate"]
)
def test_length_sensitivity_is_per_metre_of_extension(spec: Spec) -> None:
    specimen = build_specimen(case_of(spec), ["length"], lean=True)
    extension, step = 0.012, 1e-3
    slope = specimen.slopes([extension], specimen.evaluate([extension]))[:, 0]
    ends = [
        frequencies(replace(spec, length=spec.length + extension + s, regions=()), 5) for s in (-step, step)
    ]
    assert slope == pytest.approx((np.log(ends[1]) - np.log(ends[0])) / (2 * step), rel=1e-3)


def test_regional_changes_of_one_region_multiply() -> None:
    specimen = build_specimen(case_of(BEAM), ["root.E", "root.thickness"], lean=True)
    both = scaled(scaled(BEAM, "root.E", 1.2), "root.thickness", 1.1)
    assert specimen.evaluate([1.2, 1.1]).frequency == pytest.approx(frequencies(both, 5), rel=1e-5)
