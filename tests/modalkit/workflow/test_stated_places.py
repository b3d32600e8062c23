"""Points and directions that a study states, and how they are matched to the nodes of matrices."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy import linalg, sparse

from acquisition import StudyError
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from updating.correlation.correlate import correlate

COUNT = 6
SKEW = np.array([0.6, 0.0, 0.8])


def mast(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Write a mast of masses that moves along x and z, not alike; return frequencies and shapes (nodes, 2, modes)."""
    step = np.diag(np.full(COUNT, 2.0)) - np.diag(np.ones(COUNT - 1), 1) - np.diag(np.ones(COUNT - 1), -1)
    step[-1, -1] = 1.0
    stiffness = np.kron(1e6 * step, np.diag([1.0, 1.7])) + np.kron(
        np.diag(np.linspace(1e4, 3e5, COUNT)), [[1, -1], [-1, 1]]
    )
    mass = np.diag(np.repeat(np.linspace(2.0, 1.0, COUNT), 2))
    for name, matrix in (("k", stiffness), ("m", mass)):
        sparse.save_npz(folder / f"{name}.npz", sparse.csr_array(matrix))
    rows = [
        f"{node}, 0, {node}, 0, {direction}, {2 * node - (1 if direction == 1 else 0)}"
        for node in range(1, COUNT + 1)
        for direction in (1, 3)
    ]
    (folder / "nodes.csv").write_text("\n".join(["node, x, y, z, direction, row", *rows]) + "\n")
    values, vectors = linalg.eigh(stiffness, mass)
    return np.sqrt(values) / (2 * np.pi), vectors.reshape(COUNT, 2, -1)


def opened(folder: Path, columns: dict[str, np.ndarray], test: str = "", places: str = "") -> Session:
    """Open a study of a table of modes with some columns of shapes, and rows of coordinates if there are any."""
    frequency, _ = mast(folder)
    lines = [",".join(["frequency", "sigma", *columns])]
    lines += [
        ",".join([f"{f}", f"{1e-4 * f}", *(f"{c[i]}" for c in columns.values())])
        for i, f in enumerate(frequency[:5])
    ]
    (folder / "modes.csv").write_text("\n".join(lines) + "\n" + places)
    model = '[model]\ntype = "matrices"\nstiffness = "k.npz"\nmass = "m.npz"\nnodes = "nodes.csv"\n'
    (folder / "study.toml").write_text(f'[test]\nmodes = "modes.csv"\n{test}\n{model}')
    return open_study(read_study(folder / "study.toml"))


def along(shapes: np.ndarray, direction: np.ndarray) -> dict[int, np.ndarray]:
    return {node + 1: shapes[node].T @ direction[[0, 2]] for node in range(COUNT)}


def test_points_without_coordinates_are_the_nodes_of_the_model(tmp_path: Path) -> None:
    _, shapes = mast(tmp_path)
    columns = {f"{n}+X": c for n, c in along(shapes, np.array([1.0, 0, 0])).items()}
    session = opened(tmp_path, columns)
    assert session.case.measured.points == pytest.approx(np.outer(np.arange(1, COUNT + 1), [0, 1, 0]))
    assert correlate(session.case).table["MAC"].to_numpy() == pytest.approx(1.0)
    assert any("placed at the model's node" in warning for warning in session.case.measured.warnings)


def test_places_stand_in_the_study(tmp_path: Path) -> None:
    _, shapes = mast(tmp_path)
    columns = {f"{10 + n}+X": c for n, c in along(shapes, np.array([1.0, 0, 0])).items()}
    places = ", ".join(f"{10 + n} = [1.0, {n}, 0]" for n in range(1, COUNT + 1))
    session = opened(tmp_path, columns, f"places = {{ {places} }}\naxes = {{ origin = [1.0, 0, 0] }}")
    assert correlate(session.case).table["MAC"].to_numpy() == pytest.approx(1.0)
    with pytest.raises(StudyError, match="places name point 99; points of the test are 11, 12"):
        opened(tmp_path, columns, "places = { 99 = [0, 0, 0] }")


@pytest.mark.parametrize("sign", ["+", "-"])
def test_sensors_point_where_the_study_says(tmp_path: Path, sign: str) -> None:
    _, shapes = mast(tmp_path)
    columns = {f"{n}{sign}X": c for n, c in along(shapes, SKEW).items()}
    stated = ", ".join(f'"{n}{sign}X" = [3.0, 0, 4.0]' for n in range(1, COUNT + 1))
    session = opened(tmp_path, columns, f"directions = {{ {stated} }}")
    assert np.abs(session.case.measured.directions) == pytest.approx(np.tile(SKEW, (COUNT, 1)))
    assert correlate(session.case).table["MAC"].to_numpy() == pytest.approx(1.0)
    assert correlate(opened(tmp_path, columns).case).table["MAC"].min() < 0.99


def test_directions_that_mean_nothing_are_refused(tmp_path: Path) -> None:
    columns = {"1+X": np.ones(5), "2+X": np.ones(5)}
    for stated, why in (
        ('"9+X" = [1, 0, 0]', "9+X, a point"),
        ('"1+X" = [0, 0, 0]', "give a translation and a vector"),
        ('"1X" = [1, 0, 0]', "not a degree of freedom"),
    ):
        with pytest.raises(StudyError, match=why.replace("+", r"\+")):
            opened(tmp_path, columns, f"directions = {{ {stated} }}")


def test_a_tolerance_puts_points_off_the_model_on_its_nodes_or_refuses_them(tmp_path: Path) -> None:
    _, shapes = mast(tmp_path)
    columns = {f"{n}+X": c for n, c in along(shapes, np.array([1.0, 0, 0])).items()}
    beside = ", ".join(f"{n} = [2.5, {n}.1, 0]" for n in range(1, COUNT + 1))
    with pytest.raises(StudyError, match=r"off the imported structure.*match_tolerance"):
        opened(tmp_path, columns, f"places = {{ {beside} }}")
    session = opened(tmp_path, columns, f"places = {{ {beside} }}\nmatch_tolerance = 2.6")
    assert session.case.measured.points == pytest.approx(np.outer(np.arange(1, COUNT + 1), [0, 1, 0]))
    assert any("put on its nearest nodes" in warning for warning in session.case.measured.warnings)
    with pytest.raises(StudyError, match=r"more than match_tolerance = 100 mm"):
        opened(tmp_path, columns, f"places = {{ {beside} }}\nmatch_tolerance = 0.1")


def test_the_sigma_of_shapes_is_stated_or_guessed(tmp_path: Path) -> None:
    _, shapes = mast(tmp_path)
    columns = {f"{n}+X": c for n, c in along(shapes, np.array([1.0, 0, 0])).items()}
    test = opened(tmp_path, columns, "shape_sigma = 0.05").case.measured
    size = np.sqrt(np.mean(test.constants**2, axis=0))
    assert test.constants_sigma == pytest.approx(0.05 * size * np.ones_like(test.constants))
    assert not test.guessed
    assert opened(tmp_path, columns).case.measured.guessed
    study = tmp_path / "study.toml"
    study.write_text('[test]\nfiles = ["a.uff"]\nshape_sigma = 0.1\n')
    with pytest.raises(StudyError, match="shape_sigma is for modes"):
        read_study(study)
