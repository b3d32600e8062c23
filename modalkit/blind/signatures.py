"""What each single effect of the rig's library does to the data, to first order, on a coarse grid of its forms."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.blind.reading import Scales, read, shape_part
from modalkit.simulator.hidden import HiddenEffect, Values, effects_of
from modalkit.simulator.setup import Setup, hit_points

_FAINT = 0.3
"""Strength at which effects are linearised; a clear one would bend what is meant to be straight [-]."""

_PLACES = {"beam": (7,), "plate": (3, 2), "solid": (5,)}
"""Places of a local effect along each axis; two neighbours span what lies between them. Twice as many take twice
as long [-]."""

_EXTENT = 0.15
_LOCAL = ("lumped_mass", "local_stiffness", "local_mass", "damping_patch")
_PARTS: dict[str, tuple[Values, ...]] = {
    "orthotropy": ({"ratio": 1.1, "shear_ratio": 1.0}, {"ratio": 1.0, "shear_ratio": 1.1}),
    "damping_patch": ({"loss_factor": 0.05, "alpha": 0.0, "beta": 0.0, "mass": 0.0, "stiffness": 0.0},),
    "local_stiffness": ({"loss": 0.1, "form": "rectangle"},),
    "local_mass": ({"factor": 1.1, "form": "sheet"},),
}
"""Parameters that are varied one by one; of the other effects one draw is scaled."""


@dataclass(frozen=True, eq=False)
class Signature:
    """What one effect does to the data in some of its forms.

    Parameters
    ----------
    columns : (n, n_columns) array
        They span it, in standard deviations [-].
    graded : bool
        Whether there can be more or less of it; if not, one column is all there is.
    """

    columns: FloatArray
    graded: bool = True

    def left(self, change: FloatArray) -> float:
        """Return the squared length of what the best fit leaves of a change [-]."""
        if self.graded:
            fit, *_ = np.linalg.lstsq(self.columns, change, rcond=1e-9)
        else:
            fit = np.ones(self.columns.shape[1])
        rest = change - self.columns @ fit
        return float(rest @ rest)


def signatures(of: Scales, without: Sequence[str] = ()) -> Iterator[Signature]:
    """Yield what single effects of the rig's library do to the data.

    Parameters
    ----------
    of : Scales
        Of the test.
    without : sequence of str
        Effects to leave out.

    Yields
    ------
    Signature
        One or more of each effect.
    """
    setup = of.nominal.setup
    measured = _of_the_measurement(of)
    for name, effect in effects_of(setup.kind).items():
        if not effect.in_library or not effect.fits(setup) or effect.known_as in without:
            continue
        if name in measured:
            for columns in measured[name]:
                yield Signature(of.standardised(np.column_stack(columns)), effect.graded)
        elif name == "shear":
            plain = read(of.nominal.with_body(shear=False)).vector(of.scale)
            yield Signature(of.standardised((plain - of.base.vector(of.scale))[:, None]), graded=False)
        elif name in _LOCAL and setup.kind in _PLACES:
            yield from _of_places(effect, of)
        else:
            yield Signature(_of_values(effect, of, _forms(effect, setup)))


def _forms(effect: HiddenEffect, setup: Setup) -> list[Values]:
    drawn = effect.draw(np.random.default_rng(zlib.crc32(effect.name.encode())), setup, _FAINT)
    if effect.name == "uniform_damping":
        omega = 2 * np.pi * setup.nominal_hz[1]
        none = dict.fromkeys(drawn, 0.0)
        sizes = {"alpha": 0.01 * omega, "beta": 0.01 / omega, "loss_factor": 0.01}
        return [none | {law: size} for law, size in sizes.items()]
    return [drawn | part for part in _PARTS.get(effect.name, ({},))]


def _of_values(effect: HiddenEffect, of: Scales, forms: Sequence[Values]) -> FloatArray:
    start = of.base.vector(of.scale)
    scenes = [effect.act(of.nominal, values) for values in forms]
    moved = [read(scene, like=of.modes).vector(of.scale) for scene in scenes]
    return of.standardised(np.column_stack([vector - start for vector in moved]))


def _of_places(effect: HiddenEffect, of: Scales) -> Iterator[Signature]:
    """Yield what neighbouring places of a local effect span."""
    setup = of.nominal.setup
    counts = _PLACES[setup.kind]
    lines = [(np.arange(n) + 0.5) / n * size for n, size in zip(counts, setup.size, strict=True)]
    sizes = {name: _EXTENT * size for name, size in zip(("extent", "extent_y"), setup.size, strict=False)}
    columns = {}
    for node in product(*(range(n) for n in counts)):
        place = {axis: float(line[k]) for axis, line, k in zip("xy", lines, node, strict=False)}
        given = place if effect.name == "lumped_mass" else place | sizes
        columns[node] = _of_values(effect, of, [form | given for form in _forms(effect, setup)])
    for one, other in combinations(columns, 2):
        if sum(abs(a - b) for a, b in zip(one, other, strict=True)) == 1:
            yield Signature(np.column_stack([columns[one], columns[other]]))


def _of_the_measurement(of: Scales) -> dict[str, list[list[FloatArray]]]:
    """Return what effects of the measurement do, which needs no other modes than the nominal ones."""
    setup, base = of.nominal.setup, of.base
    n, hit = setup.modes, hit_points(setup)
    nothing = np.zeros(3 * n + 1)

    def shapes(constants: ComplexArray) -> FloatArray:
        return np.concatenate([nothing, shape_part(constants, of.scale)])

    def only(point: int, constants: ComplexArray) -> ComplexArray:
        kept = np.zeros_like(base.constants)
        kept[point] = constants
        return kept

    def exchange(a: int, b: int) -> ComplexArray:
        away = base.constants[b] - base.constants[a]
        return only(a, away) + only(b, -away)

    window = np.zeros(len(base.vector(of.scale)))
    window[n : 2 * n] = 1.0 / base.decay
    drift = np.zeros(len(window))
    drift[3 * n] = 1.0
    return {
        "calibration_gain": [[shapes(base.constants)]],
        "channel_gain": [[shapes(only(p, base.constants[p]))] for p in hit],
        "time_delay": [[shapes(-1j * base.frequency * base.constants)]],
        "exponential_window": [[window]],
        "drift": [[drift]],
        "polarity": [[shapes(only(p, -2 * base.constants[p]))] for p in hit],
        "swapped_points": [[shapes(exchange(a, b))] for a, b in combinations(hit, 2)],
        "position_error": [[shapes(only(p, g[p])) for g in base.gradients] for p in hit],
    }
