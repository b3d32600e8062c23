"""Node sets, joints and supports of imported matrices against the same structures put together by hand."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from imported_cases import bolted_frame, frame_matrices, seen_from
from scipy.linalg import eigh

from acquisition.errors import StudyError
from updating import LIBRARY, Material, Predictor, Region, Spec
from updating.models.imported import Imported
from updating.models.imported.groups import common_name, joints_of
from updating.models.imported.hypothesis import Hypothesis, change_of, check_ends
from updating.models.imported.sets import sets_of_table
from updating.models.state import State, combine
from updating.models.yielding import Yielding

TOLERATED = 5e-5
"""Of frequencies: what turning and shifting have in common of the mass of half an element; without it, 5e-3 [-]."""


@pytest.fixture(scope="module")
def frame() -> Iterator[ModuleType]:
    with bolted_frame() as module:
        yield module


@pytest.fixture(scope="module")
def imported(frame: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Imported:
    return frame_matrices(frame, tmp_path_factory.mktemp("frame"))


def hertz(stiffness: np.ndarray, mass: np.ndarray, count: int = 6) -> np.ndarray:
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True, subset_by_index=(0, count - 1))) / (2 * np.pi)


def test_names_stand_in_the_node_table() -> None:
    found = sets_of_table(np.array([1, 1, 2, 3]), ["a b", "a", "b; c", ""])
    assert {name: nodes.tolist() for name, nodes in found.items()} == {"a": [1], "b": [1, 2], "c": [2]}


def test_joints_are_nodes_at_one_place_with_the_springs_between_them(
    frame: ModuleType, imported: Imported
) -> None:
    joints = {joint.name: joint for joint in imported.joints}
    assert set(joints) == set(frame.JOINTS)
    turning = np.mean(frame.JOINT[3:])
    for joint in joints.values():
        assert joint.stiffness == pytest.approx((frame.JOINT[0], turning))
    assert {group.name for group in imported.groups} == {f"{name}_column" for name in frame.JOINTS}


def test_a_joint_that_turns_is_the_structure_built_with_it(frame: ModuleType, imported: Imported) -> None:
    joint = next(joint for joint in imported.joints if joint.name == "joint_3")
    soft = (imported.stiffness - 0.9 * joint.springs[1]).toarray()
    built = frame.frame({"joint_3": 0.1})[0]
    expected = hertz(built.matrix("stiffness").toarray(), built.matrix("mass").toarray())
    assert hertz(soft, imported.mass.toarray()) == pytest.approx(expected, rel=1e-9)


GIVES: list[dict[int, float]] = [
    {0: 1e6},
    {2: 3e6},
    {3: 500.0},
    {4: 2000.0},
    {0: 1e6, 1: 1e6, 2: 1e6},
    {3: 800.0, 4: 800.0, 5: 800.0},
    {0: 2e6, 1: 4e6, 2: 1e6, 3: 2e3, 4: 1e3, 5: 3e3},
]
"""In which directions a foot gives way, and on what springs [N/m, N m/rad]."""


@pytest.mark.parametrize("springs", GIVES)
def test_a_support_that_gives_way_is_the_structure_on_springs(
    frame: ModuleType, imported: Imported, springs: dict[int, float]
) -> None:
    """The rows of the support are lost, with their mass; the other structure has those that move."""
    from bars import rows_of  # type: ignore[import-not-found]

    support = next(s for s in imported.supports if s.name == "foot_left")
    compliance = np.zeros(6)
    compliance[list(springs)] = 1 / np.array(list(springs.values()))
    known = support.loads, support.own, support.mass, support.inertia, compliance
    given = Yielding(*known, support.held_by, support.carried_by)
    soft, heavy = imported.stiffness.toarray() + given.stiffness, imported.mass.toarray() + given.carried
    built, sets = frame.frame()
    (foot,) = sets["foot_left"]
    built.held.discard(foot)
    given_way = np.zeros(6)
    given_way[list(springs)] = list(springs.values())
    built.stiffness["ground"] = [(rows_of(foot), np.diag(given_way))]
    still = {row for axis, row in enumerate(rows_of(foot)) if axis not in springs}
    free = [i for i, row in enumerate(built.free) if row not in still]
    pair = (built.matrix(kind).toarray()[np.ix_(free, free)] for kind in ("stiffness", "mass"))
    expected = hertz(*pair)
    nominal = hertz(imported.stiffness.toarray(), imported.mass.toarray())
    assert np.abs(expected / nominal - 1).max() > 0.005
    assert hertz(soft, heavy) == pytest.approx(expected, rel=TOLERATED)


def test_two_causes_at_one_support_are_springs_behind_each_other(predictor: Predictor) -> None:
    """Clamp effects at one foot add up in their compliances and bend together: not as if each were alone."""
    where = {"support": "foot_left", "stiffness": 1e6}
    shifts = LIBRARY["clamp_translation"]
    twice = shifts.state(predictor, {**where, "direction": "x"}).plus(
        shifts.state(predictor, {**where, "direction": "x"})
    )
    half = shifts.state(predictor, {**where, "direction": "x", "stiffness": 5e5})
    every = shifts.state(predictor, {**where, "direction": "all"})
    each = [shifts.state(predictor, {**where, "direction": way}) for way in "xyz"]

    def hz(state: State) -> np.ndarray:
        return predictor.predict(state, count=8).frequency

    assert hz(twice) == pytest.approx(hz(half), rel=1e-9)
    assert hz(combine(each)) == pytest.approx(hz(every), rel=1e-9)
    assert np.abs(hz(each[0]) / hz(every) - 1).max() > 1e-3
    assert shifts.repeats_on(predictor)


def test_the_mass_that_a_support_held_is_what_its_rows_had(frame: ModuleType, imported: Imported) -> None:
    """Of an even mesh of bars the mirror image is exact, but for what turning and shifting have in common."""
    built, sets = frame.frame()
    (foot,) = sets["foot_left"]
    built.held.clear()
    whole, support = built.matrix("mass").toarray(), imported.supports[0]
    own = slice(6 * (foot - 1), 6 * foot)
    assert support.name == "foot_left"
    assert np.diag(support.mass) == pytest.approx(np.diag(whole[own, own]), rel=1e-9)
    held = [
        row for other in sets["foot_left"] + sets["foot_right"] for row in range(6 * (other - 1), 6 * other)
    ]
    beside = np.delete(whole, held, axis=0)[:, own]
    assert support.inertia[:, :3] == pytest.approx(beside[:, :3], abs=1e-9 * np.abs(beside).max())


def test_another_mass_that_a_support_carries_along_moves_modes_as_its_derivative_states(
    predictor: Predictor,
) -> None:
    soft = LIBRARY["clamp_translation"].state(
        predictor, {"support": "foot_left", "stiffness": 3e5, "direction": "x"}
    )
    here = predictor.predict(soft, factors=("foot_left.carried", "foot_right.carried"), count=6)
    step = 1e-3
    low, high = (
        predictor.predict(soft.plus(State(carried={"foot_left": 1.0 + by})), count=6) for by in (-step, step)
    )
    by = np.log(high.frequency / low.frequency) / (2 * step)
    assert by.min() < -1e-4
    assert here.log_frequency_by[:, 0] == pytest.approx(by, rel=1e-3, abs=1e-3 * np.abs(by).max())
    constants = (high.constants - low.constants) / (2 * step)
    assert here.constants_by[..., 0] == pytest.approx(constants, abs=5e-3 * np.abs(constants).max())
    assert not here.log_frequency_by[:, 1].any()  # the other foot holds


def test_hypotheses_that_cannot_be(frame: ModuleType, imported: Imported) -> None:
    own = imported.stiffness
    with pytest.raises(StudyError, match="changes nothing"):
        change_of(own, own.copy(), "h")
    with pytest.raises(StudyError, match="of order 12 and the model of order"):
        change_of(own, own[:12][:, :12], "h")
    loose = change_of(own, frame.frame({"joint_1": 0.05})[0].matrix("stiffness"), "h")
    check_ends(Hypothesis("h", "", 0.0, 1.0, loose), own, imported.mass)
    with pytest.raises(StudyError, match="hypothesis 'h' at 3: stiffness matrix indefinite"):
        check_ends(Hypothesis("h", "", 0.0, 3.0, loose), own, imported.mass)


@pytest.fixture(scope="module")
def predictor(frame: ModuleType, imported: Imported) -> Predictor:
    """The frame with its beams as regions, seen from four points of the example."""
    model = frame.frame()[0]
    names = ("beam_1", "beam_2")
    parts = [tuple(model.matrix(kind, parts=[name]) for name in names) for kind in ("stiffness", "mass")]
    whole = Imported(imported.stiffness, imported.mass, imported.nodes, *parts)
    size = (whole.extents[1] - whole.extents[0]).tolist()
    regions = tuple(Region(name, (0.0, size[0]), (0.0, 1.0)) for name in names)
    spec = Spec(
        "matrices",
        length=size[0],
        width=1e-3,
        thickness=size[2],
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1.0, 1.0),
        regions=regions,
        imported=whole,
    )
    points = np.array([place for place, _ in list(frame.POINTS.values())[:4]])
    return Predictor(spec, seen_from(points, np.tile([1.0, 0.0, 0.0], (4, 1)), np.array([20.0, 300.0])))


def by_hand(made: Any, name: str, values: dict[str, Any], sets: dict[str, list[int]]) -> Any:
    """Make the change in the bars themselves."""
    from bars import rows_of

    if name == "local_mass":
        return made.matrix("stiffness"), made.matrix("mass", factors={values["region"]: values["factor"]})
    (node,) = sets[values["at"]]
    if name == "ground_spring":
        springs = np.zeros((6, 6))
        springs["xyz".index(values["along"])] = values["stiffness"] * np.eye(6)["xyz".index(values["along"])]
        made.stiffness["hidden"] = [(rows_of(node), springs)]
    else:
        inertia = values["bulk"] * values["mass"] * (values["mass"] / 7850.0) ** (2 / 3) / 6
        made.body("hidden", node, values["mass"], (inertia,) * 3)
    return made.matrix("stiffness"), made.matrix("mass")


CHANGES = [
    ("local_mass", {"region": "beam_2", "factor": 1.4}),
    ("ground_spring", {"at": "joint_3_column", "along": "x", "stiffness": 3e4}),
    ("ground_spring", {"at": "joint_1_column", "along": "y", "stiffness": 1e5}),
    ("lumped_mass", {"at": "joint_4_column", "mass": 0.3, "bulk": 2.0}),
]


@pytest.mark.parametrize(("name", "values"), CHANGES)
def test_effects_at_regions_and_node_sets_are_the_structure_built_so(
    frame: ModuleType, predictor: Predictor, name: str, values: dict[str, Any]
) -> None:
    made, sets = frame.frame()
    stiffness, mass = by_hand(made, name, values, sets)
    expected = hertz(stiffness.toarray(), mass.toarray(), 8)
    found = predictor.predict(LIBRARY[name].state(predictor, values), count=8).frequency
    assert np.abs(expected / predictor.predict(count=8).frequency - 1).max() > 0.01
    assert found == pytest.approx(expected, rel=2e-4)


def test_names_that_the_model_does_not_have(predictor: Predictor) -> None:
    for name, values, message in (
        ("local_stiffness", {"region": "web", "loss": 0.1}, "region = 'web' is not one of the model's: "
                                                            "beam_1, beam_2"),
        ("joint", {"joint": "bolt"}, "joint = 'bolt' is not one of the model's: joint_1"),
        ("ground_spring", {"at": "roof", "along": "x", "stiffness": 1.0}, "at = 'roof' is not one of the model's"),
        ("ground_spring", {"at": "joint_1_column", "along": "w", "stiffness": 1.0}, "along = 'w' is not a "
                                                                                    "direction"),
    ):  # fmt: skip
        with pytest.raises(StudyError, match=message):
            LIBRARY[name].state(predictor, values)


def test_joints_of_sets_that_are_alike_by_name_have_names_of_their_own(predictor: Predictor) -> None:
    imported = predictor.spec.imported
    assert imported is not None
    sides = [imported.nodes.sets[name] for joint in imported.joints[:2] for name in joint.sides]
    alike = {f"J_{i}": nodes for i, nodes in enumerate(sides)}
    found = joints_of(imported.places, alike, imported.stiffness)
    assert [joint.name for joint in found] == ["J_0/J_1", "J_2/J_3"]


NAMES = [
    ("bolt_3_beam", "bolt_3_column", "bolt_3"),
    ("bolt_3_rail", "bolt_3_rung", "bolt_3"),
    ("seat.upper", "seat.under", "seat"),
    ("left1", "left2", "left1/left2"),
    ("foot", "floor", "foot/floor"),
]


@pytest.mark.parametrize(("first", "second", "expected"), NAMES)
def test_a_joint_bears_the_whole_words_that_its_sides_share(first: str, second: str, expected: str) -> None:
    assert common_name(first, second) == expected
