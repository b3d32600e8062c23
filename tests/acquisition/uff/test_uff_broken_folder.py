"""A folder of broken files: each ends in one line with its place, or in a warning and the right numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from acquisition import Dof, FrfSet, Geometry, HammerTest, Hits, InputError, UffContent, read_uff, write_uff

SAMPLES = 60


def some_test() -> HammerTest:
    rng = np.random.default_rng(3)
    responses = (Dof(1, 3), Dof(2, 3))
    hits = Hits(Dof(1, 3), responses, rng.standard_normal((3, SAMPLES)), rng.standard_normal((3, 2, SAMPLES)))
    geometry = Geometry((1, 2), np.array([[0.0, 0.1, 0.2], [1.0, 0.0, 0.0]]), np.array([[1, 2]]))
    return HammerTest(1024.0, (hits,), geometry=geometry)


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> tuple[HammerTest, bytes, bytes]:
    """Return a test and what it looks like as text and in binary."""
    folder = tmp_path_factory.mktemp("good")
    test = some_test()
    for form in ("ascii", "binary"):
        write_uff(folder / f"{form}.uff", tests=test, form=form)
    return test, (folder / "ascii.uff").read_bytes(), (folder / "binary.uff").read_bytes()


def read_bytes(folder: Path, data: bytes) -> UffContent:
    path = folder / "broken.uff"
    path.write_bytes(data)
    return read_uff(path)


def same_numbers(content: UffContent, test: HammerTest, keep: tuple[int, ...] = (0, 1, 2)) -> bool:
    (back,) = content.tests
    rows = list(keep)
    pairs = ((back.points[0].force, test.points[0].force), (back.points[0].motion, test.points[0].motion))
    return all(np.allclose(one, two[rows], rtol=1e-11, atol=1e-11) for one, two in pairs)


REFUSED = {
    "empty": b"",
    "text": b"Dear colleague,\nthe measurements follow tomorrow.\n",
    "junk": bytes(range(256)) * 40,
    "zeros": b"\x00" * 3000,
    "delimiters": b"    -1\n    -1\n    -1\n",
    "picture": b"\x89PNG\r\n\x1a\n" + bytes(range(200)),
}


@pytest.mark.parametrize("name", REFUSED)
def test_no_universal_file_ends_in_one_line(tmp_path, name):
    with pytest.raises(InputError) as caught:
        read_bytes(tmp_path, REFUSED[name])
    text = str(caught.value)
    assert "broken.uff" in text and "\n" not in text and len(text) < 300


def test_folder_and_absent_file_end_in_one_line(tmp_path):
    for path in (tmp_path, tmp_path / "none.uff"):
        with pytest.raises(InputError) as caught:
            read_uff(path)
        assert str(path) in str(caught.value) and "check the path" in str(caught.value)


TRANSLATED = {
    "UTF-16 with mark": lambda text: text.decode().encode("utf-16"),
    "UTF-16 little endian": lambda text: text.decode().encode("utf-16-le"),
    "UTF-16 big endian": lambda text: text.decode().encode("utf-16-be"),
    "UTF-8 with mark": lambda text: b"\xef\xbb\xbf" + text,
    "line ends of Windows": lambda text: text.replace(b"\n", b"\r\n"),
    "line ends of old Macs": lambda text: text.replace(b"\n", b"\r"),
    "blank lines between sets": lambda text: text.replace(b"    -1\n    58", b"    -1\n    58").replace(
        b"    -1\n    -1\n", b"    -1\n\n\n    -1\n"
    ),
    "trailing blanks": lambda text: text.replace(b"\n", b"          \n"),
    "end-of-file mark": lambda text: text + b"\x1a",
    "Fortran's D": lambda text: text.replace(b"e+00", b"D+00").replace(b"e-01", b"D-01"),
}


@pytest.mark.parametrize("name", TRANSLATED)
def test_unusual_text_reads_right(tmp_path, good, name):
    test, text, _ = good
    content = read_bytes(tmp_path, TRANSLATED[name](text))
    assert same_numbers(content, test)
    assert all(info.ok for info in content.datasets)
    assert np.array_equal(content.geometry.coordinates, test.geometry.coordinates)
    assert len(content.warnings) == (1 if name.startswith("UTF-16") else 0)


def test_utf_16_cut_in_half_a_character_is_refused(tmp_path, good):
    with pytest.raises(InputError, match="broken"):
        read_bytes(tmp_path, good[1].decode().encode("utf-16")[:-101])


def test_tabs_instead_of_columns(tmp_path, good):
    """A program that turned every run of blanks between numbers of the header into tabs."""
    test, text, _ = good
    lines = text.split(b"\n")
    for i, line in enumerate(lines):
        if (
            line.startswith((b"    1         0", b"         4        60"))
            or b"NONE                 NONE" in line
        ):
            lines[i] = b"\t".join(line.split())
    content = read_bytes(tmp_path, b"\n".join(lines))
    assert any(b"\t" in line for line in lines) and same_numbers(content, test)


def third(text: bytes, old: bytes, new: bytes) -> bytes:
    """Replace the fourth occurrence: data set of the second force."""
    parts = text.split(old)
    return old.join(parts[:4]) + new + old.join(parts[4:])


FAULTS = {
    "zero points": (b"        60         1", b"         0         1", "0 points"),
    "points as words": (b"        60         1", b"     sixty         1", "sixty"),
    "more points than there are": (b"        60         1", b"      6000         1", "6000"),
    "ordinate type": (b"         4        60", b"         7        60", "7"),
    "no increment": (b" 9.765625e-04", b" 0.000000e+00", "increment"),
    "infinite increment": (b" 9.765625e-04", b"          inf", "finite"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_of_one_header_costs_its_hit(tmp_path, good, name):
    test, text, _ = good
    old, new, word = FAULTS[name]
    assert old in text
    content = read_bytes(tmp_path, third(text, old, new))
    assert same_numbers(content, test, (0, 2))
    (bad,) = [info for info in content.datasets if not info.ok]
    assert word in bad.message
    (stated,) = [w for w in content.warnings if bad.message in w]
    assert stated.startswith(f"broken.uff, data set 58 at line {bad.line}: ") and "\n" not in stated
    lines = text.split(b"\n")
    assert lines[bad.line - 1].strip() == b"-1" and b"hit 2 at 1+Z: force" in lines[bad.line + 1]


def test_direction_that_does_not_exist_is_said(tmp_path, good):
    _, text, _ = good
    content = read_bytes(tmp_path, text.replace(b"         1   3", b"         1   9"))
    assert content.tests == () and any("direction code 9" in w for w in content.warnings)


@pytest.mark.parametrize("count", ["         0", "       100", "   9999999"])
def test_wrong_number_of_bytes(tmp_path, good, count):
    test, _, binary = good
    announced = b"          11         480"
    assert announced in binary
    content = read_bytes(tmp_path, binary.replace(announced, b"          11  " + count.encode()))
    assert same_numbers(content, test)


def test_unknown_sets_and_units_that_are_none(tmp_path, good):
    test, text, _ = good
    extra = b"    -1\n  3333\nwhatever\n    -1\n"
    content = read_bytes(tmp_path, extra + text.replace(b"\n   164\n", b"\n   165\n"))
    assert same_numbers(content, test)
    assert [i.number for i in content.datasets[:3]] == [3333, 151, 165]
    assert any("no data set 164" in w for w in content.warnings)


def test_units_that_cannot_be_meant(tmp_path, good):
    test, text, _ = good
    content = read_bytes(tmp_path, text.replace(b"1.00000000000000000D+00", b"1.00000000000000000D+99"))
    (bad,) = [i for i in content.datasets if not i.ok]
    assert bad.number == 164 and same_numbers(content, test)


def test_different_axes_are_separate_tests(tmp_path):
    one, two = some_test(), some_test()
    write_uff(tmp_path / "a.uff", tests=[one, HammerTest(2048.0, two.points)])
    content = read_uff(tmp_path / "a.uff")
    assert {t.rate for t in content.tests} <= {1024.0, 2048.0}
    assert sum(p.count for t in content.tests for p in t.points) in (0, 6)
    assert len(content.tests) == 2 or content.warnings


def test_one_bad_file_costs_none_of_the_others(tmp_path, good):
    test, text, binary = good
    (tmp_path / "1.uff").write_bytes(binary)
    for name, data in REFUSED.items():
        (tmp_path / f"{name}.uff").write_bytes(data)
    (tmp_path / "cut.uff").write_bytes(text[:500])
    paths = [
        *(tmp_path / f"{name}.uff" for name in REFUSED),
        tmp_path,
        tmp_path / "cut.uff",
        tmp_path / "1.uff",
    ]
    content = read_uff(paths)
    assert same_numbers(content, test)
    for name in REFUSED:
        assert any(f"{name}.uff" in w and "left out" in w for w in content.warnings)
    assert sum(i.number == 0 and not i.ok for i in content.datasets) == len(REFUSED) + 1


def test_only_bad_files_end_in_one_line(tmp_path):
    (tmp_path / "a.uff").write_bytes(b"hello")
    (tmp_path / "b.uff").write_bytes(b"")
    with pytest.raises(InputError, match=r"a\.uff.*b\.uff"):
        read_uff([tmp_path / "a.uff", tmp_path / "b.uff"])
    with pytest.raises(InputError, match="no file"):
        read_uff([])


@pytest.mark.parametrize("name", ["case1", "case3", "case5", "case6"])
def test_twins_are_identical_at_their_precision(shared_data, name):
    from acquisition import read_functions

    twins = [shared_data(f"uff/UFFFiles.jl/dataset58_{name}_{kind}.unv") for kind in ("ascii", "binary")]
    (text,), (binary,) = (read_functions(path) for path in twins)
    assert text.header == binary.header and len(text.values) == len(binary.values)
    digits = 6 if binary.values.dtype.itemsize in (4, 8) and binary.header.item_size == 4 else 12
    for one, two in zip(
        text.values.view(float), binary.values.astype(text.values.dtype).view(float), strict=True
    ):
        assert f"{one:.{digits - 1}e}" == f"{two:.{digits - 1}e}" or one == pytest.approx(
            two, rel=10.0 ** (1 - digits)
        )
    contents = [read_uff(path) for path in twins]
    assert (contents[0].frfs is None) == (contents[1].frfs is None)
    if contents[0].frfs is not None and contents[1].frfs is not None:
        assert np.array_equal(contents[0].frfs.frequency, contents[1].frfs.frequency)


FUZZ = settings(
    max_examples=150,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@pytest.fixture(scope="module")
def seeds(tmp_path_factory) -> list[bytes]:
    """Return small valid files of every kind that is written."""
    from acquisition import ModalData

    folder = tmp_path_factory.mktemp("seeds")
    rng = np.random.default_rng(5)
    geometry = Geometry((1, 2), rng.standard_normal((2, 3)), np.array([[1, 2]]))
    responses = (Dof(1, 3),)
    hits = HammerTest(
        100.0, (Hits(Dof(1, 3), responses, np.ones((2, 12)), np.ones((2, 1, 12))),), geometry=geometry
    )
    frfs = FrfSet(
        np.arange(8.0), rng.standard_normal((1, 8)) + 0j, responses, responses, coherence=np.ones((1, 8))
    )
    modal = ModalData(
        frequency=np.array([5.0]),
        frequency_sigma=np.array([0.1]),
        damping=np.array([0.01]),
        damping_sigma=None,
        dofs=responses,
        shapes=np.ones((1, 1)) + 0j,
    )
    system = b"    -1\n    18\n         1         1         0         8         1\nCS1\n" + (
        b"  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00  1.00000e+00  0.00000e+00\n"
        b"  0.00000e+00  0.00000e+00  1.00000e+00\n    -1\n"
    )
    files = []
    for form in ("ascii", "binary"):
        path = folder / f"{form}.uff"
        write_uff(path, tests=hits, frfs=frfs, modal=modal, geometry=geometry, form=form)
        files.append(path.read_bytes() + system)
    return files


@FUZZ
@given(which=st.integers(0, 1), share=st.floats(0, 1))
def test_fuzz_cut_anywhere(tmp_path, seeds, which, share):
    data = seeds[which]
    try:
        read_bytes(tmp_path, data[: int(share * len(data))])
    except InputError as error:
        assert "broken.uff" in str(error) and "\n" not in str(error)


@pytest.mark.long
@FUZZ
@given(
    which=st.integers(0, 1),
    flips=st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(0, 255)), min_size=1, max_size=8),
)
@example(which=0, flips=[(0.0, 0)])
def test_fuzz_bytes_flipped(tmp_path, seeds, which, flips):
    data = bytearray(seeds[which])
    for share, value in flips:
        data[int(share * len(data))] = value
    try:
        read_bytes(tmp_path, bytes(data))
    except InputError as error:
        assert "broken.uff" in str(error)


@pytest.mark.long
@FUZZ
@given(
    which=st.integers(0, 1),
    place=st.floats(0, 1, exclude_max=True),
    junk=st.sampled_from(
        [b"9", b"-", b".", b"E9", b"1e300", b"-1\n", b"nan", b"\t", b"\n", b" 99999999 ", b"0"]
    ),
)
def test_fuzz_digits_and_signs(tmp_path, seeds, which, place, junk):
    data = seeds[which]
    at = int(place * len(data))
    try:
        read_bytes(tmp_path, data[:at] + junk + data[at + len(junk) :])
    except InputError as error:
        assert "broken.uff" in str(error)
