"""Parameters drawn from their tolerance are covered by the intervals of an update, through hits and identification."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest


def recovery() -> ModuleType:
    path = Path(__file__).resolve().parents[3] / "benchmarks" / "bench_recovery.py"
    spec = importlib.util.spec_from_file_location("bench_recovery", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["bench_recovery"] = module
    spec.loader.exec_module(module)
    return module


def covered(
    seeds: range, data: tuple[str, ...] = ("frequencies", "shapes"), *, blind: bool = False
) -> np.ndarray:
    module = recovery()
    return np.concatenate([module.inside(*module.recovered(seed, data, blind=blind)) for seed in seeds])


@pytest.mark.long
def test_a_few_random_specimens_are_recovered() -> None:
    inside = covered(range(200, 208))
    # some forty of 0.95: 0.82 is three and a half standard deviations below
    assert inside.mean() > 0.82


@pytest.mark.long
def test_modulus_and_density_of_everything_are_named_as_a_pair() -> None:
    module = recovery()
    assert all(module.named(seed) for seed in range(200, 203))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("data", "blind", "seeds"),
    [
        (("frequencies", "shapes"), False, range(1300, 1375)),
        (("frequencies",), False, range(1000, 1085)),
        (("frequencies",), True, range(1000, 1080)),
    ],
    ids=["shapes", "frequencies", "frequencies alone measured"],
)
def test_pooled_coverage_is_that_of_the_intervals(data: tuple[str, ...], blind: bool, seeds: range) -> None:
    inside = covered(seeds, data, blind=blind)
    assert len(inside) >= 350
    low, high = recovery().interval(int(inside.sum()), len(inside))
    assert low < 0.95 < high
    assert 0.93 <= inside.mean() <= 0.97
