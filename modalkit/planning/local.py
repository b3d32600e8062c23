"""Effects that sit somewhere: bodies, soft spots, layers, points that lie elsewhere than stated."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import severity
from modalkit.planning.family import Family, Maker
from modalkit.simulator.setup import Setup

_PLACES = 17
_EXTENT, _LAYER = 0.03, 0.2
_SHEET, _HEAVIER, _MOST_HEAVIER = 0.2, 0.25, 3.0
_HEAVIEST, _CLEAR_MASS = 0.3, 0.05
_CLEAR_ERROR, _MOST_ERROR = 0.05, 0.12


def _along(setup: Setup, *, low: float = 0.08, high: float = 0.0, clamped: float = 0.15) -> FloatArray:
    """Return places, off the ends that are clamped by a share of the length, off the others by less [m]."""
    first, last = (clamped if end in setup.clamped else high for end in ("x0", "x1"))
    return np.linspace(max(first, low if first == high else first), 1 - last, _PLACES) * setup.length


def _sensor(setup: Setup) -> Family:
    return Family(
        "sensor_mass",
        lambda q, _: {"mass": q},
        0.0,
        _HEAVIEST * setup.mass,
        _CLEAR_MASS * setup.mass,
        "a sensor heavier than stated by",
        lambda q: f"{severity(1e3 * q)} g",
    )


def _lump(setup: Setup) -> Family:
    return Family(
        "lumped_mass",
        lambda q, x: {"mass": q, "x": x},
        0.0,
        _HEAVIEST * setup.mass,
        _CLEAR_MASS * setup.mass,
        "a body heavier than",
        lambda q: f"{severity(1e3 * q)} g",
        _along(setup, low=0.0),
    )


def _soft_spot(setup: Setup) -> Family:
    extent = _EXTENT * setup.length

    def loss(q: float) -> float:
        return float(1 - 1 / (1 + q / extent) ** 2)

    return Family(
        "local_stiffness",
        lambda q, x: {"x": x, "extent": extent, "loss": loss(q), "compliance": q},
        0.0,
        6 * extent,
        extent,
        "a place softer by",
        lambda q: f"{100 * loss(q):.0f} % over {severity(1e3 * extent)} mm",
        _along(setup, low=0.1, high=0.1, clamped=0.03),
    )


def _sheet(setup: Setup) -> Family:
    extent = _SHEET * setup.length
    return Family(
        "local_mass",
        lambda q, x: {"x": x, "extent": extent, "factor": 1.0 + q},
        0.0,
        _MOST_HEAVIER,
        _HEAVIER,
        "a place heavier by",
        lambda q: f"{severity(100 * q)} % over {severity(1e3 * extent)} mm",
        _along(setup, low=_SHEET / 2, high=_SHEET / 2, clamped=_SHEET / 2),
    )


def _layer(setup: Setup) -> Family:
    extent = _LAYER * setup.length
    return Family(
        "damping_patch",
        lambda q, x: {"x": x, "extent": extent, "loss_factor": q, "mass": 0.0, "stiffness": 0.0},
        0.0,
        0.5,
        0.1,
        f"a layer over {severity(1e3 * extent)} mm with a loss factor above",
        severity,
        _along(setup, low=_LAYER / 2, high=_LAYER / 2, clamped=_LAYER / 2),
    )


def _strayed(setup: Setup) -> Family:
    """A point that lies elsewhere: its forms are the points that are hit."""
    return Family(
        "position_error",
        lambda q, point: {"point": int(point) + 1, "dx": q},
        -_MOST_ERROR * setup.length,
        _MOST_ERROR * setup.length,
        _CLEAR_ERROR * setup.length,
        "a point off by more than",
        lambda q: f"{severity(1e3 * abs(q))} mm",
        np.array([i for i in range(len(setup.points)) if setup.drive or i != setup.sensor], dtype=float),
        separately=True,
    )


LOCAL: tuple[Maker, ...] = (_sensor, _lump, _soft_spot, _sheet)
"""What frequencies show too."""

LAYERS: tuple[Maker, ...] = (_layer,)
"""What shows in damping alone."""

POINTS: tuple[Maker, ...] = (_strayed,)
"""What shows in shapes alone."""
