"""Files made by others: right numbers, or a clear word."""

from __future__ import annotations

import numpy as np
import pytest
import pyuff

from acquisition import Dof, estimate_frfs, judge_hits, read_functions, read_uff
from acquisition.uff.functions.header58 import Axis
from acquisition.uff.functions.units import Units, ratio_of, to_si, unit_of, units_of
from acquisition.units import GRAVITY

TWINS = ("case1", "case3", "case5", "case6")


@pytest.mark.parametrize("case", TWINS)
def test_twins_read_alike(shared_data, case):
    (text,) = read_functions(shared_data(f"uff/UFFFiles.jl/dataset58_{case}_ascii.unv"))
    (binary,) = read_functions(shared_data(f"uff/UFFFiles.jl/dataset58_{case}_binary.unv"))
    assert text.header == binary.header
    printed = 1e-12 if text.header.item_size == 8 else 5e-6
    assert np.allclose(text.values, binary.values, rtol=printed, atol=0)
    assert np.allclose(text.abscissa, binary.abscissa, rtol=5e-6, atol=0)
    assert len(text.values) == text.header.points


def test_uneven_double_binary(shared_data):
    (function,) = read_functions(shared_data("uff/UFFFiles.jl/dataset58_case6_binary.unv"))
    assert function.abscissa[0] == 10.0 and function.abscissa[-1] == 1000.0
    assert np.all(np.diff(function.abscissa) > 0)
    content = read_uff(shared_data("uff/UFFFiles.jl/dataset58_case6_binary.unv"))
    assert content.frfs is None and any("unevenly spaced" in w for w in content.warnings)


@pytest.mark.parametrize(("name", "kind"), [("FRF", 4), ("coh", 6)])
def test_padding_of_the_last_line_is_no_data(shared_data, name, kind):
    (function,) = read_functions(shared_data(f"uff/UFFFiles.jl/dataset58_{name}.unv"))
    assert len(function.values) == 1600 and function.header.function_type == kind
    assert function.values[-1] != 0


def test_frf_and_coherence_of_two_files_find_each_other(shared_data):
    names = ("uff/UFFFiles.jl/dataset58_coh.unv", "uff/UFFFiles.jl/dataset58_FRF.unv")
    content = read_uff([shared_data(name) for name in names])
    assert content.frfs is not None and content.frfs.coherence is not None
    assert content.frfs.form == "mobility"  # the unit says (m/s)/N though the label says receptance
    assert (content.frfs.responses[0], content.frfs.references[0]) == (Dof(1, -3), Dof(56, 3))
    assert content.frfs.coherence.min() >= 0 and content.frfs.coherence.max() <= 1


def test_file_with_fewer_points_than_announced_is_refused_in_words(shared_data):
    content = read_uff(shared_data("uff/pyuff/dataset_milestone_in_header.uff"))
    (info,) = content.datasets
    assert not info.ok and "2508876" in info.message and "42" in info.message


def test_whole_number_with_a_point(shared_data):
    (function,) = read_functions(shared_data("uff/UFFFiles.jl/uff58_nospacing_sample.uff"))
    assert len(function.values) == 11
    assert function.values[:3].tolist() == [-3.09944e-4, -2.74181e-4, -0.00115633]
    assert function.notes  # the surplus numbers are spoken of


def test_latin_1_header(shared_data):
    content = read_uff(shared_data("uff/pyuff/non_ascii_header.uff"))
    assert content.frfs is not None and content.frfs.values.shape == (1, 6)
    assert content.frfs.values[0, 2] == 0.025875 - 2.30085e-4j
    assert content.frfs.form == "accelerance" and content.frfs.df == 0.1953125


def test_last_line_not_filled(shared_data):
    (function,) = read_functions(shared_data("uff/pyuff/time-history-not-all-columns-filled.uff"))
    assert len(function.values) == 13 and function.values[-1] == -5.84096


def test_raw_hits_give_the_coherence_their_authors_saw(shared_data):
    content = read_uff(shared_data("impacts/pyFRF/hits.uff"))
    (test,) = content.tests
    assert (test.rate, test.samples, test.form, content.warnings) == (25600.0, 25600, "accelerance", ())
    (hits,) = test.points
    assert (hits.reference, hits.responses, hits.count) == (Dof(1, 3), (Dof(2, 3),), 5)
    peaks = hits.force.max(axis=-1)
    assert peaks.min() > 68 and peaks.max() < 90
    frfs = estimate_frfs(test)
    assert np.median(frfs.band(50.0, 5000.0).coherence) == pytest.approx(0.999, abs=5e-4)
    verdicts = judge_hits(test)
    assert all(v.used for v in verdicts)
    assert np.mean([v.band10 for v in verdicts]) == pytest.approx(3700, rel=0.1)
    assert np.mean([v.band20 for v in verdicts]) == pytest.approx(7200, rel=0.1)


def test_modelab_beam(shared_data):
    content = read_uff(shared_data("frf/ModeLAB/beam.uff"))
    assert content.frfs is not None and content.frfs.values.shape == (9, 51201)
    assert content.frfs.df == 5 / 256
    assert {str(d) for d in content.frfs.responses} == {"4-X"}
    assert content.geometry.at([4])[0, 2] == 0.5
    near = content.frfs.band(111.0, 113.0)
    peak = near.frequency[np.abs(near.values).sum(axis=0).argmax()]
    assert peak == pytest.approx(111.993, abs=0.02)


@pytest.mark.parametrize(
    "name",
    ["measurement.uff", "MPSTD#Set001_2024_10_08_10_27_07.uff", "Sample_UFF58b_bin.uff"],
)
def test_same_numbers_as_pyuff_where_it_reads_rightly(shared_data, name):
    path = shared_data(f"uff/pyuff/{name}")
    theirs = pyuff.UFF(str(path)).read_sets()
    theirs = [theirs] if isinstance(theirs, dict) else theirs
    ours = read_functions(path)
    assert len(ours) == len(theirs)
    for one, two in zip(ours, theirs, strict=True):
        assert np.array_equal(one.values, two["data"])
        assert one.header.points == two["num_pts"] and one.header.function_type == two["func_type"]
        assert one.header.response == Dof(two["rsp_node"], two["rsp_dir"])


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("pyuff/2411 and 2414.uff", 441),
        ("pyuff/Artemis export - Geometry RPBC_setup_05_14102016_105117.uff", 74),
        ("pyuff/TestLab 161 164 18 15 82.uff", 36),
        ("pyuff/mesh_Oros-modal_uff15_uff2412.uff", 96),
        ("UFFFiles.jl/dataset15.unv", 7),
        ("UFFFiles.jl/dataset2411.unv", 289),
    ],
)
def test_nodes_of_other_programs(shared_data, name, count):
    content = read_uff(shared_data(f"uff/{name}"))
    assert len(content.geometry.nodes) == count and all(info.ok for info in content.datasets)


def test_inches_and_pounds(shared_data):
    path = shared_data("uff/UFFFiles.jl/dataset151_164_58_55.unv")
    content = read_uff(path)
    (raw,) = read_functions(path)
    assert content.frfs is not None
    assert np.allclose(content.frfs.values, raw.values * 0.0254 / 4.4482216152605, rtol=1e-12)


def test_real_modes_of_data_set_55(shared_data):
    content = read_uff(shared_data("uff/pyuff/uff55_translation.uff"))
    assert content.modal is not None and np.allclose(content.modal.frequency, [10, 12, 13], rtol=1e-14)
    assert not content.modal.scaled and content.modal.shapes[0, 0] == -1.46518


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("m/s^2", ("accelerance", 1.0)),
        ("m/s²", ("accelerance", 1.0)),
        ("mm/s2", ("accelerance", 1e-3)),
        ("g", ("accelerance", GRAVITY)),
        ("in/s", ("mobility", 0.0254)),
        ("mm", ("receptance", 1e-3)),
        ("kN", ("force", 1e3)),
        ("lbf", ("force", 4.4482216152605)),
        ("V", None),
        ("", None),
    ],
)
def test_units_of_labels(label, expected):
    assert unit_of(label) == expected


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("(m/s)/N", ("mobility", 1.0)),
        ("(1/N)*(m/s2)", ("accelerance", 1.0)),
        ("g/N", ("accelerance", GRAVITY)),
        ("mm/kN", ("receptance", 1e-6)),
        ("g/g", None),
    ],
)
def test_units_of_ratios(label, expected):
    assert (
        ratio_of(label) == pytest.approx(expected) if expected is None else ratio_of(label)[0] == expected[0]
    )
    if expected is not None:
        assert ratio_of(label)[1] == pytest.approx(expected[1], rel=1e-12)


@pytest.mark.parametrize(
    ("code", "metre", "newton"), [(1, 1.0, 1.0), (5, 1e3, 1e3), (7, 39.37007874015748, 0.22480894309971)]
)
def test_unit_systems_by_code_alone(code, metre, newton):
    units, note = units_of(code, 0.0, 0.0)
    assert (units.length, units.force) == (pytest.approx(metre), pytest.approx(newton)) and note


def test_acceleration_in_g_whatever_data_set_164_says():
    axis = Axis(12, 0, 0, "Acceleration", "g")
    assert to_si(axis, Units(1000.0, 1000.0, True)) == ("accelerance", GRAVITY)
    assert to_si(Axis(12, 0, 0, "", "NONE"), Units(1000.0, 1000.0, True)) == (
        "accelerance",
        pytest.approx(1e-3),
    )


def test_rotations_carry_angles_and_moments():
    inches = Units(39.37007874015748, 0.22480894309971, True)
    assert to_si(Axis(12, 0, 0, "", ""), inches, rotation=True) == ("accelerance", 1.0)
    assert to_si(Axis(13, 0, 0, "", ""), inches, rotation=True)[1] == pytest.approx(0.0254 * 4.4482216152605)
