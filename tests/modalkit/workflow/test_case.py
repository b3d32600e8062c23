"""From files to FRFs to cases: every kind of input, joined, refused, or said."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition import FrfSet, Geometry, HammerTest, InputError, ModalData, StudyError, write_uff
from acquisition.dof import Dof
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
from modalkit.output.modes import write_modes
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study, process
from modalkit.workflow.identification import read

NODES = (1, 2, 3)
X = np.array([0.1, 0.25, 0.376])
FREQUENCY = np.array([28.1, 176.4])
SHAPES = np.array([[0.3, -1.5], [1.6, 1.4], [4.3, -4.3]])
GEOMETRY = Geometry(NODES, np.stack([X, 0 * X, 0 * X], axis=1))
PLAN = HammerPlan(
    rate=1024.0,
    samples=2048,
    hits=3,
    width=2e-3,
    pre_trigger=0.02,
    force_noise=0.0,
    response_noise=1e-5,
    adc_bits=None,
)
MODEL = """
[model]
type = "beam"
length = 0.376
width = 0.0305
thickness = 0.0047625
elements = 8
clamped = ["x0"]
[model.material]
E = 210e9
density = 7850.0
"""


def structure(points: tuple[int, ...] = (0, 1, 2)) -> ModalSystem:
    return modal_system(
        frequency=FREQUENCY,
        damping=np.array([0.02, 0.02]),
        response_shapes=SHAPES[2:],
        point_shapes=SHAPES[list(points)],
        responses=[Dof(3, 3)],
        points=[Dof(NODES[i], 3) for i in points],
    )


def hits(points: tuple[int, ...] = (0, 1, 2), plan: HammerPlan = PLAN) -> HammerTest:
    return hammer_test(structure(points), plan, rng=np.random.default_rng(1), geometry=GEOMETRY)


def frfs() -> FrfSet:
    lines = np.arange(0.0, 400.0, 0.25)
    system = structure()
    values = np.concatenate([system.receptance(2j * np.pi * lines, p) for p in range(3)])
    return FrfSet(
        lines,
        values * (2j * np.pi * lines) ** 2,
        (Dof(3, 3),) * 3,
        tuple(Dof(n, 3) for n in NODES),
        geometry=GEOMETRY,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("files")
    write_uff(place / "hits.uff", tests=hits())
    write_uff(place / "first.uff", tests=hits((0, 1)))
    write_uff(place / "last.uff", tests=hits((2,)))
    write_uff(place / "slow.uff", tests=hits((2,), replace(PLAN, rate=512.0)))
    write_uff(place / "frfs.uff", frfs=frfs())
    write_uff(place / "geometry.uff", geometry=GEOMETRY)
    modal = ModalData(
        frequency=FREQUENCY,
        frequency_sigma=0.01 * FREQUENCY,
        dofs=tuple(Dof(n, 3) for n in NODES),
        shapes=SHAPES.astype(complex),
        geometry=GEOMETRY,
    )
    write_uff(place / "modes.uff", modal=modal)
    (place / "modes.csv").write_text("frequency,sigma\n28.1,0.01\n176.4,0.05\n", encoding="utf-8")
    return place


def study(folder: Path, test: str, extra: str = "") -> Path:
    path = folder / "study.toml"
    path.write_text(f"[test]\n{test}\n{extra}{MODEL}", encoding="utf-8")
    return path


def test_hits_become_frfs(folder: Path) -> None:
    found = read(folder / "hits.uff")
    lines = found.frfs.frequency
    inside = (lines > 10) & (lines < 250)
    exact = np.concatenate([structure().receptance(2j * np.pi * lines, p) for p in range(3)])
    exact = exact * (2j * np.pi * lines) ** 2
    size = np.abs(exact[:, inside]).max(axis=1, keepdims=True)
    assert (np.abs(found.frfs.values - exact)[:, inside] / size).max() < 2e-3
    assert len(found.hits) == 9
    assert found.frfs.variance is not None
    assert found.identify(band=(10.0, 250.0)).modal.frequency == pytest.approx(FREQUENCY, rel=1e-4)


def test_frfs_are_taken_as_they_are(folder: Path) -> None:
    found = read(folder / "frfs.uff")
    np.testing.assert_allclose(found.frfs.values, frfs().values, rtol=1e-12, atol=1e-12)
    assert found.hits == ()


def test_several_files_are_one_test(folder: Path) -> None:
    whole = read(folder / "hits.uff").frfs
    parts = read([folder / "first.uff", folder / "last.uff"]).frfs
    assert sorted(map(str, parts.references)) == sorted(map(str, whole.references))
    order = [parts.references.index(d) for d in whole.references]
    size = np.abs(whole.values).max(axis=1, keepdims=True)
    assert (np.abs(parts.values[order] - whole.values) / size)[:, 20:500].max() < 1e-3


def test_tests_that_do_not_go_together_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="different rates, lengths"):
        read([folder / "first.uff", folder / "slow.uff"])


def test_frfs_beside_hits_are_made_afresh(folder: Path) -> None:
    found = read([folder / "hits.uff", folder / "frfs.uff"])
    assert any("estimated again" in w for w in found.warnings)
    assert len(found.frfs.responses) == 3


def test_files_without_a_test_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"geometry\.uff: neither raw hits nor FRFs.*inspect"):
        read(folder / "geometry.uff")
    with pytest.raises(InputError, match=r"nothing\.uff"):
        read(folder / "nothing.uff")


@pytest.mark.parametrize("name", ["hits.uff", "frfs.uff"])
def test_a_window_that_the_study_states_is_taken_out(folder: Path, name: str) -> None:
    """The files do not say that the records were windowed; the study does."""
    plain = read(folder / name).identify(band=(10.0, 250.0)).modal
    stated = read(folder / name, decay=1.5)
    assert stated.frfs.decay == 1.5
    assert plain.damping is not None
    found = stated.identify(band=(10.0, 250.0)).modal.damping
    assert found is not None
    assert plain.damping - found == pytest.approx(1.5 / (2 * np.pi * FREQUENCY), rel=2e-2)


def test_a_window_that_the_file_states_is_not_taken_out_twice(tmp_path: Path) -> None:
    write_uff(tmp_path / "w.uff", tests=hits(plan=replace(PLAN, decay=1.5)))
    assert read(tmp_path / "w.uff").frfs.decay == pytest.approx(1.5)
    assert read(tmp_path / "w.uff", decay=1.5).frfs.decay == pytest.approx(1.5)
    with pytest.raises(InputError, match=r"states an exponential window of 1\.5 1/s, but 4 1/s is given"):
        read(tmp_path / "w.uff", decay=4.0)
    write_uff(tmp_path / "f.uff", frfs=replace(frfs(), decay=1.5))
    if read(tmp_path / "f.uff").frfs.decay:
        with pytest.raises(InputError, match=r"1\.5 1/s, but 4 1/s"):
            read(tmp_path / "f.uff", decay=4.0)


def test_a_study_of_frfs_becomes_a_case(folder: Path) -> None:
    path = study(
        folder, 'files = ["frfs.uff"]\nband = [10.0, 250.0]\ncalibration = 0.05\nrepeatability = 0.001'
    )
    session = open_study(read_study(path))
    test = session.case.measured
    assert test.frequency == pytest.approx(FREQUENCY, rel=1e-4)
    assert (test.absolute, test.calibration, test.repeatability) == (True, 0.05, 0.001)
    where = {node: i for i, node in enumerate(test.nodes)}
    hit = [test.hit.tolist().index(where[n]) for n in NODES]
    exact = SHAPES * SHAPES[2]
    np.testing.assert_allclose(test.constants[hit], exact, rtol=0.02, atol=0.01 * np.abs(exact).max())
    assert session.case.spec.elements == (8,)
    assert session.case.title == folder.name
    assert session.identified is not None
    assert session.case.baseline is None


@pytest.mark.parametrize("name", ["modes.csv", "modes.uff"])
def test_a_study_of_modes_becomes_a_case(folder: Path, name: str) -> None:
    session = open_study(read_study(study(folder, f'modes = "{name}"')))
    assert session.case.measured.frequency == pytest.approx(FREQUENCY)
    assert (session.processed, session.identified) == (None, None)
    assert session.case.measured.has_shapes == (name == "modes.uff")
    assert not session.case.measured.absolute


@pytest.mark.parametrize("ending", ["uff", "csv", "json"])
def test_modes_that_were_written_have_the_level_that_they_were_identified_with(
    folder: Path, tmp_path: Path, ending: str
) -> None:
    written = tmp_path / f"written.{ending}"
    direct = open_study(study(folder, 'files = ["frfs.uff"]\nband = [10.0, 250.0]'))
    assert direct.identified is not None
    write_modes(written, direct.identified)
    test = open_study(study(folder, f'modes = "{written}"')).case.measured
    assert (test.absolute, test.calibration) == (True, 0.02)
    row = {test.nodes[point]: i for i, point in enumerate(test.seen.tolist())}
    known = direct.case.measured
    seen, hit = ([row[known.nodes[p]] for p in ends.tolist()] for ends in (known.seen, known.hit))
    size = np.abs(known.constants).max()
    np.testing.assert_allclose(test.constants[seen] * test.constants[hit], known.constants, atol=2e-3 * size)


def test_a_baseline_is_read_like_a_test(folder: Path) -> None:
    text = '[baseline]\nfiles = ["frfs.uff"]\nband = [10.0, 250.0]\n'
    case = open_study(read_study(study(folder, 'modes = "modes.csv"', text))).case
    assert case.baseline is not None
    assert case.baseline.frequency == pytest.approx(FREQUENCY, rel=1e-4)
    assert "baseline" in case.baseline.title
    assert not case.measured.has_shapes


def test_studies_without_data_are_refused(folder: Path) -> None:
    with pytest.raises(StudyError, match=r"study\.toml: \[test\] names no data; add files"):
        open_study(read_study(study(folder, "")))
    with pytest.raises(StudyError, match=r"study\.toml: \[baseline\] names no data"):
        open_study(read_study(study(folder, 'modes = "modes.csv"', "[baseline]\n")))
    with pytest.raises(StudyError, match="names no files to identify"):
        process(read_study(study(folder, 'modes = "modes.csv"')))


def test_files_that_are_missing_or_hold_something_else_are_named(folder: Path) -> None:
    for text, name in (('files = ["gone.uff"]', "gone.uff"), ('modes = "gone.csv"', "gone.csv")):
        with pytest.raises(InputError, match=name):
            open_study(read_study(study(folder, text)))
    with pytest.raises(InputError, match=r"frfs\.uff: holds no modes"):
        open_study(read_study(study(folder, 'modes = "frfs.uff"')))


@pytest.mark.long
def test_a_study_takes_sensors_off(folder: Path) -> None:
    path = study(folder, 'files = ["hits.uff"]\nband = [10.0, 250.0]\nsensor_masses = { "3+Z" = 0.001 }')
    processed, light = process(read_study(path))
    assert any("1 g at 3+Z" in w for w in processed.warnings)
    heavy = read(folder / "hits.uff").identify(band=(10.0, 250.0))
    # SHAPES are mass-normalised: a small mass m taken from where the shape is phi raises f by m phi^2 / 2
    gain = light.modal.frequency / heavy.modal.frequency - 1
    assert gain == pytest.approx(0.5e-3 * SHAPES[2] ** 2, rel=0.05)
