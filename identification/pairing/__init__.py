"""Which mode of the test is which mode of the model; 'none' is an answer."""

from identification.pairing.assignment import Pair, common_shift, pair
from identification.pairing.correlation import Correlation, correlate
from identification.pairing.followed import counterparts, unlikeness
from identification.pairing.turned import Subspace, turned_subspaces

__all__ = [
    "Correlation",
    "Pair",
    "Subspace",
    "common_shift",
    "correlate",
    "counterparts",
    "pair",
    "turned_subspaces",
    "unlikeness",
]
