"""A mass that hangs on a spring and a dashpot: a loose part, a cable's connector, a damper that was not modelled."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import AXES, Place, outline, place, starting_places, where_alike
from updating.effects.mechanism import Size
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.structure.spring import SLIPS, lowest, measured_directions
from updating.models.absorbers import Absorber as Hung
from updating.models.state import State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor

MASS = (1e-4, 0.3)
"""Range of the mass over the structure's own: from one that drives a mode it is tuned to 1 % apart, the root of it,
to a second structure [-]."""

AWAY = 4.0
"""How far below the lowest elastic mode, and above the highest measured one, the mass may swing by itself [-]: lower it
isolates itself, higher it is a mass that does not swing; neither shows a mode of its own in the band."""

DAMPED = (1e-3, 0.5)
"""Range of its damping ratio: from steel on steel to a mode that no test distinguishes from the floor [-]."""

ALONG = 12
"""So many places along a beam are starts: twice the half waves of the highest mode of most bands."""


class Absorber(Effect):
    """A mass on a spring and a dashpot at one place: it makes a mode of its own and drives its neighbours apart.

    ``frequency`` and ``damping``, a ratio, are those of the mass on its spring with the place held still. On imported
    matrices it hangs at one of the test's points, alike in all directions in which that is measured.
    """

    name = "absorber"
    channel = "stiffness"
    summary = "A mass hangs on the structure by a spring: a part come loose, or a tuned absorber."
    footprint = (
        "The test has one mode more than the model. Modes below it fall and modes above it rise, the nearest most, if"
        " they move at the place."
    )
    phrase = "a mass on a spring"
    models = ("beam", "plate", "matrices")
    separated_by = (
        "find the part that vibrates by itself and remove or fix it; or measure more points around it"
    )
    fidelity = 0.03
    damping_doubt = SLIPS

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, mass, frequency and damping."""
        whole = total_mass(predictor.spec)
        low = lowest(predictor) / (2 * np.pi) / AWAY
        high = max(AWAY * predictor.measured.top, AWAY**2 * low)
        heavy = "from a barely detectable mass to a third of the structure's mass"
        where = "its own mode inside the band or close to it"
        lossy = "from steel on steel to a mode that no test distinguishes from the floor"
        return (
            *outline(predictor),
            Parameter("mass", "kg", MASS[0] * whole, MASS[1] * whole, heavy, log=True),
            Parameter("frequency", "Hz", low, high, where, log=True),
            Parameter("damping", "-", *DAMPED, lossy, log=True, default=0.0, natural=EDGES, or_none=True),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need places: on imported matrices, the points of the test."""
        if predictor.spec.imported is None or len(predictor.measured.points):
            return None
        return Obstacle(Lack.DATA, "imported matrices need points of the test at which a mass might hang")

    def unseen(self, predictor: Predictor) -> Obstacle | None:
        """Ask for the mode that it makes: a measured one that looks like none of the model's.

        One that swings far above the band is a lumped mass, one far below it shows nowhere, and one whose own mode is
        damped until no test finds it is a dashpot to the ground: all of them other effects, with fewer parameters.
        """
        if not predictor.measured.has_shapes:
            return Obstacle(Lack.DATA, "shapes are needed to identify the mode that the model lacks")
        if predictor.measured.unpaired is None:
            what = "it would add a mode, but every measured mode is paired with one of the model"
            return Obstacle(Lack.DATA, what)
        return None

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return the mass, which stays on when the specimen is weighed [kg]."""
        return float(values["mass"])

    def damps(self, parameter: str = "") -> bool:
        """State that the dashpot does, and nothing else."""
        return parameter == "damping"

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return one form, on imported matrices one at every point of the test."""
        if predictor.spec.kind != "matrices":
            return (Variant(),)
        points = np.unique(predictor.measured.points, axis=0)
        return tuple(
            Variant(dict(zip(AXES, map(float, at), strict=True)), 1 / max(len(points), 1)) for at in points
        )

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start at a row of places, with what makes each unpaired mode and its neighbour where they are measured."""
        spec, found = predictor.spec, []
        count = len(self.parameters(predictor)) - 3
        places = [(0.5,) * count] if spec.kind == "matrices" else _places(predictor)
        for hertz, coupling, shape in _signs(predictor):
            for where in places:
                at = {p.name: p.value(u) for p, u in zip(self.parameters(predictor), where, strict=False)}
                moved = _moved(predictor, at, shape)
                values = {"mass": coupling / max(moved, 1e-12), "frequency": hertz}
                found.append((*where, *self.quantiles(predictor, values)[count:]))
        return tuple(found) or ((*((0.5,) * count), 0.5, 0.5, 0.5),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the mass on its spring, one in each direction of a place of matrices."""
        mass, omega = float(values["mass"]), 2 * np.pi * float(values["frequency"])
        if not mass:
            return State()
        damping = 2 * float(values.get("damping", 0.0)) * mass * omega
        rows = _rows(predictor, values)
        return State(absorbers=tuple(Hung(row, mass, mass * omega**2, damping) for row in rows))

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the mass that swings."""
        return (Size("mass on a spring", self.weight(predictor, values), "kg"),)

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the place; where no shapes separate it from its mirror images, these too."""
        at = (*place(values)[:2], float(values.get("z", 0.0)))
        return where_alike(predictor, at)


def _rows(predictor: Predictor, values: Values) -> FloatArray:
    """Return the displacement of the basis at the place, in each direction in which that is measured, (n, r)."""
    names = AXES if predictor.spec.kind == "matrices" else AXES[: predictor.spec.dim]
    at = np.array([[float(values[name]) for name in names]])
    if predictor.spec.kind != "matrices":
        return predictor.reduced.rows(at)["w"]
    ways = measured_directions(predictor, at)
    return predictor.reduced.rows(np.repeat(at, len(ways), axis=0), ways)["w"]


def _moved(predictor: Predictor, at: Values, shape: FloatArray) -> float:
    """Return the square of a mode's shape at a place [1/kg].

    Imported matrices have a form for each of their places: the start they share is that of a structure which moves
    alike everywhere.
    """
    if predictor.spec.kind == "matrices":
        return 1 / total_mass(predictor.spec)
    return float(_rows(predictor, at)[0][: len(shape)] @ shape) ** 2


def _places(predictor: Predictor) -> list[tuple[float, ...]]:
    """Return prior quantiles of places from which a search starts."""
    if predictor.spec.kind == "beam":
        return [*starting_places(predictor.spec, along=ALONG), (0.98,)]
    return [(float(u), float(v)) for u in (0.05, 0.25, 0.5, 0.75, 0.95) for v in (0.05, 0.35, 0.65, 0.95)]


def _signs(predictor: Predictor) -> list[tuple[float, float, FloatArray]]:
    """Return what each unpaired mode determines of the absorber that makes it.

    An absorber of frequency f_a and mass m, where a mode f_n of modal mass one moves by phi, makes of it the two f_1
    and f_2: f_1 f_2 = f_n f_a, and f_1^2 + f_2^2 = f_n^2 + f_a^2 (1 + m phi^2) (Den Hartog, section 3.2).
    The mode it shifts most is taken to be the measured one next to it.

    Returns
    -------
    list of (frequency, coupling, shape)
        f_a [Hz], m phi^2 [-], and the shape of the mode on the basis (r,) [kg^-1/2].
    """
    test, extra = predictor.measured, predictor.measured.unpaired
    if extra is None or not len(test.frequency):
        return []
    count = len(test.frequency)
    nominal = predictor.predict(at_least=count + 3)
    chosen = match(test, nominal, np.arange(count))
    found = []
    for hertz in extra.frequency.tolist():
        k = int(np.argmin(np.abs(np.log(test.frequency / hertz))))
        beside, alone = float(test.frequency[k]), float(nominal.frequency[chosen[k]])
        own = hertz * beside / alone
        coupling = (hertz**2 + beside**2 - alone**2) / own**2 - 1
        found.append((own, max(coupling, 1e-4), nominal.vectors[:, chosen[k]]))
    return found
