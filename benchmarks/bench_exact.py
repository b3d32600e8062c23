"""Is the model right where there is no noise at all? What of exact data of the rig it leaves, in parts of the noise.

Specimens of blind trials without a hidden effect are tested, and what was measured of frequencies and constants is then
replaced by what the rig moves, to the last digit: once with points and sensor where they really were (*marked*), once
where the study has them (*exact*). Only what the model and its doubts lack is left. Chi-squared should be near nothing
for the exact places, and far below the number of data for the marked ones, whose errors have their nuisances.

    python benchmarks/bench_exact.py --kinds beam frame plate --trials 6 --seed 5501
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from modalkit.blind import DrawRanges, draw_trial, write_trial
from modalkit.simulator.drawing.ranges import KINDS
from modalkit.simulator.scene import Scene
from modalkit.workflow.case import open_study
from updating import Case, Measured
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate


def exactly(test: Measured, scene: Scene) -> Measured | None:
    """Return a test with the frequencies and constants that its specimen has; None where two modes are mistaken."""
    modes = scene.elastic()
    hertz = np.abs(modes.poles) / (2 * np.pi)
    chosen = np.array([np.argmin(np.abs(np.log(hertz / f))) for f in test.frequency])
    if len(set(chosen.tolist())) < len(chosen):
        return None
    points = np.array(scene.setup.points).reshape(len(scene.setup.points), -1)
    ends = test.points[np.where(test.hit < 0, test.seen, test.hit)][:, : points.shape[1]]
    rows = np.linalg.norm(points[:, None] - ends, axis=2).argmin(axis=0)
    found = np.real(modes.residues[rows][:, chosen] * 2j * modes.poles[chosen].imag * scene.chain.gain)
    along = np.sum(found * test.constants, axis=0)
    found = found * (np.sign(along) if test.absolute else along / np.sum(found**2, axis=0))
    return replace(test, constants=found, frequency=hertz[chosen])


def left(case: Case) -> dict[str, tuple[float, int]]:
    """Return chi-squared of what the nominal model leaves and the number of data, of frequencies and of constants."""
    problem, _ = pose(case)
    theories = (False, True) if problem.predictor.spec.fuller else (False,)
    points = [evaluate(problem, Candidate(fuller=fuller), np.zeros(0)) for fuller in theories]
    point = max(points, key=lambda one: one.marginal.log_likelihood)
    off = point.left_over / np.sqrt(point.comparison.noise(point.marginal.scale))
    own = {name: off[point.comparison.of(name)] for name in ("frequency", "frf")}
    return {name: (float(np.sum(values**2)), len(values)) for name, values in own.items()}


def of_kind(kind: str, trials: int, seed: int) -> Iterator[tuple[int, str, dict[str, tuple[float, int]]]]:
    """Yield what is left of each trial: as measured, with its points as marked, and with exact ones."""
    plan = DrawRanges(kinds=(kind,), none=1.0, outside=0.0, pairs=0.0, baseline=0.0)
    for index in range(trials):
        trial = draw_trial(seed, index, plan=plan)
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            case = open_study(write_trial(trial, Path(folder))).case
        scenes = {"marked": trial.scene, "exact": replace(trial.scene, marks=0.0 * trial.scene.marks)}
        yield index, "measured", left(case)
        for name, scene in scenes.items():
            test = exactly(case.measured, scene)
            if test is not None:
                yield index, name, left(replace(case, measured=test))


def main() -> None:
    """Print what is left of every trial."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=["beam", "frame", "plate"])
    parser.add_argument("--trials", type=int, default=6)
    parser.add_argument("--seed", type=int, default=5501)
    arguments = parser.parse_args()
    print("kind      trial  data      frequencies      constants")
    with threadpool_limits(1, user_api="blas"):
        for kind in arguments.kinds:
            for index, name, found in of_kind(kind, arguments.trials, arguments.seed):
                frequency, constants = (
                    f"{found[key][0]:7.1f} / {found[key][1]:3d}" for key in ("frequency", "frf")
                )
                print(f"{kind:9s} {index:5d}  {name:8s} {frequency}    {constants}", flush=True)


if __name__ == "__main__":
    main()
