"""Damaged files: what a reader can see is refused or warned of, place by place; no number changes without a word."""

from __future__ import annotations

import numpy as np
import pytest
from uff_damage_cases import numbers, silent, table

from acquisition import (
    Dof,
    FrfSet,
    HammerTest,
    Hits,
    read_uff,
    write_uff,
)

SAMPLES = 41


def some_test(rng) -> HammerTest:
    force, motion = rng.standard_normal((1, SAMPLES)), rng.standard_normal((1, 1, SAMPLES))
    force[:, -1], motion[..., -1] = 0.0, 0.0  # what a shift brings to the end is not seen there
    return HammerTest(100.0, (Hits(Dof(1, 3), (Dof(2, 3),), force, motion),))


def some_frfs(rng) -> FrfSet:
    values = rng.standard_normal((1, SAMPLES)) + 1j * rng.standard_normal((1, SAMPLES))
    values[:, -1] = 0.0
    return FrfSet(np.arange(float(SAMPLES)), values, (Dof(2, 3),), (Dof(1, 3),))


@pytest.fixture(params=[("ascii", "single"), ("ascii", "double"), ("binary", "single"), ("binary", "double")])
def written(request, tmp_path, rng):
    form, precision = request.param
    path = tmp_path / "good.uff"
    write_uff(path, tests=some_test(rng), frfs=some_frfs(rng), form=form, precision=precision)
    return form, path.read_bytes()


def bodies(data: bytes) -> list[tuple[int, int]]:
    """Return where the numbers of each data set 58 are."""
    places = []
    at = data.find(b"\n    58")
    while at >= 0:
        start = at + 1
        for _ in range(12):
            start = data.index(b"\n", start) + 1
        count = data[at + 7 : data.index(b"\n", at + 1)].split()
        stop = start + int(count[4]) if count else data.index(b"\n    -1\n", start) + 1
        places.append((start, stop))
        at = data.find(b"\n    58", stop)
    return places


@pytest.mark.parametrize("written", [("ascii", "single"), ("ascii", "double")], indirect=True)
def test_blanked_character_of_an_ascii_function_never_shifts_values(written, reread):
    _, data = written
    before = reread(data)
    for start, stop in bodies(data):
        for place in range(start, stop, 7):
            if data[place : place + 1] not in b" +-\n":  # a sign that is lost is a number like any other
                assert not silent(before, reread(data[:place] + b" " + data[place + 1 :])), place


@pytest.mark.parametrize("lost", [1, 2, 3, 4, 5, 7, 8, 16])
def test_lost_bytes_are_noticed_wherever_they_are_lost(written, reread, lost):
    _, data = written
    before = reread(data)
    for start, stop in bodies(data):
        for place in range(start, stop - lost, 23):
            spoilt = data[:place] + data[place + lost :]
            after = reread(spoilt)
            blanks = not data[place : place + lost].strip()
            assert blanks or not silent(before, after), place


@pytest.mark.parametrize("gained", [b"\x00", b" ", b"\n", b"7", b"\x00" * 4, b"\x00" * 8])
def test_gained_bytes_are_noticed_wherever_they_are_gained(written, reread, gained):
    _, data = written
    before = reread(data)
    for start, stop in bodies(data):
        for place in range(start, stop, 29):
            assert not silent(before, reread(data[:place] + gained + data[place:])), place


def test_gap_between_numbers_and_delimiter_may_be_a_line_end(written, reread):
    form, data = written
    before = reread(data)
    if form == "binary":
        for end in (b"\n", b"\r\n"):
            parts = [data[: bodies(data)[0][1]]] + [
                data[one[1] : two[1]]
                for one, two in zip(bodies(data), [*bodies(data)[1:], (0, len(data))], strict=True)
            ]
            after = reread(end.join(parts))
            assert numbers(after) == numbers(before) and after.warnings == before.warnings


def test_announced_bytes_that_do_not_fit_are_said(written, reread):
    form, data = written
    if form == "binary":
        count = bodies(data)[0][1] - bodies(data)[0][0]
        after = reread(data.replace(b"11%12d" % count, b"11%12d" % (count - 8), 1))
        assert after is not None and any("announces" in w for w in after.warnings)
        assert numbers(after) == numbers(reread(data))


@pytest.mark.parametrize("line", [b"   x58", b"     8", b"    5 ", b"   5 8", b"      ", b"58b 1 nan", b""])
def test_garbled_number_of_a_data_set_is_said(written, reread, line):
    form, data = written
    identity = data[data.index(b"\n    58") + 1 :].partition(b"\n")[0]
    for occurrence in range(2):
        parts = data.split(identity + b"\n")
        tail = identity[6:] if form == "binary" and line.strip() in (b"8", b"5") else b""
        spoilt = (identity + b"\n").join(parts[: occurrence + 1]) + line + tail + b"\n"
        after = reread(spoilt + (identity + b"\n").join(parts[occurrence + 1 :]))
        assert after is not None and set(after.warnings) - set(reread(data).warnings), occurrence


@pytest.mark.parametrize("line", [b"    -7", b"     1", b"    - ", b"      ", b"x   -1", None])
def test_garbled_delimiter_is_said(written, reread, line):
    form, data = written
    before = reread(data)
    places = [
        i
        for i in range(len(data))
        if data.startswith(b"    -1\n", i) and (i == 0 or data[i - 1 : i] == b"\n")
    ]
    assert form == "binary" or len(places) == 2 * len(before.datasets)
    for place in places:
        after = reread(data[:place] + (b"" if line is None else line + b"\n") + data[place + 7 :])
        assert after is None or set(after.warnings) - set(before.warnings), place


def test_cut_behind_an_opening_delimiter_is_said(written, reread):
    _, data = written
    place = data.rindex(b"    -1\n    58") + 7
    for cut in (place, place - 1, place + 4, place + 6):
        content = reread(data[:cut])
        assert content is not None and content.warnings


def test_stray_text_between_data_sets_is_said(written, reread):
    _, data = written
    place = data.index(b"    -1\n   164")
    after = reread(data[:place] + b"some text\n" + data[place:])
    assert numbers(after) == numbers(reread(data))
    assert any("'some text' stands outside any data set" in w for w in after.warnings)


@pytest.mark.parametrize("old", [b"         4        41", b"         2        41"])
def test_header_field_that_lost_its_last_digit_is_said(written, reread, old):
    form, data = written
    if form == "ascii" and old in data:
        assert reread(data.replace(old, old[:-1] + b" ", 1)).warnings
    named = b"NONE               2   3"
    assert named in data and reread(data.replace(named, named[:-1] + b" ", 1)).warnings
    field = data[data.index(b"1  0.00000e+00") :][:27][14:]
    for wrong in (field[:-1] + b" ", b"  ." + field[3:], field.replace(b".", b"3")):
        spoilt = data.replace(field, wrong, 1)
        assert not silent(reread(data), reread(spoilt)) or spoilt == data


def test_free_text_is_read_as_before(tmp_path, rng):
    """Numbers without columns of their own, one to five on a line."""
    test = some_test(rng)
    write_uff(tmp_path / "a.uff", tests=test, form="ascii")
    data = (tmp_path / "a.uff").read_bytes()
    out, last = b"", 0
    for start, stop in bodies(data):
        words = [b"%.9g" % float(w) for w in data[start:stop].split()]
        lines, row = [], 0
        while words:
            row = row % 5 + 1
            lines.append(b" ".join(words[:row]))
            words = words[row:]
        out += data[last:start] + b"\n".join(lines) + b"\n"
        last = stop
    (tmp_path / "b.uff").write_bytes(out + data[last:])
    content = read_uff(tmp_path / "b.uff")
    assert content.warnings == ()
    assert np.allclose(content.tests[0].points[0].motion, test.points[0].motion, rtol=1e-8)


def test_numbers_with_three_digits_of_exponent_and_fortran_ones(tmp_path, reread, rng):
    test = some_test(rng)
    write_uff(tmp_path / "a.uff", tests=test, form="ascii", precision="single")
    data = (tmp_path / "a.uff").read_bytes()
    place = bodies(data)[0][0] + 3 * 79
    for number in (b" 1.00000e-105", b" 1.00000-105 ", b"          0.0", b"         -1.5"):
        fits = number.rstrip() == number
        after = reread(data[: place + 13] + number + data[place + 26 :])
        assert (after is not None and after.warnings == ()) == fits


@pytest.mark.parametrize("character", [b"\v", b"\f"])
def test_a_control_character_inside_a_number_is_refused_or_warned_of(tmp_path, reread, rng, character):
    """numpy takes it for a blank, and one number would be two."""
    write_uff(tmp_path / "a.uff", tests=some_test(rng), form="ascii", precision="single")
    data = (tmp_path / "a.uff").read_bytes()
    place = bodies(data)[0][0] + 3 * 79
    after = reread(data[: place + 4] + character + data[place + 5 :])
    assert after is None or after.warnings


@pytest.mark.parametrize("lines", [4, 5, 9])
def test_a_line_broken_in_a_number_of_a_short_record_is_warned_of(lines, tmp_path, reread):
    values = np.full((1, 4 * lines // 2), 0.99) + 0j
    frfs = FrfSet(np.arange(2.0 * lines), values, (Dof(2, 3),), (Dof(1, 3),))
    write_uff(tmp_path / "x.uff", frfs=frfs, form="ascii", precision="double")
    whole = (tmp_path / "x.uff").read_bytes()
    assert reread(whole).warnings == ()
    number = b"  9.900000000000e-01"
    at = whole.index(number, whole.index(number) + 1) + 2
    broken = whole[:at] + b"\n" + whole[at + 1 :]
    assert not silent(reread(whole), reread(broken))


@pytest.mark.parametrize(
    ("stated", "decay", "word"),
    [
        ("8.0 1/s", 8.0, ""),
        ("8", 8.0, ""),
        (": 8/s, both", 8.0, ""),
        ("-8", 8.0, "taken for 8 1/s"),
        ("- 8 1/s", 8.0, "taken for 8 1/s"),
        ("- none", 0.0, ""),
        ("none", 0.0, ""),
        ("8,5 1/s", 0.0, "not a number"),
        ("nan", 0.0, "not a number"),
        ("1e400", 0.0, "is implausible"),
        ("eight", 0.0, "not a number"),
    ],
)
def test_decay_in_an_id_line(tmp_path, reread, rng, stated, decay, word):
    write_uff(tmp_path / "a.uff", frfs=some_frfs(rng), form="ascii")
    data = (tmp_path / "a.uff").read_bytes()
    lines = data.split(b"\n")
    at = next(i for i, line in enumerate(lines) if line.startswith(b"FRF ")) + 3
    lines[at] = f"Exponential window decay {stated}".encode()
    content = reread(b"\n".join(lines))
    assert content.frfs is not None and content.frfs.decay == decay
    assert all(word in w for w in content.warnings) and bool(content.warnings) == bool(word)


def test_averages_that_cannot_be_meant_cost_nothing_but_themselves(tmp_path, reread, rng):
    write_uff(tmp_path / "a.uff", frfs=some_frfs(rng), form="ascii")
    data = (tmp_path / "a.uff").read_bytes()
    lines = data.split(b"\n")
    at = next(i for i, line in enumerate(lines) if line.startswith(b"FRF ")) + 4
    lines[at] = b"averages 99999999999999999999"
    content = reread(b"\n".join(lines))
    assert content.frfs is not None and any("averages" in w for w in content.warnings)


def test_broken_data_set_is_reported_once(tmp_path, reread, rng):
    write_uff(tmp_path / "a.uff", tests=some_test(rng), form="ascii")
    data = (tmp_path / "a.uff").read_bytes()
    content = reread(data.replace(b"        41         1", b"       410         1", 1))
    (info,) = [d for d in content.datasets if not d.ok]
    (given,) = [w for w in content.warnings if str(info.line) in w]
    assert "it is left out and hit 1 at 1+Z with it" in given


def test_texts_of_200_000_blanks_take_no_time(tmp_path, reread, rng):
    """Patterns that try every split of a run of blanks take hours."""
    write_uff(tmp_path / "a.uff", frfs=some_frfs(rng), form="ascii")
    data = (tmp_path / "a.uff").read_bytes()
    blanks = b" " * 200_000
    for words in (b"averages", b"exponential window decay", b"hit", b"hit no", b"-1", b"sigma", b"FR ="):
        place = data.index(b"FRF 2+Z")
        assert reread(data[:place] + words + blanks + b"x" + data[place:]) is not None
        assert reread(data + b"    " + words + blanks + b"x\n") is not None
        mode = table(55, (words + blanks).decode() + "x", *["1" * 1000 + "." + "sigma" * 40_000] * 4, "x")
        assert reread(data + mode) is not None
    binary = tmp_path / "b.uff"
    write_uff(binary, frfs=some_frfs(rng))
    assert reread(binary.read_bytes() + b"    -1" + blanks + b"x") is not None
    wrong = binary.read_bytes().replace(b"11         656", b"11           1")
    assert reread(wrong[:-7] + b"    -1" + blanks + b"x\n    -1\n") is not None


def test_values_too_large_to_be_meant_are_refused(tmp_path, reread, rng):
    write_uff(tmp_path / "a.uff", frfs=some_frfs(rng))
    data = (tmp_path / "a.uff").read_bytes()
    start = bodies(data)[0][0]
    content = reread(data[: start + 64] + np.array([1e200]).tobytes() + data[start + 72 :])
    assert content.frfs is None and any(
        "implausibly large, the first at point 5" in w for w in content.warnings
    )
