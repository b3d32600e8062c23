"""Forecasts on a study's own model: plates, matrices and decks, by the prediction that the diagnosis has."""

from modalkit.planning.own.bench import OwnBench
from modalkit.planning.own.from_study import own_bench

__all__ = ["OwnBench", "own_bench"]
