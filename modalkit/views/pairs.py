"""Which measured mode a model's mode is the partner of, as the pages list and draw them."""

from __future__ import annotations

from dataclasses import dataclass

from updating.prediction.assignment import mac_of_constants
from updating.prediction.matching import Paired, pair_modes
from updating.prediction.prediction import Prediction
from updating.simulation.identified import partners
from updating.test_data.measured import Measured


@dataclass(frozen=True)
class Pair:
    """A measured mode and its partner.

    Parameters
    ----------
    test, model : int
        Which modes, from 0.
    mac : float or None
        MAC of the two; None without measured shapes [-].
    """

    test: int
    model: int
    mac: float | None


def pairs_of(measured: Measured, prediction: Prediction) -> list[Pair]:
    """Return the pairs of a test and a model, in the order of the test's modes.

    Parameters
    ----------
    measured : Measured
        The test.
    prediction : Prediction
        The model's modes.

    Raises
    ------
    EstimationError
        If no measured mode has a partner.
    """
    return pairs_in(pair_modes(measured, prediction), measured, prediction)


def pairs_in(paired: Paired, measured: Measured, prediction: Prediction) -> list[Pair]:
    """Return the pairs of modes that are paired already."""
    mac = mac_of_constants(measured, prediction) if measured.has_shapes else None
    return [
        Pair(int(t), int(m), None if mac is None else float(mac[t, m]))
        for t, m in zip(paired.rows, partners(paired, prediction), strict=True)
    ]
