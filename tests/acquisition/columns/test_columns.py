"""Column text becomes a hammer test or FRFs in SI units, or an error with file, line and column."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import Dof, InputError, estimate_frfs, judge_hits
from acquisition.columns import layout_from, read_columns, read_frf_columns, read_layout
from identification import identify

LAYOUT = """
rate = 1000.0
[[column]]
name = "hammer"
quantity = "force"
unit = "lbf"
node = 3
direction = "-z"
[[column]]
name = "acc 1"
quantity = "acceleration"
unit = "g"
scale = 2.0
node = 1
[[column]]
name = "acc 2"
quantity = "acceleration"
unit = "mm/s^2"
node = 2
direction = "+x"
"""
POUND, GRAVITY = 4.4482216152605, 9.80665


@pytest.fixture
def records():
    generator = np.random.default_rng(5)
    return np.round(generator.standard_normal((3, 40)), 6)


def written(path, records, *, separator=",", decimal=".", above="hammer{0}acc 1{0}acc 2\n", time=None):
    rows = records if time is None else np.vstack([time, records])
    lines = [separator.join(f"{v:.6f}".replace(".", decimal) for v in row) for row in rows.T]
    path.write_text(above.format(separator) + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def layout_file(tmp_path, text=LAYOUT):
    path = tmp_path / "layout.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("separator", "decimal"), [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (" | ", ".")]
)
def test_separators_and_decimals_are_recognised(tmp_path, records, separator, decimal):
    text = LAYOUT if "|" not in separator else 'separator = "|"\n' + LAYOUT
    test = read_columns(
        written(tmp_path / "a.csv", records, separator=separator, decimal=decimal),
        layout_file(tmp_path, text),
    )
    (point,) = test.points
    assert test.rate == 1000.0 and test.form == "accelerance"
    assert point.reference == Dof(3, -3) and point.responses == (Dof(1, 3), Dof(2, 1))
    np.testing.assert_allclose(point.force[0], records[0] * POUND, rtol=1e-12)
    np.testing.assert_allclose(point.motion[0], records[1:] * np.array([[2 * GRAVITY], [1e-3]]), rtol=1e-12)


def test_remarks_units_line_and_blank_separated_numbers(tmp_path, records):
    above = "# measured on a Tuesday\nDate: 2020-01-02\nhammer{0}acc 1{0}acc 2\nlbf{0}g{0}mm/s2\n"
    test = read_columns(written(tmp_path / "a.csv", records, above=above), layout_file(tmp_path))
    np.testing.assert_allclose(test.points[0].force[0], records[0] * POUND)
    numbered = {
        "rate": 1000.0,
        "column": [
            {"index": 0, "quantity": "force", "unit": "N"},
            {"index": 2, "quantity": "velocity", "unit": "mm/s", "node": 7},
        ],
    }
    plain = read_columns(
        written(tmp_path / "b.txt", records, separator="   ", above=""), layout_from(numbered)
    )
    assert plain.form == "mobility"
    np.testing.assert_allclose(plain.points[0].motion[0, 0], 1e-3 * records[2])


def test_blocks_and_files_are_hits_and_the_hammer_may_rove(tmp_path, records):
    two = tmp_path / "point_4.csv"
    one = written(tmp_path / "point_3.csv", records).read_text()
    second, third = (written(tmp_path / "hit.csv", scale * records).read_text() for scale in (2, 3))
    two.write_text(one + "\n" + second.split("\n", 1)[1] + "\n\n" + third, encoding="utf-8")
    text = LAYOUT + '[[file]]\nmatch = "point_4*"\nnode = 4\ndirection = "+y"\n'
    test = read_columns([tmp_path / "point_3.csv", two], layout_file(tmp_path, text))
    assert [(p.reference, p.count) for p in test.points] == [(Dof(3, -3), 1), (Dof(4, 2), 3)]
    np.testing.assert_allclose(test.points[1].force, [k * test.points[0].force[0] for k in (1, 2, 3)])
    misspelt = layout_file(tmp_path, text.replace("point_4*", "pt_4*"))
    with pytest.raises(InputError, match=r"point_3\.csv: no \[\[file\]\] rule .*'pt_4\*' matches no file"):
        read_columns([tmp_path / "point_3.csv", two], misspelt)


def test_a_time_column_gives_the_rate_even_with_few_digits(tmp_path, records):
    time = np.round(np.arange(40) / 2048, 6)
    text = LAYOUT.replace("rate = 1000.0", 'time_column = "t"')
    path = written(tmp_path / "a.csv", records, time=time, above="t{0}hammer{0}acc 1{0}acc 2\n")
    assert read_columns(path, layout_file(tmp_path, text)).rate == pytest.approx(2048, rel=1e-4)
    time[20:] += 1 / 2048
    written(path, records, time=time, above="t{0}hammer{0}acc 1{0}acc 2\n")
    with pytest.raises(InputError, match=r"a\.csv, line 22: uneven time"):
        read_columns(path, layout_file(tmp_path, text))


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("", "0.1,0.2\n", r"line 42: 2 columns, but the block began with 3"),
        ("", "0.1,oops,0.3\n", r"line 42, column 1: 'oops' is not a number"),
        ("", "0.1,nan,0.3\n", r"line 42, column 1: 'nan' is not a number"),
        ("", "0.1,0.2,0.3,0.4\n", r"line 42: 4 columns"),
    ],
)
def test_bad_lines_are_named(tmp_path, records, before, after, message):
    path = written(tmp_path / "a.csv", records)
    path.write_text(before + path.read_text() + after, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_columns(path, layout_file(tmp_path))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rate = 1000.0", "rat = 1000.0", r"unknown key 'rat' \(is 'rate' meant\?\)"),
        ("rate = 1000.0", "", r"no sampling rate; add rate = "),
        ("rate = 1000.0", 'rate = "fast"', r"rate = 'fast' in .* names an array, but text has no arrays"),
        ("rate = 1000.0", "rate = -1.0", r"give the sampling rate in Hz"),
        ("rate = 1000.0", "rate = 1000.0\nsamples = 50", r"line 2: 40 samples; the layout asks for 50"),
        ('unit = "lbf"', 'unit = "g"', r"column 'hammer': 'g' is not a known unit of force"),
        ('unit = "lbf"', 'unti = "lbf"', r"\[\[column\]\] 1: unknown key 'unti' \(is 'unit' meant\?\)"),
        ('"force"', '"fource"', r"quantity = 'fource' \(is 'force' meant\?\)"),
        ('direction = "-z"', 'direction = "up"', r"\[\[column\]\] 1: direction 'up' is invalid"),
        (
            'name = "acc 1"',
            'name = "acc 9"',
            r"line 1: column 'acc 9' is missing; the headings are 'hammer'",
        ),
        ('name = "acc 1"', "", r"give either index \(from 0\) or name"),
        ('name = "acc 1"', "index = 7", r"no line contains 8 or more numbers"),
        (
            'quantity = "acceleration"\nunit = "g"',
            'quantity = "velocity"',
            r"responses of acceleration, velocity",
        ),
        (
            'quantity = "force"\nunit = "lbf"',
            'quantity = "acceleration"',
            r"0 columns of force and 3 of response",
        ),
    ],
)
def test_mistakes_in_the_layout_are_named(tmp_path, records, old, new, message):
    path = written(tmp_path / "a.csv", records)
    assert old in LAYOUT
    with pytest.raises(InputError, match=message):
        read_columns(path, layout_file(tmp_path, LAYOUT.replace(old, new, 1)))


def test_files_that_do_not_go_together_are_named(tmp_path, records):
    layout = layout_file(tmp_path)
    one, two = written(tmp_path / "a.csv", records), written(tmp_path / "b.csv", records[:, :30])
    with pytest.raises(InputError, match="add samples = 30 to"):
        read_columns([one, two], layout)
    with pytest.raises(InputError, match="cannot be read"):
        read_columns(tmp_path / "none.csv", layout)
    with pytest.raises(InputError, match="cannot be read"):
        read_layout(tmp_path / "none.toml")
    (tmp_path / "c.csv").write_bytes(b"\x00\x01" * 200)
    with pytest.raises(InputError, match="binary, not column text"):
        read_columns(tmp_path / "c.csv", layout)
    (tmp_path / "d.csv").write_text("nothing here\n")
    with pytest.raises(InputError, match="no line contains 3 or more numbers"):
        read_columns(tmp_path / "d.csv", layout)


def test_other_encodings_are_read(tmp_path, records):
    text = written(tmp_path / "a.csv", records).read_text().replace("hammer", "Kraft für", 1)
    layout = layout_from(
        {
            "rate": 10.0,
            "column": [
                {"name": "Kraft für", "quantity": "force"},
                {"name": "acc 1", "quantity": "displacement", "unit": "µm"},
            ],
        }
    )
    for encoding in ("latin-1", "utf-16", "utf-8-sig"):
        (tmp_path / "b.csv").write_bytes(text.encode(encoding))
        test = read_columns(tmp_path / "b.csv", layout)
        np.testing.assert_allclose(test.points[0].motion[0, 0], 1e-6 * records[1])
        assert test.form == "receptance"


def test_frf_columns_by_parts_and_by_magnitude_and_phase(tmp_path):
    frequency = np.arange(1.0, 21.0)
    frf = 1 / (100 - frequency**2 + 0.5j * frequency)
    rows = np.vstack([frequency, frf.real, frf.imag, np.abs(frf), np.angle(frf, deg=True)])
    path = tmp_path / "frf.txt"
    path.write_text(
        "f;re;im;mag;phase\n" + "\n".join(";".join(f"{v:.12g}" for v in row) for row in rows.T) + "\n"
    )
    common = {"quantity": "accelerance", "unit": "g/lbf", "reference_node": 5}
    layout = layout_from(
        {
            "frequency_column": "f",
            "column": [
                {"name": "re", "part": "real", "node": 1, **common},
                {"name": "im", "part": "imag", "node": 1, **common},
                {"name": "mag", "part": "magnitude", "node": 2, **common},
                {"name": "phase", "part": "phase", "node": 2, **common, "unit": ""},
            ],
        }
    )
    frfs = read_frf_columns(path, layout)
    assert frfs.responses == (Dof(1, 3), Dof(2, 3)) and frfs.references == (Dof(5, 3),) * 2
    np.testing.assert_allclose(frfs.values, np.stack([frf, frf]) * GRAVITY / POUND, rtol=1e-9)
    with pytest.raises(InputError, match="frequency_column"):
        read_frf_columns(path, layout_from({"column": [{"name": "re", **common}]}))
    with pytest.raises(InputError, match=r"has the parts real; give"):
        read_frf_columns(path, layout_from({"frequency_column": "f", "column": [{"name": "re", **common}]}))


LVM_COLUMNS = [
    {"name": "Force (Trigger)", "quantity": "force"},
    {"name": "Acceleration (Trigger)", "quantity": "acceleration"},
]
BEAM = np.array([695.8, 1898.1, 3671.5])


@pytest.mark.long
@pytest.mark.parametrize("names", [("acceleration",), ("acceleration", "camera")])
def test_the_free_free_beam_ends_in_its_reference_frequencies(shared_data, names):
    files = [shared_data(f"impacts/free-free-beam/{name}.lvm") for name in names]
    test = read_columns(files, layout_from({"column": LVM_COLUMNS}))
    assert test.rate == pytest.approx(50000.0) and test.samples == 50030
    assert test.points[0].count == len(names)
    model = identify(estimate_frfs(test), band=(400.0, 4500.0))
    found = np.asarray(model.modal.frequency)
    nearest = np.array([found[np.abs(found - f).argmin()] for f in BEAM])
    np.testing.assert_allclose(nearest, BEAM, rtol=1e-3)


def test_the_overloaded_accelerometer_of_the_second_beam_hit_is_seen(shared_data):
    files = [shared_data(f"impacts/free-free-beam/{name}.lvm") for name in ("acceleration", "camera")]
    verdicts = judge_hits(read_columns(files, layout_from({"column": LVM_COLUMNS})))
    assert [v.used for v in verdicts] == [True, False]
    assert "response 1+Z is clipped" in verdicts[1].reasons[0]  # it stands at 54.791435 g, nine samples long


LVM = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t,
Multi_Headings\tYes
X_Columns\tOne
***End_of_Header***\t

Channels\t2
Samples\t3\t3
Y_Unit_Label\tg\tNewtons
X_Dimension\tTime\tTime
Delta_X\t1,0E-3\t1,0E-3
***End_of_Header***
X_Value\tacc\tforce\tComment
0,000\t1,5\t-2,0\tfirst
0,001\t0,5\t3,0
0,002\t0,25\t4,0

Channels\t2
Samples\t3\t3
Y_Unit_Label\tg\tNewtons
X_Dimension\tTime\tTime
Delta_X\t1,0E-3\t1,0E-3
***End_of_Header***
X_Value\tacc\tforce\tComment
0,000\t2,5\t2,0
0,001\t1,5\t3,5
0,002\t1,25\t4,5
"""


def test_segments_of_an_lvm_file_are_hits(tmp_path):
    columns = [{"name": "force", "quantity": "force"}, {"index": 1, "quantity": "acceleration"}]
    layout = layout_from({"column": columns})
    path = tmp_path / "a.lvm"
    path.write_text(LVM)
    test = read_columns(path, layout)
    assert test.rate == pytest.approx(1000.0)
    np.testing.assert_allclose(test.points[0].force, [[-2, 3, 4], [2, 3.5, 4.5]])
    np.testing.assert_allclose(
        test.points[0].motion[:, 0], np.array([[1.5, 0.5, 0.25], [2.5, 1.5, 1.25]]) * GRAVITY
    )
    path.write_text(LVM.replace("0,002\t1,25\t4,5\n", ""))
    with pytest.raises(InputError, match=r"a\.lvm, line 27: 3 samples announced and 2 there"):
        read_columns(path, layout)
    path.write_text("\n".join(LVM.splitlines()[:9]))
    with pytest.raises(InputError, match="headers begin with Channels"):
        read_columns(path, layout)
    path.write_text(LVM)
    with pytest.raises(InputError, match="1000 Hz by its header, at 2000 Hz by"):
        read_columns(path, layout_from({"rate": 2000.0, "column": columns}))


JOINED = "C".join(LVM.replace("***End_of_Header***\n", "", 1).rsplit("Channels", 1))
"""The first segment's header without its end, the second's without its beginning."""
LVM_DAMAGE = [
    (LVM.replace("***End_of_Header***\nX_Value", "***End_of_He\nX_Value", 1), "headers begin with Channels"),
    (LVM.replace("Y_Unit_Label\tg\tNewtons\n", "", 1), "'Y_Unit_Label"),
    (LVM.replace("0,002\t1,25\t4,5\n", "0,002\t1,25\t4,5\n" * 2), "3 samples announced and 4 there"),
    (LVM.replace("0,001\t1,5\t3,5", "0,\t01\t1,5\t3,5"), "outside the 3 columns"),
    (LVM.replace("Decimal_Separator\t,\n", ""), "a header cannot be read"),
    (LVM[: LVM.index("***End")] + "***End_of_" + LVM[LVM.index("Delta_X") :], "before the first segment"),
    (JOINED, "stands in the header that begins at line"),
    (LVM.replace("Channels\t2\nS", "Channels\t"), "is not a number of channels"),
]


@pytest.mark.parametrize(("text", "words"), LVM_DAMAGE)
def test_a_damaged_lvm_file_is_refused(tmp_path, text, words):
    (tmp_path / "a.lvm").write_text(text)
    columns = [{"name": "force", "quantity": "force"}, {"name": "acc", "quantity": "acceleration"}]
    with pytest.raises(InputError, match=words):
        read_columns(tmp_path / "a.lvm", layout_from({"column": columns}))


def test_a_record_that_stands_twice_is_named(tmp_path, records):
    """Two hits never agree in every sample; at another point the same numbers may be those of a symmetric model."""
    one = written(tmp_path / "P3_1.csv", records)
    copy = written(tmp_path / "P3_2.csv", records)
    text = LAYOUT.replace("node = 3\n", "", 1) + '[[file]]\nmatch = "P{node}_*"\n'
    with pytest.raises(
        InputError,
        match=r"P3_2\.csv, line 2: the same numbers.* as .*P3_1\.csv, line 2.*give the command without .*P3_2\.csv",
    ):
        read_columns([one, copy], layout_file(tmp_path, text))
    other = written(tmp_path / "P4_1.csv", records)
    assert len(read_columns([one, other], layout_file(tmp_path, text)).points) == 2
    both = tmp_path / "P3_3.csv"
    both.write_text(f"{one.read_text()}\n{one.read_text()}")
    with pytest.raises(InputError, match="take one of the two out of the file"):
        read_columns(both, layout_file(tmp_path, text))
