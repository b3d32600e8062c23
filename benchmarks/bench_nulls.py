"""Does the noise fit where nothing is hidden? Chi-squared over its expectation, channel by channel.

Blind trials without any hidden effect are measured and identified. The model that knows of nothing is compared with
each, on its own theory or the fuller one, whichever is more likely. Of every channel it says the residuals' chi-squared
under the whole covariance of noise and nuisances, over their number, and its p-value. Where the noise is what it says,
the mean of chi-squared over n is 1 and the p-values are uniform.

    python benchmarks/bench_nulls.py --trials 60 --seed 11 --kinds beam plate --baseline 0.5
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.stats import chi2, kstest
from threadpoolctl import threadpool_limits

from acquisition.errors import ModalkitError
from modalkit.blind import DrawRanges, draw_trial, write_trial
from modalkit.simulator.drawing.ranges import KINDS
from modalkit.workflow.case import open_study
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.goodness import p_value
from updating.diagnosis.search.points import evaluate
from updating.likelihood.comparison import CHANNELS
from updating.likelihood.gaussian import gaussian
from updating.problem.candidate import Candidate

Found = dict[str, tuple[float, int]]
"""Chi-squared and number of data, by channel."""


def of_trial(seed: int, index: int, plan: DrawRanges) -> tuple[str, Found, float]:
    """Measure a trial and compare the model that knows of nothing with it.

    Returns
    -------
    kind : str
        Of the specimen, with or without a baseline.
    found : Found
        Of each channel that has data, and of all together, shapes' noise as the test states it.
    p_value : float
        Of the diagnosis: shapes may be noisier than stated [-].
    """
    trial = draw_trial(seed, index, plan=plan)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = open_study(write_trial(trial, Path(folder))).case
        problem, _ = pose(case)
    theories = (False, True) if problem.predictor.spec.fuller else (False,)
    points = [evaluate(problem, Candidate(fuller=fuller), np.zeros(0)) for fuller in theories]
    point = max(points, key=lambda one: one.marginal.log_likelihood)
    found: Found = {}
    for name in ("all", *CHANNELS):
        keep = point.comparison.stated & ((name == "all") | point.comparison.of(name))
        if keep.any():
            found[name] = float(gaussian(point.comparison, (1.0,), keep).fit.chi2[0, 0, 0]), int(keep.sum())
    kind = f"{trial.truth.kind}, baseline" if trial.truth.baseline else trial.truth.kind
    return kind, found, p_value(point)


def _row(kind: str, name: str, parts: list[tuple[float, int]]) -> str:
    ratio = np.array([c / n for c, n in parts])
    chances = [float(chi2.sf(c, n)) for c, n in parts]
    low, middle, high = np.quantile(ratio, [0.1, 0.5, 0.9])
    return (
        f"| {kind} | {name} | {len(parts)} | {sum(c for c, _ in parts) / sum(n for _, n in parts):.2f} "
        f"| {low:.2f} {middle:.2f} {high:.2f} | {kstest(chances, 'uniform').pvalue:.1e} |"
    )


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", default=["beam", "plate"], choices=KINDS)
    parser.add_argument("--baseline", type=float, default=0.5)
    arguments = parser.parse_args()
    plan = DrawRanges(
        kinds=tuple(arguments.kinds), none=1.0, pairs=0.0, outside=0.0, baseline=arguments.baseline
    )
    every: dict[tuple[str, str], list[tuple[float, int]]] = defaultdict(list)
    values: dict[str, list[float]] = defaultdict(list)
    with threadpool_limits(1):
        for index in range(arguments.trials):
            try:
                kind, found, chance = of_trial(arguments.seed, index, plan)
            except ModalkitError as error:
                print(f"trial {index}: {error}", flush=True)
                continue
            values[kind].append(chance)
            for name, part in found.items():
                every[kind, name].append(part)
    print("| specimen | channel | tests | chi2/n | 10, 50, 90 % | uniform: p |")
    print("|---|---|---|---|---|---|")
    for (kind, name), parts in sorted(every.items()):
        print(_row(kind, name, parts))
    for kind, chances in sorted(values.items()):
        low, middle, high = np.quantile(chances, [0.1, 0.5, 0.9])
        print(f"p-value of the diagnosis, {kind}: {low:.3f} {middle:.3f} {high:.3f}")


if __name__ == "__main__":
    main()
