"""Removal of sensor mass against chains of masses with and without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, EstimationError, FrfSet, InputError
from acquisition.form import FORMS
from acquisition.frfs.scatter import HitGroup, HitScatter
from acquisition.frfs.sensor_mass import remove_sensor_mass

MASS = np.diag([1.0, 0.8, 1.2, 0.6])
SPRINGS = 1e5 * np.array([[3.0, -1.0, 0, 0], [-1.0, 2.0, -1.0, 0], [0, -1.0, 2.5, -1.5], [0, 0, -1.5, 1.5]])
DASHPOTS = np.diag([3.0, 0.0, 8.0, 1.0]) + 2e-5 * SPRINGS  # not proportional
FREQUENCY = np.arange(5.0, 120.0, 0.5)
ACCELEROMETER = 0.05


def matrix(laplace, added=()):
    """Receptances of the chain with masses at some places, shape (n_lines, 4, 4)."""
    mass = MASS.copy()
    for place, extra in added:
        mass[place, place] += extra
    s = laplace[:, None, None]
    return np.linalg.inv(mass * s**2 + DASHPOTS * s + SPRINGS)


def dof(place: int, sign: int = 1) -> Dof:
    return Dof(place + 1, 3 * sign)


def measured(pairs, added, *, decay=0.0, form="accelerance", signs=(1, 1)) -> FrfSet:
    """FRFs of (response, reference) places, as they are stored with transducers that may be turned round."""
    laplace = 2j * np.pi * FREQUENCY + decay
    values = [matrix(laplace, added(i))[:, i, j] * laplace ** FORMS.index(form) for i, j in pairs]
    return FrfSet(
        FREQUENCY,
        signs[0] * signs[1] * np.array(values),
        tuple(dof(i, signs[0]) for i, _ in pairs),
        tuple(dof(j, signs[1]) for _, j in pairs),
        form=form,
        decay=decay,
    )


def difference(found: FrfSet, true: FrfSet) -> float:
    assert found.responses == true.responses and found.references == true.references
    return float(np.abs(found.values / true.values - 1).max())


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("decay", [0.0, 7.0])
@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1)])
def test_one_sensor_and_a_roving_hammer(form, decay, signs):
    pairs = [(2, j) for j in range(4)]
    more = {"form": form, "decay": decay, "signs": signs}
    loaded = measured(pairs, lambda i: [(2, ACCELEROMETER)], **more)
    bare = measured(pairs, lambda i: (), **more)
    assert difference(loaded, bare) > 0.2
    assert difference(remove_sensor_mass(loaded, mass=ACCELEROMETER), bare) < 1e-9


def test_several_sensors_at_once_of_different_masses():
    """One of them weighs nothing and feels the others all the same; its own point was not hit."""
    pairs = [(i, j) for j in range(3) for i in (0, 2, 3)]
    masses = {0: 0.02, 2: 0.05, 3: 0.0}
    loaded = measured(pairs, lambda i: masses.items(), decay=3.0)
    bare = measured(pairs, lambda i: (), decay=3.0)
    given = {dof(place, -1): mass for place, mass in masses.items()}
    assert difference(remove_sensor_mass(loaded, mass=given), bare) < 1e-9


def test_a_roving_accelerometer_loads_each_measurement_on_its_own():
    pairs = [(i, j) for i in range(4) for j in sorted({1, i})]
    loaded = measured(pairs, lambda i: [(i, ACCELEROMETER)])
    bare = measured(pairs, lambda i: ())
    assert difference(remove_sensor_mass(loaded, mass=ACCELEROMETER, roving=True), bare) < 1e-9
    with pytest.raises(EstimationError, match="1\\+Z/1\\+Z"):
        remove_sensor_mass(loaded.select([1]), mass=ACCELEROMETER, roving=True)


def test_what_is_missing_is_named():
    loaded = measured([(2, 0), (2, 1)], lambda i: [(2, ACCELEROMETER)])
    with pytest.raises(EstimationError, match=r"3\+Z/3\+Z .*hit there"):
        remove_sensor_mass(loaded, mass=ACCELEROMETER)
    pairs = [(0, 0), (2, 0), (0, 2), (2, 2), (0, 3)]
    with pytest.raises(EstimationError, match=r"hits at 4\+Z"):
        remove_sensor_mass(measured(pairs, lambda i: ()), mass=ACCELEROMETER)


@pytest.mark.parametrize("mass", [-0.1, np.nan, {Dof(9, 3): 0.1}])
def test_senseless_masses_are_refused(mass):
    with pytest.raises(InputError, match="mass"):
        remove_sensor_mass(measured([(2, 2)], lambda i: ()), mass=mass)


def test_no_mass_changes_nothing():
    frfs = measured([(2, 2)], lambda i: ())
    assert remove_sensor_mass(frfs, mass=0.0) is frfs


@pytest.mark.parametrize("roving", [False, True])
def test_what_each_hit_does_is_carried_through(rng, roving):
    """Deviations of the result are what the correction makes of FRFs that deviate."""
    places = (0, 2) if not roving else (2,)
    pairs = [(i, j) for j in range(4) for i in places]
    loaded = measured(pairs, lambda i: [(p, ACCELEROMETER) for p in places])
    groups = []
    for j in range(4):
        rows = np.array([row for row, (_, at) in enumerate(pairs) if at == j])
        shape = (3, len(rows), len(FREQUENCY))
        groups.append(HitGroup(rows, 1e-7 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))))
    scatter = HitScatter(tuple(groups))
    known = replace(loaded, scatter=scatter, variance=scatter.variance(len(pairs)))
    found = remove_sensor_mass(known, mass=ACCELEROMETER, roving=roving)
    for (rows, deviation), (new_rows, new) in zip(
        known.scatter.of_hits(), found.scatter.of_hits(), strict=True
    ):
        moved = np.array(loaded.values)
        moved[rows] += deviation
        other = remove_sensor_mass(replace(loaded, values=moved), mass=ACCELEROMETER, roving=roving)
        change = np.zeros_like(moved)
        change[new_rows] = new
        assert np.allclose(other.values - found.values, change, rtol=0, atol=1e-4 * np.abs(change).max())
    assert np.allclose(found.variance, found.scatter.variance(len(pairs)))


@pytest.mark.long
def test_a_variance_without_hits_is_carried_as_of_independent_frfs(rng):
    pairs = [(i, j) for j in range(4) for i in (0, 2)]
    loaded = measured(pairs, lambda i: [(0, ACCELEROMETER), (2, ACCELEROMETER)])
    level = 1e-6 * np.arange(1.0, 9.0)[:, None] * np.ones(len(FREQUENCY))
    stated = remove_sensor_mass(replace(loaded, variance=level**2), mass=ACCELEROMETER)
    shape = (2000, *loaded.values.shape)
    dirt = level / np.sqrt(2) * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    errors = [
        remove_sensor_mass(replace(loaded, values=loaded.values + d), mass=ACCELEROMETER).values
        - stated.values
        for d in dirt
    ]
    happened = np.mean(np.abs(errors) ** 2, axis=0)
    assert np.median(stated.variance / happened) == pytest.approx(1.0, abs=0.01)
    assert np.abs(np.log(stated.variance / happened)).max() < 0.15  # 2000 draws: 2.2 % each
