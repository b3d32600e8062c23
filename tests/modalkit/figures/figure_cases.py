"""Tests, models and diagnoses to draw."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd

from acquisition import Dof, FrfSet, Geometry, HammerTest, Hits, HitVerdict
from identification import ModalModel, identify
from updating import Case, Diagnosis, Material, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.answer.closing import Closed, Shrink
from updating.diagnosis.answer.located import Where, Zone
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked
from updating.diagnosis.answer.result import Gap, NextTest
from updating.models.state import State


@cache
def model_of(modes: int, *, points: int = 5) -> ModalModel:
    """Identify analytic FRFs of a row of points, no two modes closer than the spacing of the axis allows."""
    frequency = np.linspace(40.0, 40.0 + 45.0 * modes, modes)
    x = np.linspace(0.1, 1.0, points)
    shapes = np.sin(np.outer(x, 2.6 * np.arange(1, modes + 1)))
    line = np.arange(0.0, frequency[-1] + 60.0, 0.5)
    s = 2j * np.pi * line
    w = 2 * np.pi * frequency
    h = np.zeros((points, len(line)), dtype=complex)
    for r in range(modes):
        h += np.outer(shapes[:, r] * shapes[-1, r], s**2 / (s**2 + 2 * 0.005 * w[r] * s + w[r] ** 2))
    noise = np.random.default_rng(1).standard_normal((2, *h.shape))
    h += 1e-3 * (noise[0] + 1j * noise[1])
    dofs = tuple(Dof(i + 1, 3) for i in range(points))
    place = Geometry(tuple(range(1, points + 1)), np.c_[x, 0 * x, 0 * x])
    frfs = FrfSet(
        line,
        h,
        dofs,
        (dofs[-1],) * points,
        coherence=np.full(h.shape, 0.98),
        averages=np.full(points, 4),
        geometry=place,
    )
    return identify(frfs, band=(15.0, float(line[-1])))


def hammered(points: int, hits: int) -> HammerTest:
    rng = np.random.default_rng(3)
    time = np.arange(1024) / 4096
    pulse = np.where((time > 0.01) & (time < 0.012), np.sin(np.pi * (time - 0.01) / 0.002) ** 2, 0.0)
    rows = []
    for i in range(points):
        force = pulse * rng.uniform(50, 150, (hits, 1)) + 0.05 * rng.standard_normal((hits, 1024))
        rows.append(Hits(Dof(i + 1, 3), (Dof(1, 3),), force, rng.standard_normal((hits, 1, 1024))))
    return HammerTest(4096.0, tuple(rows))


def verdicts_of(test: HammerTest, bad: set[tuple[int, int]]) -> list[HitVerdict]:
    return [
        HitVerdict(
            point=point.reference,
            hit=hit,
            used=(point.reference.node, hit) not in bad,
            reasons=("double hit: a second pulse of 43 % after 5.1 ms",)
            if (point.reference.node, hit) in bad
            else (),
            peak=float(point.force[hit - 1].max()),
            width=2e-3,
            band10=600.0,
            band20=900.0,
        )
        for point in test.points
        for hit in range(1, point.count + 1)
    ]


def spec_of(kind: str) -> Spec:
    steel = Material(210e9, 7850.0)
    if kind == "beam":
        return Spec(
            "beam",
            length=0.4,
            width=0.03,
            thickness=0.005,
            elements=(24,),
            clamped=("x0",),
            theory="euler-bernoulli",
            material=steel,
        )
    return Spec(
        "plate",
        length=0.4,
        width=0.25,
        thickness=0.003,
        elements=(12, 8),
        clamped=("x0",),
        theory="kirchhoff",
        material=steel,
    )


def case_of(kind: str, *, modes: int = 5, factor: float = 1.0) -> Case:
    """A test whose modulus is ``factor`` times the model's, measured without error."""
    spec = spec_of(kind)
    if kind == "beam":
        points = np.linspace(0.08, 0.4, 8)[:, None]
    else:
        points = np.stack(np.meshgrid(np.linspace(0.1, 0.4, 5), [0.0, 0.08, 0.17, 0.25]), axis=-1).reshape(
            -1, 2
        )
    n = len(points)
    blank = Measured(
        frequency=np.linspace(20, 900, modes),
        frequency_sigma=np.ones(modes),
        damping=np.full(modes, np.nan),
        damping_sigma=np.full(modes, np.nan),
        points=points,
        nodes=tuple(range(1, n + 1)),
        seen=np.full(n, n - 1),
        hit=np.arange(n),
        constants=np.ones((n, modes)),
        constants_sigma=np.ones((n, modes)),
        absolute=True,
    )
    truth = Predictor(spec, blank).predict(State(factors={"E": factor}), count=modes)
    measured = replace(
        blank,
        frequency=truth.frequency,
        frequency_sigma=1e-4 * truth.frequency,
        constants=truth.constants,
        constants_sigma=0.01 * np.abs(truth.constants).max(axis=0) * np.ones((n, 1)),
    )
    return Case("A case", spec, measured, tolerances=Tolerances({"E": 0.01, "thickness": 0.005}))


EFFECTS = (
    "E",
    "density",
    "length",
    "thickness",
    "clamp_rotation",
    "sensor_mass",
    "local_stiffness",
    "fluid_added_mass",
)
PLACES = {"clamp_rotation", "sensor_mass", "local_stiffness"}


def ranking_of(first: str) -> tuple[Ranked, ...]:
    """Every effect, the first one most probable."""
    order = [first, *(e for e in EFFECTS if e != first)]
    share_of = np.array([0.6**i for i in range(len(order))])
    share_of *= 0.98 / share_of.sum()
    estimate = ParameterEstimate(0.0121, "kg", 0.0115, 0.0126, False)
    long = {f"{first}.{n}": replace(estimate, unit="m") for n in ("x", "extent", "loss", "compliance")}
    return tuple(
        Ranked(
            effects=(e,),
            probability=float(p),
            equivalents=(),
            parameters=long if i == 0 and e == "local_stiffness" else {f"{e}.mass": estimate},
            plausible=True,
            p_value=0.4,
        )
        for i, (e, p) in enumerate(zip(order, share_of, strict=True))
    )


def zones_of(spec: Spec) -> tuple[Zone, ...]:
    """The regions of a model, the last one most probable."""
    weights = np.arange(1.0, len(spec.regions) + 1) ** 4
    return tuple(
        Zone(r.name, (sum(r.x) / 2, 0.0 if r.y is None else sum(r.y) / 2, 0.0), float(p))
        for r, p in zip(spec.regions, weights / weights.sum(), strict=True)
    )


def diagnosis_of(
    kind: str,
    *,
    verdict: str = "named",
    first: str = "local_stiffness",
    modes: int = 5,
    place: tuple[float, float, float] | None = (0.13, 0.05, 0.0),
    sets: int = 3,
) -> Diagnosis:
    """A diagnosis made up by hand; the values are those of nothing."""
    ranking = ranking_of(first)
    count = {"named": 1, "class": sets, "unknown": 0, "none": 0}[verdict]
    frequency = np.linspace(20, 1800, modes)
    error = np.linspace(-3, 5, modes)
    table = pd.DataFrame({"test [Hz]": frequency, "error [%]": error, "sigma [%]": np.full(modes, 0.1)})
    zones = zones_of(spec_of(kind))
    if place is not None and kind == "beam":
        place = (place[0], 0.0, 0.0)
    seated = place if verdict != "none" else None
    channel = "none" if verdict == "none" else "stiffness"
    where = Where(
        channel=channel,
        channels={"stiffness": 0.9, "mass": 0.08, "damping": 0.0, "measurement": 0.02, "none": 0.0},
        location=seated,
        locations=() if seated is None else (seated,),
        points=(),
        zones=zones,
    )
    measure = "weigh the specimen and measure its thickness, to 0.1 %"
    return Diagnosis(
        title="A cantilever",
        significant=verdict != "none",
        p_value=0.4 if verdict == "none" else 1e-12,
        gap=Gap(table, 3.2, 0.1, np.ones(3)),
        where=where,
        shrink=Shrink(
            metric="frequency",
            before=3.2,
            after=0.05,
            held_before=3.2,
            held_after=0.07,
            held_runner_up=2.1,
            held_nuisance=2.4,
            floor=0.06,
            closed=Closed(99.0, 95.0, 100.0),
        ),
        verdict=verdict,  # type: ignore[arg-type]
        sets=tuple(r.effects for r in ranking[:count]),
        ranking=ranking,
        next_test=(NextTest(measure, ("E", "density"), 31.0), NextTest(measure, ("E", "thickness"), 12.0))
        if verdict == "class"
        else (),
        warnings=(),
        not_examined={},
    )
