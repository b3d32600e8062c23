"""What is written is read back bit for bit, by us and by pyuff."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyuff
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from acquisition import (
    Dof,
    FrfSet,
    Geometry,
    HammerTest,
    Hits,
    InputError,
    ModalData,
    estimate_frfs,
    read_uff,
    write_uff,
)
from acquisition.uff.functions.measurements import simplest_within
from acquisition.uff.writing.data_sets import field13

PART = st.just(0.0) | st.floats(1e-30, 1e9) | st.floats(-1e9, -1e-30)
"""What a rig measures; of less than 1e-30 the last byte may be that of a line end, and such a file is refused."""

FINITE = st.floats(-1e12, 1e12, allow_nan=False)
SAME_FOLDER = settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])


def some_test(rng: np.random.Generator, rate: float = 4096.0, decay: float = 0.0) -> HammerTest:
    responses = (Dof(1, 3), Dof(2, -1))
    points = tuple(
        Hits(Dof(n, 3), responses, rng.standard_normal((3, 64)), rng.standard_normal((3, 2, 64)))
        for n in (1, 7, 9)
    )
    geometry = Geometry((1, 2, 7, 9), rng.standard_normal((4, 3)))
    return HammerTest(rate, points, "accelerance", decay, geometry)


@pytest.mark.parametrize("decay", [0.0, 3.2])
@pytest.mark.parametrize("rate", [4096.0, 25600.0, 51200.0, 1000.0, 44100.0])
def test_hammer_test_comes_back(tmp_path, rng, rate, decay):
    test = some_test(rng, rate, decay)
    write_uff(tmp_path / "a.uff", tests=test, title="plate 3")
    content = read_uff(tmp_path / "a.uff")
    assert content.warnings == () and content.title == "plate 3" and content.frfs is None
    (back,) = content.tests
    assert (back.rate, back.decay, back.form) == (rate, decay, "accelerance")
    assert back.geometry.nodes == test.geometry.nodes
    assert np.array_equal(back.geometry.coordinates, test.geometry.coordinates)
    for one, two in zip(test.points, back.points, strict=True):
        assert one.reference == two.reference and one.responses == two.responses
        assert np.array_equal(one.force, two.force) and np.array_equal(one.motion, two.motion)


@SAME_FOLDER
@given(values=hnp.arrays(np.complex128, (2, 9), elements=st.builds(complex, PART, PART)))
def test_frfs_come_back_bit_for_bit(tmp_path: Path, values):
    frfs = FrfSet(
        np.arange(9) * 0.5, values, (Dof(1, 3), Dof(2, -3)), (Dof(5, 1), Dof(5, 1)), "mobility", decay=1.5
    )
    write_uff(tmp_path / "b.uff", frfs=frfs)
    back = read_uff(tmp_path / "b.uff").frfs
    assert (
        back is not None
        and np.array_equal(back.values, values)
        and np.array_equal(back.frequency, frfs.frequency)
    )
    assert (back.responses, back.references, back.form, back.decay) == (
        frfs.responses,
        frfs.references,
        "mobility",
        1.5,
    )


def test_coherence_averages_and_variance_survive_a_file(tmp_path, rng):
    frfs = estimate_frfs(some_test(rng))
    write_uff(tmp_path / "c.uff", frfs=frfs)
    back = read_uff(tmp_path / "c.uff").frfs
    assert back is not None and np.array_equal(back.coherence, frfs.coherence)
    assert np.array_equal(back.averages, frfs.averages)
    assert 0.2 < np.median(back.variance / frfs.variance) < 5  # from coherence instead of single hits


@pytest.mark.parametrize("form", ["binary", "ascii"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_pyuff_reads_what_is_written(tmp_path, rng, form, precision):
    test = some_test(rng)
    frfs = estimate_frfs(test)
    write_uff(tmp_path / "d.uff", tests=test, frfs=frfs, form=form, precision=precision)
    sets = pyuff.UFF(str(tmp_path / "d.uff")).read_sets()
    assert [s["type"] for s in sets[:3]] == [151, 164, 2411]
    assert np.allclose(sets[2]["x"], test.geometry.coordinates[:, 0], rtol=1e-15)
    force, motion = sets[3], sets[5]
    assert (force["func_type"], force["ordinate_spec_data_type"], force["rsp_node"]) == (1, 13, 1)
    assert (motion["ordinate_spec_data_type"], motion["rsp_node"], motion["rsp_dir"]) == (12, 2, -1)
    assert (motion["ref_node"], motion["ref_dir"]) == (1, 3)
    tolerance = {"binary": 0.0, "ascii": 1e-12}[form] if precision == "double" else 1e-5
    assert np.allclose(motion["data"], test.points[0].motion[0, 1], rtol=tolerance, atol=tolerance)
    frf = [s for s in sets[3:] if s["func_type"] == 4][4]
    assert np.allclose(frf["data"], frfs.values[4], rtol=tolerance, atol=tolerance)
    assert frf["abscissa_inc"] == pytest.approx(frfs.df, rel=1e-7)
    if form == "binary":
        assert all(
            int(s["n_bytes"]) == s["data"].nbytes // (1 if precision == "double" else 2) for s in sets[3:]
        )


def test_shuffled_sets_give_the_same_test(tmp_path, rng):
    """Any order of data sets, as long as the n-th force stays the n-th."""
    test = some_test(rng)
    write_uff(tmp_path / "e.uff", tests=test)
    whole = (tmp_path / "e.uff").read_bytes()
    cut = whole.index(b"    -1\n    58b")
    (tmp_path / "f.uff").write_bytes(whole[cut:] + whole[:cut])
    one, two = read_uff(tmp_path / "e.uff").tests[0], read_uff(tmp_path / "f.uff").tests[0]
    assert np.array_equal(one.points[2].motion, two.points[2].motion)
    assert np.array_equal(one.geometry.coordinates, two.geometry.coordinates)


def test_several_files_are_one_test(tmp_path, rng):
    test = some_test(rng)
    for number, point in enumerate(test.points):
        write_uff(tmp_path / f"{number}.uff", tests=replace(test, points=(point,)))
    content = read_uff([tmp_path / f"{number}.uff" for number in range(3)])
    assert [p.reference for p in content.tests[0].points] == [p.reference for p in test.points]
    assert content.warnings == ()


def test_modes_come_back(tmp_path):
    modal = ModalData(
        frequency=np.array([10.123456789, 20.0]),
        frequency_sigma=np.array([0.1, 0.1]),
        damping=np.array([0.01, 0.02]),
        dofs=(Dof(1, 3), Dof(2, 3)),
        shapes=np.array([[1.2, 0.5], [0.3 + 0.1j, -2]]),
        scaled=True,
    )
    write_uff(tmp_path / "m.uff", modal=modal)
    back = read_uff(tmp_path / "m.uff").modal
    assert back is not None and back.scaled and back.dofs == modal.dofs
    assert np.allclose(back.frequency, modal.frequency, rtol=1e-11)
    assert np.allclose(back.damping, modal.damping, rtol=1e-5)
    assert np.allclose(back.shapes, modal.shapes, rtol=1e-5)


def test_nothing_is_left_behind_when_writing_fails(tmp_path, rng):
    test = some_test(rng)
    with pytest.raises(InputError, match="cannot be written"):
        write_uff(tmp_path / "no" / "folder.uff", tests=test)
    with pytest.raises(InputError, match="nothing to write"):
        write_uff(tmp_path / "x.uff")
    assert list(tmp_path.iterdir()) == []


@given(st.floats(1e-9, 1e9))
def test_header_numbers_keep_their_digits(value):
    text = field13(value)
    assert len(text) == 13 and text[0] == " "
    assert float(text) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize(
    ("printed", "exact"),
    [(2.44141e-4, 1 / 4096), (1.95312e-2, 1 / 51.2), (5e-5, 5e-5), (1.52588e-5, 1 / 65536)],
)
def test_short_spacings_get_their_digits_back(printed, exact):
    assert simplest_within(printed, 0.5 * 10.0 ** (np.floor(np.log10(printed)) - 5)) == pytest.approx(
        exact, rel=1e-14
    )
