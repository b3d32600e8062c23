"""Forecasts on a study's own model, by the prediction that the diagnosis has."""

from modalkit.planning.own.bench import OwnBench
from modalkit.planning.own.from_study import bench_of

__all__ = ["OwnBench", "bench_of"]
