"""Poly-reference fitting: one shape to a mode, whatever the reference."""

from identification.fit.poly_reference.places import Sorted, sorted_frfs
from identification.fit.poly_reference.rank_one import RankOne, hold_to_rank_one

__all__ = ["RankOne", "Sorted", "hold_to_rank_one", "sorted_frfs"]
