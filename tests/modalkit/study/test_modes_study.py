"""Studies whose test is a table of modes: its band, its points, its damping."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from acquisition.errors import EstimationError, InputError, StudyError
from modalkit.batch.part import part_document
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.update import update_studies
from updating import LIBRARY, diagnose
from updating.prediction.matching import pair_modes
from updating.prediction.predict import Predictor

STUDY = """
[test]
modes = "modes.csv"
{keys}
[model]
type = "beam"
length = 0.376
width = 0.0305
thickness = 0.0047625
clamped = ["x0"]
[model.material]
E = 210e9
density = 7850.0
"""
POINTS = np.linspace(0.076, 0.376, 6)


def written(folder: Path, text: str, keys: str = "", study: str = STUDY) -> Path:
    (folder / "modes.csv").write_text(text)
    path = folder / "study.toml"
    path.write_text(study.format(keys=keys))
    return path


def shapes_of_a_cantilever(*, points: bool) -> str:
    """The first three modes at six points, whose coordinates the table brings or not."""
    x = POINTS / 0.376
    lines = ["frequency,sigma," + ",".join(f"{n}+Z" for n in range(1, 7))]
    lines += ["x,," + ",".join(f"{c:.6f}" for c in POINTS)] if points else []
    for root, hertz in ((1.87510407, 28.1), (4.69409113, 176.0), (7.85475744, 493.0)):
        ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
        shape = np.cosh(root * x) - np.cos(root * x) - ratio * (np.sinh(root * x) - np.sin(root * x))
        lines.append(f"{hertz},0.01," + ",".join(f"{s:.6f}" for s in shape))
    return "\n".join(lines) + "\n"


FIVE = "frequency,sigma\n28,0.01\n176,0.02\n493,0.05\n966,0.1\n1597,0.2\n"


def test_the_band_holds_for_modes_as_for_files(tmp_path: Path) -> None:
    session = open_study(read_study(written(tmp_path, FIVE, "band = [100.0, 1000.0]")))
    assert session.case.measured.frequency.tolist() == [176.0, 493.0, 966.0]
    assert any("2 of 5 modes of modes.csv lie outside the band" in w for w in session.case.measured.warnings)
    whole = open_study(read_study(written(tmp_path, FIVE)))
    assert len(whole.case.measured.frequency) == 5 and not any(
        "band" in w for w in whole.case.measured.warnings
    )


def test_the_band_holds_for_a_part_without_a_model(tmp_path: Path) -> None:
    alone = '[test]\nmodes = "modes.csv"\n{keys}\n'
    record = part_document(written(tmp_path, FIVE, "band = [100.0, 1000.0]", alone))
    assert [mode["frequency_hz"] for mode in record["modes"]] == [176.0, 493.0, 966.0]


def test_a_band_without_modes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        StudyError, match=r"band = \[1, 20\] Hz holds none of the 5 modes .* from 28 to 1597 Hz"
    ):
        open_study(read_study(written(tmp_path, FIVE, "band = [1.0, 20.0]")))


def test_shapes_of_a_table_are_compared_where_it_brings_its_points(tmp_path: Path) -> None:
    measured = open_study(read_study(written(tmp_path, shapes_of_a_cantilever(points=True)))).case.measured
    np.testing.assert_allclose(measured.points[:, 0], POINTS, atol=1e-6)
    spec = read_study(tmp_path / "study.toml").spec()
    assert len(pair_modes(measured, Predictor(spec, measured).predict()).measured.frequency) == 3
    with pytest.raises(InputError, match="rows x, y, z"):
        open_study(read_study(written(tmp_path, shapes_of_a_cantilever(points=False))))


def test_a_model_in_millimetres_is_named_by_its_frequencies(tmp_path: Path) -> None:
    """A beam of 376 x 30.5 x 4.7625 m may be; a test that is a thousand times faster says that it is not."""
    large = STUDY.replace("0.376", "376").replace("0.0305", "30.5").replace("0.0047625", "4.7625")
    session = open_study(read_study(written(tmp_path, FIVE, study=large)))
    spec = session.study.spec()
    with pytest.raises(EstimationError, match="probably the model's lengths are in mm"):
        pair_modes(session.case.measured, Predictor(spec, session.case.measured).predict())


def test_damping_that_looks_like_percent_is_doubted(tmp_path: Path) -> None:
    text = "frequency,sigma,damping\n28,0.01,0.6\n176,0.02,0.3\n"
    warnings = open_study(read_study(written(tmp_path, text))).case.measured.warnings
    assert any("damping_percent" in w for w in warnings)


def test_how_many_modes_lie_below_the_band_is_known(tmp_path: Path) -> None:
    """Without shapes the order pairs, and must begin above them."""
    assert open_study(read_study(written(tmp_path, FIVE, "band = [400.0, 1000.0]"))).case.measured.below == 2
    assert open_study(read_study(written(tmp_path, FIVE))).case.measured.below == 0


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ("", FIVE.replace("176,0.02", "28,0.01")),
        ("", "frequency,sigma\n28,0.01\n"),
    ],
)
def test_an_update_ends_whatever_the_table(tmp_path: Path, keys: str, text: str) -> None:
    """Two modes alike, one of which has no partner; one mode alone."""
    session = open_study(read_study(written(tmp_path, text, keys)))
    assert all(np.isfinite(p.value) for p in update_studies([session]).parameters)


@pytest.mark.long
def test_a_diagnosis_without_tolerances_ends(tmp_path: Path) -> None:
    none = "".join(f"{name} = 0.0\n" for name in ("E", "density", "thickness", "length", "width"))
    path = written(tmp_path, FIVE, study=STUDY + "[tolerances]\n" + none)
    found = diagnose(open_study(read_study(path)).case, library=[LIBRARY["E"], LIBRARY["lumped_mass"]])
    assert 0 <= found.p_value <= 1


def test_modes_of_a_matlab_file_are_data_of_a_study(tmp_path: Path) -> None:
    x = POINTS / 0.376
    shapes = np.stack([x**2, x**2 * (x - 0.8), x**2 * (x - 0.5) * (x - 0.9)], axis=1)
    savemat(tmp_path / "x.mat", {"fn": np.array([28.1, 176.0, 493.0]), "Phi": shapes})
    nodes = "\n".join(f"{n} = [{c}, 0.0, 0.0]" for n, c in enumerate(POINTS.tolist(), start=1))
    dofs = ", ".join(f'"{n}+Z"' for n in range(1, 7))
    (tmp_path / "layout.toml").write_text(
        f'[mat]\nfrequency = "fn"\nshapes = "Phi"\ndofs = [{dofs}]\n[nodes]\n{nodes}\n'
    )
    study = STUDY.replace("modes.csv", "x.mat")
    test = open_study(read_study(written(tmp_path, "", 'layout = "layout.toml"', study))).case.measured
    np.testing.assert_allclose(test.constants, shapes)
    np.testing.assert_allclose(test.points[:, 0], POINTS)
    with pytest.raises(StudyError, match="must state the meaning"):
        read_study(written(tmp_path, "", "", study))
    with pytest.raises(StudyError, match="layout: is for records"):
        read_study(written(tmp_path, FIVE, 'layout = "layout.toml"'))
