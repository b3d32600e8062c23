"""Localisation: how often is the region that has lost stiffness found, by each method?

python benchmarks/bench_localisation.py                     a beam, one of ten zones loses 15 to 60 %, 300 specimens
python benchmarks/bench_localisation.py --loss 0.05 0.15    less
python benchmarks/bench_localisation.py --kind mass         it has gained 15 to 60 % of mass; or damping
python benchmarks/bench_localisation.py --plate             a plate of 5 x 3 zones
python benchmarks/bench_localisation.py --exact             no tolerances: the rest of the model is as built

The cantilever has five points, one sensor at its tip, and five modes (the plate fifteen points and eight modes). The
truth is a finer mesh with properties off by their tolerances (E 1 %, density 0.3 %, thickness 0.5 %, length and width
0.2 %); frequencies are scattered by 0.1 %, damping by 5 %, modal constants by 1 % of their r.m.s., level by 2 %, and
damping from mode to mode by 20 %. Intervals are 95 % binomial ones (Clopper and Pearson).
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np
from scipy.stats import beta

from updating import Case, Damping, Material, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.localisation import METHODS, Kind
from updating.localisation.force_residual import region_parts
from updating.models.state import Loss, State

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam",
    length=0.376,
    width=0.0305,
    thickness=0.0047625,
    elements=(20,),
    clamped=("x0",),
    theory="timoshenko",
    material=STEEL,
    damping=Damping(2.0, 1e-6),
)
PLATE = Spec(
    "plate",
    length=0.376,
    width=0.2,
    thickness=0.003175,
    elements=(10, 6),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
    damping=Damping(2.0, 1e-6),
)
DOUBTS = {"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002}
NOISE = {"frequency": 1e-3, "damping": 0.05, "constants": 0.01, "level": 0.02}
SCATTER = 0.2  # of damping from mode to mode


def layout(spec: Spec) -> np.ndarray:
    """Test points: five along a beam, five by three on a plate [m]."""
    x = spec.length * np.linspace(0.2, 1.0, 5)
    if spec.kind == "beam":
        return x[:, None]
    across = np.meshgrid(x, spec.width * np.array([0.0, 0.4, 1.0]), indexing="ij")
    return np.stack([a.ravel() for a in across], axis=1)


def asked(spec: Spec, modes: int) -> Measured:
    """A test that only says where to look."""
    points = layout(spec)
    n, ones = len(points), np.ones(modes)
    every = np.ones((n, modes))
    return Measured(
        frequency=ones, frequency_sigma=ones, damping=ones, damping_sigma=ones, points=points,
        nodes=tuple(range(1, n + 1)), seen=np.full(n, n - 1), hit=np.arange(n), constants=every,
        constants_sigma=every, absolute=True,
    )  # fmt: skip


def truth(spec: Spec, modes: int) -> Predictor:
    """The specimen, on a mesh three times as fine."""
    finer = spec.with_elements(*(3 * n for n in spec.elements))
    return Predictor(finer, asked(spec, modes))


class Trial:
    """One specimen after another, each with one region changed."""

    def __init__(self, spec: Spec, modes: int, kind: Kind, *, exact: bool) -> None:
        self.spec, self.modes, self.kind, self.exact = spec, modes, kind, exact
        self.specimen = truth(spec, modes)

    def changed(self, region: int, size: float) -> State:
        """A region that has lost stiffness, gained mass, or damps as much more of its stiffness."""
        if self.kind == "stiffness":
            return State(regional={(region, "E"): 1 - size})
        if self.kind == "mass":
            return State(regional={(region, "density"): 1 + size})
        problem = pose(self.case(self.measure(State(), np.random.default_rng(0))))[0]
        stiffness = region_parts(replace(problem, predictor=self.specimen), "stiffness")[region]
        whole = np.zeros((self.specimen.reduced.basis.shape[1],) * 2)
        whole[: len(stiffness), : len(stiffness)] = stiffness
        return State(losses=(Loss(0.1 * size * whole, -1.0),))

    def measure(self, state: State, rng: np.random.Generator) -> Measured:
        """A test with honest noise."""
        off = {} if self.exact else {n: float(np.exp(s * rng.standard_normal())) for n, s in DOUBTS.items()}
        found = self.specimen.predict(state.plus(State(factors=off)), count=self.modes)
        drawn = {n: rng.standard_normal(self.modes) for n in ("frequency", "damping", "scatter")}
        sigma = (
            NOISE["constants"] * np.sqrt(np.mean(found.constants**2, axis=0)) * np.ones_like(found.constants)
        )
        level = np.exp(NOISE["level"] * rng.standard_normal())
        ratio = found.damping * np.exp(NOISE["damping"] * drawn["damping"] + SCATTER * drawn["scatter"])
        return replace(
            asked(self.spec, self.modes),
            frequency=found.frequency * np.exp(NOISE["frequency"] * drawn["frequency"]),
            frequency_sigma=NOISE["frequency"] * found.frequency,
            damping=ratio,
            damping_sigma=NOISE["damping"] * ratio,
            constants=level * found.constants + sigma * rng.standard_normal(sigma.shape),
            constants_sigma=sigma,
        )

    def case(self, measured: Measured) -> Case:
        """The test beside the model."""
        return Case("specimen", self.spec, measured, tolerances=Tolerances(DOUBTS))


def interval(hits: int, count: int) -> tuple[float, float]:
    """95 % interval of a share [%]."""
    low = beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
    high = beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
    return 100 * float(low), 100 * float(high)


def main() -> None:
    """Run the trials and print one line for each method."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=int, default=300)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--loss", type=float, nargs=2, default=(0.15, 0.6))
    parser.add_argument("--kind", choices=("stiffness", "mass", "damping"), default="stiffness")
    parser.add_argument("--plate", action="store_true")
    parser.add_argument("--exact", action="store_true")
    options = parser.parse_args()
    spec, modes = (PLATE, 8) if options.plate else (BEAM, 5)
    trial = Trial(spec, modes, options.kind, exact=options.exact)
    ranks: dict[str, list[int]] = {}
    seconds: dict[str, float] = {}
    for seed in range(options.first, options.first + options.seeds):
        rng = np.random.default_rng(seed)
        region = int(rng.integers(len(spec.regions)))
        state = trial.changed(region, rng.uniform(*options.loss))
        problem = pose(trial.case(trial.measure(state, rng)))[0]
        problem.predictor.reduced, problem.nominal  # noqa: B018  what all methods share
        for name, method in METHODS.items():
            if method.obstacle(problem, kind=options.kind) is not None:
                continue
            start = time.process_time()
            scores = method.scores(problem, kind=options.kind)
            seconds[name] = seconds.get(name, 0.0) + time.process_time() - start
            ranks.setdefault(name, []).append(int(np.sum(scores > scores[region])))
    what = f"{options.kind}, {100 * options.loss[0]:.0f} to {100 * options.loss[1]:.0f} %"
    print(f"{options.seeds} specimens, one of {len(spec.regions)} zones changed: {what}")
    print(f"{'method':16} {'top-1':>7} {'95 % interval':>16} {'top-2':>7} {'ms':>7}")
    for name, found in ranks.items():
        first, second = (sum(r <= n for r in found) for n in (0, 1))
        low, high = interval(first, len(found))
        share = f"{100 * first / len(found):5.1f} % [{low:5.1f}, {high:5.1f}] %"
        print(
            f"{name:16} {share:>25} {100 * second / len(found):5.1f} % {1e3 * seconds[name] / len(found):7.1f}"
        )


if __name__ == "__main__":
    main()
