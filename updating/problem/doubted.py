"""What all data of a test doubt alike: factors of the whole and of regions, masses and places of stated bodies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.registration import registration_doubt, with_registration
from updating.models.base import FACTORS
from updating.models.named_factors import carried_masses, departure, regions_of, unassigned
from updating.models.state import NOMINAL, State
from updating.prediction.bodies import displaced
from updating.prediction.predict import Predictor
from updating.thresholds import CARRIED_DOUBT, REGION_MESH_DOUBT, STATED_MASS_DOUBT
from updating.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class Doubted:
    """What all data doubt alike, by name, with its standard deviation.

    Parameters
    ----------
    predictor : Predictor
        The model as seen from the test's points.
    tolerances : Tolerances
        The modeller's doubts.
    position_sigma : float
        Of the places of stated bodies [m].
    corrected : bool
        Whether a baseline corrected the model, whose places have the same registration.
    """

    predictor: Predictor
    tolerances: Tolerances
    position_sigma: float
    corrected: bool = False

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Factors of the whole and of regions, masses and places of bodies, what supports carry along."""
        known = {name for term in self.predictor.reduced.structure.terms for name in term.powers}
        whole = [n for n in FACTORS if n in known and self.tolerances.factors.get(n, 0.0) > 0]
        own = dict.fromkeys(
            [*self.tolerances.parts, *self.tolerances.bounds, *unassigned(self.predictor.spec), *self._meshed]
        )
        regional = [n for n in own if self._sigma(n) > 0 and self._of_regions(n, known)]
        return (*whole, *regional, *self.predictor.body_changes, *self._carried)

    @cached_property
    def _carried(self) -> dict[str, str]:
        """The supports that may carry another mass along than is estimated, by the names of these doubts."""
        return carried_masses(self.predictor.spec)

    @cached_property
    def _meshed(self) -> tuple[str, ...]:
        """The stiffness of each region that its mesh of bricks makes doubtful; a baseline took that out."""
        spec = self.predictor.spec
        solid = spec.imported is not None and spec.imported.places.solid
        return tuple(f"{region.name}.E" for region in spec.regions) if solid and not self.corrected else ()

    def _of_regions(self, name: str, known: set[str]) -> bool:
        """Return whether a name is a factor of regions of the model."""
        regions, factor = regions_of(self.predictor.spec, name)
        return bool(regions) and factor in known

    @cached_property
    def sigmas(self) -> FloatArray:
        """Their standard deviations, (n_names,) [-, of places m]."""
        return np.array([self._sigma(name) for name in self.names])

    def _sigma(self, name: str) -> float:
        if (change := self.predictor.body_changes.get(name)) is not None:
            return STATED_MASS_DOUBT if change.axis is None else self._place_sigma(change.axis, change.at)
        if name in self._carried:
            return CARRIED_DOUBT
        if name in self._meshed:
            return float(np.hypot(self._stated(name), REGION_MESH_DOUBT))
        return self.tolerances.factor(name)

    def _stated(self, name: str) -> float:
        """Return what the study states of one region by itself; what it states of all is a doubt of the whole [-]."""
        own = {*self.tolerances.parts, *self.tolerances.bounds}
        return self.tolerances.factor(name) if name in own else 0.0

    def _place_sigma(self, axis: int, at: float) -> float:
        """Return the doubt in the place of a body along an axis: its own, and that in where all places lie [m]."""
        own, spec = self.position_sigma, self.predictor.spec
        if self.corrected:
            return own
        loose = float(registration_doubt(spec, self.tolerances.factors)[axis])
        sigma = np.array([np.hypot(own, loose)])
        return float(with_registration(sigma, np.array([at]), (spec.length, spec.width)[axis], loose)[0])

    @cached_property
    def relative(self) -> FloatArray:
        """The standard deviations, those of places relative to the size of the model, (n_names,) [-].

        What a support carries along is next to nothing of what the structure weighs.
        """
        places = {name for name, change in self.predictor.body_changes.items() if change.of_place}
        size = [self.predictor.spec.length if name in places else 1.0 for name in self.names]
        size = [np.inf if name in self._carried else one for name, one in zip(self.names, size, strict=True)]
        return np.asarray(self.sigmas / size)

    def departure(self, shift: FloatArray, stage: Predictor) -> State:
        """Return the departure that nuisances make.

        Parameters
        ----------
        shift : (n_names,) array
            Nuisances [standard deviations].
        stage : Predictor
            What it is put on: this specimen's, under one theory or another, each with a basis of its own.
        """
        if not shift.any():
            return NOMINAL
        moved = dict(zip(self.names, (shift * self.sigmas).tolist(), strict=True))
        bodies = stage.body_changes
        others = bodies.keys() | self._carried.keys()
        factors = {name: float(np.exp(by)) for name, by in moved.items() if name not in others}
        masses = displaced(stage.reduced, stage.spec, bodies, moved)
        carried = {support: 1.0 + moved[name] for name, support in self._carried.items()}
        return departure(self.predictor.spec, factors).plus(State(mass=masses, carried=carried))
