"""What the rig's own body answers, at many stations and in one mode more than the test has."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.planning.family import Family
from modalkit.simulator.bodies.complex_modes import ComplexModes
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

_ELEMENTS = 6
_CANDIDATES = 12
_NEAR = 0.02
_STEP = 1e-3
TOLERANCES = ("E", "density", "thickness", "length", "width")
"""Doubts of the modeller that are linearised."""


@dataclass(frozen=True, eq=False)
class Stations:
    """Places at which the structure is or might be hit: the test's own points first, then others.

    Parameters
    ----------
    test : Setup
        The test.
    """

    test: Setup

    @cached_property
    def setup(self) -> Setup:
        """The test as if every station were one of its points, and all had been hit."""
        own, length = self.test.places[:, 0], self.test.length
        low, high = (0.03 if end in self.test.clamped else 0.0 for end in ("x0", "x1"))
        grid = np.linspace(low, 1.0 - high, _CANDIDATES) * length
        far = np.min(np.abs(grid[:, None] - own[None, :]), axis=1) > _NEAR * length
        more = tuple((round(float(x), 4),) for x in grid[far])
        return replace(self.test, points=(*self.test.points, *more), drive=True)

    @property
    def x(self) -> FloatArray:
        """Where they are, (n_stations,) [m]."""
        return np.asarray(self.setup.places[:, 0])

    @property
    def own(self) -> int:
        """How many of them are the test's [-]."""
        return len(self.test.points)

    @property
    def modes(self) -> int:
        """Modes that are read: one more than the test has [-]."""
        return self.test.modes + 1

    @cached_property
    def base(self) -> Scene:
        """The rig exactly as stated, without any effect."""
        return nominal_scene(self.setup).with_body(elements=_ELEMENTS)

    def _elastic(self, scene: Scene) -> ComplexModes:
        return scene.elastic().take(slice(0, self.modes))

    @cached_property
    def scale(self) -> FloatArray:
        """Largest modal constant of each nominal mode over all stations, (n_modes,) [1/kg]."""
        modes = self._elastic(self.base)
        return np.asarray(np.abs(modes.residues * 2 * modes.poles.imag).max(axis=0))

    def read(self, scene: Scene) -> FloatArray:
        """Return ln f, ln decay, and the constants over their mode's scale, in one row.

        Parameters
        ----------
        scene : Scene
            What is on the rig.

        Returns
        -------
        (2 n_modes + n_stations n_modes,) array
            Constants station by station [-].
        """
        modes = self._elastic(scene)
        poles = modes.poles
        level = scene.chain.gain * (modes.residues * 2j * poles.imag).real / self.scale
        decay = np.log(scene.chain.window - poles.real)
        return np.concatenate([np.log(np.abs(poles)), decay, level.ravel()])

    @cached_property
    def nominal(self) -> FloatArray:
        """Data of the rig exactly as stated, in one row [-]."""
        return self.read(self.base)

    def change(self, family: Family, q: float, place: float) -> FloatArray:
        """Return what an effect of a severity [SI] at a place changes of the data, in one row [-]."""
        if not q:
            return np.zeros_like(self.nominal)
        return self.read(hidden(family, self.base, q, place)) - self.nominal

    @cached_property
    def slopes(self) -> FloatArray:
        """Change of the nominal constants as the hammer strays, (n_stations, n_modes) [1/m]."""
        modes = self._elastic(self.base)
        return np.asarray((modes.gradients[0] * 2j * modes.poles.imag).real / self.scale)

    @cached_property
    def material_share(self) -> FloatArray:
        """Part of each mode's decay that is the specimen's own and not the window's, (n_modes,) [-]."""
        decay = np.exp(self.nominal[self.modes : 2 * self.modes])
        return np.asarray((decay - self.setup.window) / decay)

    @cached_property
    def tolerances(self) -> dict[str, FloatArray]:
        """Change of the data per relative change of each doubted quantity, by name."""
        return {name: self._per(name) for name in TOLERANCES}

    def _per(self, name: str) -> FloatArray:
        moved = nominal_scene(self.setup, factors={name: 1 + _STEP}).with_body(elements=_ELEMENTS)
        return (self.read(moved) - self.nominal) / _STEP

    @property
    def gain(self) -> FloatArray:
        """Change of the data per relative change of the level."""
        column = self.nominal.copy()
        column[: 2 * self.modes] = 0.0
        return column

    def gain_of(self, mode: int) -> FloatArray:
        """Return the change of the data per relative change of one mode's constants."""
        column = np.zeros_like(self.nominal)
        here = slice(2 * self.modes + mode, None, self.modes)
        column[here] = self.nominal[here]
        return column


def hidden(family: Family, scene: Scene, q: float, place: float) -> Scene:
    """Return a scene of the rig with an effect.

    Parameters
    ----------
    family : Family
        The effect; the rig's own of that name acts.
    scene : Scene
        Without it.
    q : float
        Severity; 0 is none [SI].
    place : float
        Where [m], or which form.
    """
    return HIDDEN_EFFECTS[family.name].act(scene, dict(family.values(q, place))) if q else scene
