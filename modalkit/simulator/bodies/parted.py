"""What is the same of every body of named parts, joints and feet, of bars or of bricks."""

from __future__ import annotations

from dataclasses import dataclass

from modalkit.simulator.bodies.plate.parts import PlateAttached

Shares = tuple[tuple[str, float], ...]
"""Factors, or springs, by name."""


@dataclass(frozen=True, kw_only=True)
class Parted:
    """What is done to its parts, and how it is damped.

    Parameters
    ----------
    clamped : tuple of {"x0"}
        It stands on its feet.
    stiff, heavy : tuple of (str, float)
        Factors on stiffness and mass of parts [-].
    loose : tuple of (str, float)
        What is left of the stiffness of joints [-].
    feet : tuple of (str, float)
        Feet that give way, and on what spring [SI].
    attached : tuple of PlateAttached
        What is fixed.
    alpha, beta, added_alpha, added_beta, added_loss : float
        Damping, as a beam's.
    """

    clamped: tuple[str, ...] = ("x0",)
    stiff: Shares = ()
    heavy: Shares = ()
    loose: Shares = ()
    feet: Shares = ()
    attached: tuple[PlateAttached, ...] = ()
    alpha: float = 0.0
    beta: float = 0.0
    added_alpha: float = 0.0
    added_beta: float = 0.0
    added_loss: float = 0.0

    gradients = ("slope_x", "slope_y")
    rigid_modes = 0
