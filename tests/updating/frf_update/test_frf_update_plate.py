"""Updating a plate by FRFs: regions far off come back, and the basis at the end says what the full model says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from updating_cases import blank

from updating import Case, Damping, Material, Measured, Predictor, Region, Spec
from updating.frf_update.run import solve_stages
from updating.test_data.measured_frfs import MeasuredFrfs

STEEL = Material(210e9, 7850.0, 0.3)
POINTS = np.array([(x, y) for x in (0.1, 0.2, 0.3, 0.376) for y in (0.0, 0.1, 0.2)])
FACTORS = {"root": 0.7, "left": 1.4, "right": 0.75, "tip": 1.25}
SPANS = {
    "root": ((0.0, 0.15), (0.0, 0.2)),
    "left": ((0.15, 0.27), (0.0, 0.1)),
    "right": ((0.15, 0.27), (0.1, 0.2)),
    "tip": ((0.27, 0.376), (0.0, 0.2)),
}


def plate(factors: dict[str, float]) -> Spec:
    regions = tuple(Region(name, *SPANS[name], E=210e9 * f) for name, f in factors.items())
    damping = Damping(alpha=1.0, beta=5e-7)
    return Spec(
        "plate",
        length=0.376,
        width=0.2,
        thickness=0.003175,
        elements=(10, 6),
        clamped=("x0",),
        theory="kirchhoff",
        material=STEEL,
        regions=regions,
        damping=damping,
    )


def measured() -> tuple[Measured, MeasuredFrfs]:
    there = Predictor(plate(FACTORS), blank(POINTS, top=500.0))
    modes = there.predict(count=6)
    test = replace(
        there.measured,
        frequency=modes.frequency,
        frequency_sigma=1e-4 * modes.frequency,
        damping=modes.damping,
        damping_sigma=1e-2 * modes.damping,
        constants=modes.constants,
        constants_sigma=np.full(modes.constants.shape, 1e-3),
        calibration=1e-4,
    )
    s = 2j * np.pi * np.arange(8.0, 480.0, 2.0)
    h = there.receptance(s)
    sigma = 1e-3 * np.sqrt(np.mean(np.abs(h * s**2) ** 2, axis=1, keepdims=True)) / np.abs(s**2)
    noise = np.random.default_rng(3).standard_normal((2, *h.shape)) / np.sqrt(2)
    return test, MeasuredFrfs(
        s, h + sigma * (noise[0] + 1j * noise[1]), sigma**2 + 0 * h.real, test.seen, test.hit
    )


@pytest.mark.long
def test_regions_a_third_off_come_back_and_the_full_model_agrees() -> None:
    test, frfs = measured()
    case = Case("plate", plate(dict.fromkeys(FACTORS, 1.0)), test)
    _, _, steps = solve_stages(case, frfs, [f"{name}.E" for name in FACTORS], None, 40)
    last = steps[-1]
    values = last.stage.values(last.solved.theta)
    assert values == pytest.approx(list(FACTORS.values()), rel=2e-3)
    predictor, s = last.stage.predictor, frfs.laplace[::60]
    structure = predictor.reduced.structure
    stiffness, mass = structure.matrices(last.state)
    free = structure.free()
    dynamic = [(x**2 * mass + x * (1.0 * mass + 5e-7 * stiffness) + stiffness)[free][:, free] for x in s]
    rows = structure.rows(POINTS, None)["w"].toarray()[:, free]
    load = rows[test.seen[0]].astype(complex)
    full = np.stack([rows[test.hit] @ spsolve(z.tocsc(), load) for z in dynamic], axis=1)
    found = predictor.receptance(s, last.state)
    assert np.abs(found - full).max() < 1e-4 * np.abs(full).max()
    before = Predictor(case.spec, test).receptance(s, last.state)
    assert np.abs(before - full).max() > np.abs(found - full).max()
