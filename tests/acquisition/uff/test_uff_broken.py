"""Broken files: one bad data set costs no other, and every fault is told with its place."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import Dof, FrfSet, HammerTest, Hits, InputError, read_uff, write_uff


@pytest.fixture
def test(rng) -> HammerTest:
    hits = Hits(
        Dof(1, 3), (Dof(1, 3), Dof(2, 3)), rng.standard_normal((4, 300)), rng.standard_normal((4, 2, 300))
    )
    return HammerTest(1024.0, (hits,))


@pytest.fixture
def written(tmp_path, test):
    """Return a function that writes the test, spoils its bytes and reads it again."""

    def read(spoil, form="binary"):
        write_uff(tmp_path / "a.uff", tests=test, form=form)
        (tmp_path / "b.uff").write_bytes(spoil((tmp_path / "a.uff").read_bytes()))
        return read_uff(tmp_path / "b.uff")

    return read


def _set(data: bytes, number: int) -> tuple[int, int]:
    """Return where the n-th data set 58 begins and where the next one does."""
    starts = [i for i in range(len(data)) if data.startswith(b"    -1\n    58", i)]
    return starts[number], (*starts, len(data))[number + 1]


@pytest.mark.parametrize("form", ["binary", "ascii"])
def test_file_cut_off_in_the_last_hit(written, test, form):
    content = written(lambda data: data[: len(data) - 900], form)
    (back,) = content.tests
    assert back.points[0].count == 3
    assert np.allclose(back.points[0].motion, test.points[0].motion[:3], rtol=1e-11, atol=1e-11)
    assert not content.datasets[-1].ok and "cut off" in content.datasets[-1].message
    assert any("hit 4" in w for w in content.warnings)


@pytest.mark.parametrize("form", ["binary", "ascii"])
@pytest.mark.parametrize("number", [3, 4, 5])
def test_record_cut_short_in_the_middle_costs_its_hit_only(written, test, form, number):
    def spoil(data: bytes) -> bytes:
        _, stop = _set(data, number)
        return data[: stop - 700] + data[stop:]

    content = written(spoil, form)
    (back,) = content.tests
    keep = [0, 2, 3]  # records 3 to 5 are the second hit
    assert np.allclose(back.points[0].force, test.points[0].force[keep], rtol=1e-11, atol=1e-11)
    assert np.allclose(back.points[0].motion, test.points[0].motion[keep], rtol=1e-11, atol=1e-11)
    assert sum(not info.ok for info in content.datasets) == 1


def test_garbled_number_is_quoted(written):
    def spoil(data: bytes) -> bytes:
        _, stop = _set(data, 4)
        return data[: stop - 200] + b" 1.2x4 " + data[stop - 193 :]

    content = written(spoil, "ascii")
    (bad,) = [info for info in content.datasets if not info.ok]
    assert "1.2x4" in bad.message and "not a number" in bad.message
    assert content.tests[0].points[0].count == 3


def test_nan_in_a_record_is_told_with_its_place(written):
    def spoil(data: bytes) -> bytes:
        _, stop = _set(data, 1)
        return data[: stop - 7 - 8 * 5] + np.array([np.nan]).tobytes() + data[stop - 7 - 8 * 4 :]

    content = written(spoil)
    (bad,) = [info for info in content.datasets if not info.ok]
    assert "not finite" in bad.message and "296" in bad.message
    assert content.tests[0].points[0].count == 3


def test_zero_points(written):
    content = written(lambda data: data.replace(b"       300         1", b"         0         1", 1))
    (bad,) = [info for info in content.datasets if not info.ok]
    assert "0 points" in bad.message and content.tests[0].points[0].count in (0, 3)


def test_wrong_byte_count_is_found_out_by_the_delimiter(written, test):
    content = written(lambda data: data.replace(b"11        2400", b"11        1200"))
    assert all(info.ok for info in content.datasets)
    assert np.array_equal(content.tests[0].points[0].motion, test.points[0].motion)


def test_windows_line_ends(written, test):
    def spoil(data: bytes) -> bytes:
        return data.replace(b"\n", b"\r\n")

    content = written(spoil, "ascii")
    assert content.warnings == ()
    assert np.allclose(content.tests[0].points[0].motion, test.points[0].motion, atol=1e-11)


def test_big_endian(tmp_path, test, written):
    def spoil(data: bytes) -> bytes:
        out = bytearray(data.replace(b"58b     1     2", b"58b     2     2"))
        for number in range(12):
            _, stop = _set(data, number)
            first = stop - 7 - 2400
            out[first : first + 2400] = (
                np.frombuffer(data[first : first + 2400], "<f8").astype(">f8").tobytes()
            )
        return bytes(out)

    assert np.array_equal(written(spoil).tests[0].points[0].motion, test.points[0].motion)


def test_vax_numbers_are_refused(written):
    content = written(lambda data: data.replace(b"58b     1     2", b"58b     1     1"))
    assert content.tests == () and any("IEEE" in w for w in content.warnings)


def test_missing_units_are_assumed_aloud(written, test):
    content = written(lambda data: data.replace(b"\n   164\n", b"\n   999\n"))
    assert any("164" in w for w in content.warnings)
    assert np.array_equal(content.tests[0].points[0].motion, test.points[0].motion)


def test_unknown_and_unused_sets_are_listed(written):
    extra = b"    -1\n  1234\nsomething\n    -1\n"
    content = written(lambda data: extra + data)
    assert content.datasets[0].number == 1234 and content.datasets[0].ok
    assert len(content.table()) == len(content.datasets)


def test_nan_at_zero_frequency_costs_one_line(tmp_path, rng):
    values = rng.standard_normal((2, 40)) + 0j
    frfs = FrfSet(np.arange(40.0), values, (Dof(1, 3), Dof(2, 3)), (Dof(1, 3),) * 2, "receptance")
    write_uff(tmp_path / "a.uff", frfs=frfs)
    data = (tmp_path / "a.uff").read_bytes()
    where = data.index(values[0].tobytes())
    (tmp_path / "b.uff").write_bytes(data[:where] + np.array([np.nan]).tobytes() + data[where + 8 :])
    content = read_uff(tmp_path / "b.uff")
    assert content.frfs is not None and np.array_equal(content.frfs.values, values[:, 1:])
    assert content.frfs.frequency[0] == 1.0 and any("not finite" in w for w in content.warnings)


def test_frfs_of_another_axis_are_left_out_aloud(tmp_path, rng):
    def some(df: float, nodes: tuple[int, ...]) -> FrfSet:
        values = rng.standard_normal((len(nodes), 40)) + 0j
        return FrfSet(
            df * np.arange(40.0), values, tuple(Dof(n, 3) for n in nodes), (Dof(1, 3),) * len(nodes)
        )

    write_uff(tmp_path / "a.uff", frfs=[some(1.0, (1, 2, 3)), some(0.5, (4,))])
    content = read_uff(tmp_path / "a.uff")
    assert content.frfs is not None and len(content.frfs.responses) == 3
    assert any("left out" in w for w in content.warnings)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x00" * 500, b"    -1\n"])
def test_what_is_no_universal_file_is_refused(tmp_path, content):
    path = tmp_path / "x.uff"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"x\.uff"):
        read_uff(path)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be opened"):
        read_uff(tmp_path / "none.uff")


@pytest.mark.parametrize(
    ("end", "note"),
    [("\n", "unequal counts of numbers"), ("\r", "a sign may be lost"), ("\t", "a sign may be lost")],
)
def test_a_sign_that_became_a_line_end_is_warned_of(tmp_path, rng, end, note):
    frfs = FrfSet(
        np.arange(16) * 0.5, -1 - rng.random((1, 16)) + 0j, (Dof(1, 3),), (Dof(2, 3),), "accelerance"
    )
    path = tmp_path / "a.uff"
    write_uff(path, frfs=frfs, form="ascii")
    assert read_uff(path).warnings == ()
    text = path.read_text()
    first = text.index("58\n")
    place = text.index(" -", text.index("NONE                 NONE", first) + 60)
    place = text.index(" -", place + 50)
    path.write_bytes((text[:place] + f" {end}" + text[place + 2 :]).encode())
    words = [d.message for d in read_uff(path).datasets if d.message]
    assert any(note in message for message in words)
