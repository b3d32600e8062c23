"""Node sets, joints and supports of imported matrices against the same structures put together by hand."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.linalg import eigh

from acquisition.errors import StudyError
from updating.models.imported import Imported
from updating.models.imported.hypothesis import Hypothesis, change_of, check_ends
from updating.models.imported.nodes import read_table
from updating.models.imported.sets import sets_of_table

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"


@pytest.fixture(scope="module")
def frame() -> Iterator[ModuleType]:
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(EXAMPLES))
    import frame  # type: ignore[import-not-found]

    yield frame
    patch.undo()
    for name in ("frame", "bars", "hits"):
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def imported(frame: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Imported:
    model, sets = frame.frame()
    path = tmp_path_factory.mktemp("frame") / "nodes.csv"
    path.write_text(model.table(sets))
    stiffness = model.matrix("stiffness")
    return Imported(stiffness, model.matrix("mass"), read_table(path, stiffness.shape[0]))


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


@pytest.mark.parametrize(("axis", "stiffness"), [(0, 1e6), (2, 3e6), (3, 500.0), (4, 2000.0)])
def test_a_support_that_gives_way_is_the_structure_on_a_spring(
    frame: ModuleType, imported: Imported, axis: int, stiffness: float
) -> None:
    """The rows of the support are lost; the other structure has them, on stiff springs and one soft one.

    What is left is the mass of half an element, which moves there and not here.
    """
    from bars import rows_of  # type: ignore[import-not-found]

    support = next(s for s in imported.supports if s.name == "foot_left")
    load = support.loads[:, [axis]]
    soft = imported.stiffness.toarray() - load @ load.T / (support.own[axis, axis] + stiffness)
    built, sets = frame.frame()
    (foot,) = sets["foot_left"]
    built.held.discard(foot)
    springs = np.array([1e12] * 3 + [1e10] * 3)
    springs[axis] = stiffness
    built.stiffness["ground"] = [(rows_of(foot), np.diag(springs))]
    expected = hertz(built.matrix("stiffness").toarray(), built.matrix("mass").toarray())
    nominal = hertz(imported.stiffness.toarray(), imported.mass.toarray())
    assert np.abs(expected / nominal - 1).max() > 0.005
    assert hertz(soft, imported.mass.toarray()) == pytest.approx(expected, rel=4e-4)


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
