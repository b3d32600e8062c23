"""Parameters drawn from their tolerance are covered by the intervals of an update, through hits and identification."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest


def recovery() -> ModuleType:
    path = Path(__file__).resolve().parents[2] / "benchmarks" / "bench_recovery.py"
    spec = importlib.util.spec_from_file_location("bench_recovery", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["bench_recovery"] = module
    spec.loader.exec_module(module)
    return module


def covered(seeds: range) -> np.ndarray:
    module = recovery()
    return np.concatenate([np.abs(module.pulls(*module.recovered(seed))) < 1.96 for seed in seeds])


def test_a_few_random_specimens_are_recovered() -> None:
    inside = covered(range(200, 208))
    # some forty of 0.95: 0.82 is three and a half standard deviations below
    assert inside.mean() > 0.82


def test_modulus_and_density_of_everything_are_named_as_a_pair() -> None:
    module = recovery()
    assert all(module.named(seed) for seed in range(200, 203))


@pytest.mark.slow
def test_pooled_coverage_is_that_of_the_intervals() -> None:
    inside = covered(range(300, 370))
    assert len(inside) >= 300
    low, high = recovery().interval(int(inside.sum()), len(inside))
    assert low < 0.97
    assert high > 0.93
