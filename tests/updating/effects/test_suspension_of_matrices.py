"""Cords of a free frame given by matrices, beside the test's own dense springs, and whether a diagnosis names them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
import pytest
from effect_cases import LOOK
from scipy.linalg import eigh
from space_frame import BARS, frame, nearest
from test_give_way import POINTS

from acquisition import Dof, Geometry, ModalData
from acquisition.errors import StudyError
from updating import LIBRARY, Axes, Case, Material, Predictor, Region, Spec, Tolerances, diagnose
from updating import measured_from_modes as from_modes
from updating.effects import accepted_state
from updating.effects.base import total_mass
from updating.models import Damping
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.nominal import predictor_of

EFFECT = LIBRARY["suspension"]
LOSS = 0.004
"""Loss factor of the frame [-]."""

HUNG = tuple(nearest(at) for at in ((0.0, 0.0, 0.0), (0.5, 0.1, 0.0), (0.15, 0.35, 0.45)))
"""Nodes at which it hangs: both feet, and the end of the arm."""

TOGETHER = {"cord": [node + 1 for node in HUNG]}
SINGLY = {f"cord_{i}": [node + 1] for i, node in enumerate(HUNG)}


def free(sets: Mapping[str, Sequence[int]]) -> Spec:
    """The frame on no feet, as matrices with a part for each bar."""
    made = frame().made
    count = len(made.places)
    table = NodeTable(
        np.repeat(np.arange(count) + 1, 6), np.repeat(np.array(made.places), 6, axis=0),
        np.tile(np.arange(1, 7), count), np.arange(6 * count),
        sets={name: np.array(sorted(nodes)) for name, nodes in sets.items()},
    )  # fmt: skip
    parts = [made.matrices(name) for name in BARS]
    whole = map(Sparse, made.matrices())
    imported = Imported(*whole, table, *(tuple(Sparse(part[i]) for part in parts) for i in range(2)))
    size = np.ptp(np.array(made.places), axis=0)
    regions = tuple(Region(name, (0.0, 1.0), (0.0, 1.0)) for name in BARS)
    return Spec(
        "matrices", length=float(size[0]), width=float(size[1]), thickness=float(size[2]), elements=(),
        clamped=(), theory="imported", material=Material(210e9, 7850.0), regions=regions, masses=(),
        damping=Damping(loss_factor=LOSS), imported=imported,
    )  # fmt: skip


@cache
def held(
    stiffness: float, axes: tuple[int, ...], damping: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies [Hz], damping ratios and shapes of the frame on its cords, the six bounces among them."""
    k, m = frame().made.matrices()
    at = [6 * node + axis for node in HUNG for axis in axes]
    sprung = k.copy()
    sprung[at, at] += stiffness
    squares, shapes = eigh(sprung, m, subset_by_index=(0, 19))
    squares = np.maximum(squares, 1e-6)
    strained = LOSS * np.sum(shapes * (k @ shapes), axis=0)
    dashed = damping * np.sum(shapes[at] ** 2, axis=0) * np.sqrt(squares)
    return np.sqrt(squares) / (2 * np.pi), (strained + dashed) / (2 * squares), shapes


def predictor(sets: Mapping[str, Sequence[int]] = TOGETHER) -> Predictor:
    return predictor_of(case(sets, held(0.0, ())))


def case(
    sets: Mapping[str, Sequence[int]], specimen: tuple[np.ndarray, np.ndarray, np.ndarray], *, seed: int = 0
) -> Case:
    """The model beside ten modes of a specimen: frequencies scatter by 0.02 %, damping by 3 %, shapes by 0.5 %."""
    rng, spec = np.random.default_rng(seed), free(sets)
    frequency, damping, shapes = (each[..., 6:16] for each in specimen)
    seen = shapes[[6 * node + axis for node, axis in POINTS]]
    sigma = 5e-3 * np.sqrt(np.mean(seen**2, axis=0)) * np.ones_like(seen)
    nodes = sorted({node for node, _ in POINTS})
    modal = ModalData(
        frequency=frequency * (1 + 2e-4 * rng.standard_normal(10)), frequency_sigma=2e-4 * frequency,
        damping=damping * np.exp(0.03 * rng.standard_normal(10)), damping_sigma=0.03 * damping,
        shapes=seen + sigma * rng.standard_normal(seen.shape), shape_sigma=sigma,
        dofs=tuple(Dof(node + 1, axis + 1) for node, axis in POINTS),
        geometry=Geometry(tuple(n + 1 for n in nodes), np.array(frame().made.places)[nodes]), scaled=True,
    )  # fmt: skip
    test = from_modes(modal, Axes(), spec, repeatability=2e-4, position_sigma=0.0, calibration=0.02)
    return Case("frame", spec, test, baseline=None, tolerances=Tolerances({"E": 0.005, "density": 0.003}))


WAYS = {"x": (0,), "z": (2,), "all": (0, 1, 2)}


@pytest.mark.parametrize("sets", [TOGETHER, SINGLY], ids=["one set of three nodes", "three sets"])
@pytest.mark.parametrize("along", WAYS)
@pytest.mark.parametrize("stiffness", [300.0, 6000.0])
def test_bounces_and_modes_are_those_of_springs_assembled(
    sets: Mapping[str, Sequence[int]], along: str, stiffness: float
) -> None:
    """K + k sum e e^T, by dense algebra."""
    look, values = predictor(sets), {"at": "cord", "along": along, "stiffness": stiffness}
    state = EFFECT.state(look, values)
    frequency, damping, _ = held(stiffness, WAYS[along], 0.8)
    squares = np.maximum(look.reduced.eigen(state)[0][:6], 0.0)
    assert np.sqrt(squares) / (2 * np.pi) == pytest.approx(frequency[:6], rel=1e-4, abs=0.02)
    assert look.predict(state, count=8).frequency == pytest.approx(frequency[6:14], rel=1e-6)
    found = look.predict(EFFECT.state(look, values | {"damping": 0.8}), count=8)
    assert found.damping == pytest.approx(damping[6:14], rel=0.02)
    assert EFFECT.derived(look, values) == {"number": (3.0, "-")}
    at = np.array(frame().made.places)[list(HUNG)]
    assert np.array(sorted(EFFECT.locations(look, values))) == pytest.approx(at[np.lexsort(at.T[::-1])])


def test_the_whole_bounces_as_a_suspension_does_on_any_number_of_cords() -> None:
    look = predictor()
    first, mass = float(look.predict(count=1).frequency[0]), total_mass(look.spec)
    stiffness = EFFECT.parameters(look)[0]
    forms = EFFECT.variants(look)
    assert {form.values["at"] for form in forms} == {"cord", "ends", "corners"}
    assert sum(form.weight for form in forms) == pytest.approx(1.0)
    for form in forms:
        (count, _) = EFFECT.derived(look, form.values)["number"]
        ends = [stiffness.value(u) for u in form.within["stiffness"]]
        assert np.sqrt(count * np.array(ends) / mass) / (2 * np.pi * first) == pytest.approx([0.03, 0.7])


def test_cords_are_where_somebody_named_them_or_at_ends_and_corners() -> None:
    spec = free(SINGLY | {"everything": list(range(1, 15)), "foot": [1]})
    assert spec.imported is not None
    names = {cords.name: len(cords.places) for cords in spec.imported.cords}
    assert names == {"cord": 3, "ends": 2, "corners": 4}


def test_what_is_held_hangs_on_no_cords() -> None:
    assert "the model is not free" in str(EFFECT.why_not(LOOK["matrices"]))
    assert EFFECT.why_not(predictor()) is None


def test_stated_cords_are_part_of_the_model_and_unknown_ones_are_refused() -> None:
    look, values = predictor(), {"at": "cord", "along": "z", "stiffness": 2500.0}
    state = accepted_state(look, "suspension", values)
    assert look.predict(state, count=4).frequency == pytest.approx(held(2500.0, (2,))[0][6:10], rel=1e-6)
    with pytest.raises(StudyError, match="at = 'rope' is not one of the model's: cord, ends, corners"):
        accepted_state(look, "suspension", values | {"at": "rope"})


RIVALS = ("suspension", "ground_spring", "local_stiffness", "lumped_mass", "E", "uniform_damping")


@pytest.mark.long
@pytest.mark.parametrize(
    "along",
    ["z", pytest.param("all", marks=pytest.mark.slow)],
)
def test_a_diagnosis_names_them_with_their_stiffness(along: str) -> None:
    hidden = case(TOGETHER, held(2500.0, WAYS[along], 1.5), seed=3)
    found = diagnose(hidden, library=[LIBRARY[name] for name in RIVALS])
    assert (found.verdict, found.sets) == ("named", (("suspension",),)), found.table()
    assert found.where.names == ("cord",)
    (first, *_) = found.ranking
    assert first.forms[0]["along"] == along
    own = first.parameters
    assert own["suspension.stiffness"].value == pytest.approx(2500.0, rel=0.05)
    assert own["suspension.damping"].value == pytest.approx(1.5, rel=0.15)
