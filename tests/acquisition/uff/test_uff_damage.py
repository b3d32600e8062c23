"""Damaged files: what a reader can see is refused or warned of, place by place; no number changes without a word."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import (
    Dof,
    FrfSet,
    Geometry,
    HammerTest,
    Hits,
    InputError,
    ModalData,
    UffContent,
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


@pytest.fixture
def reread(tmp_path):
    def read(data: bytes) -> UffContent | None:
        (tmp_path / "x.uff").write_bytes(data)
        try:
            return read_uff(tmp_path / "x.uff")
        except InputError as error:
            assert "\n" not in str(error)
            return None

    return read


@pytest.fixture(params=[("ascii", "single"), ("ascii", "double"), ("binary", "single"), ("binary", "double")])
def written(request, tmp_path, rng):
    form, precision = request.param
    path = tmp_path / "good.uff"
    write_uff(path, tests=some_test(rng), frfs=some_frfs(rng), form=form, precision=precision)
    return form, path.read_bytes()


def numbers(content: UffContent | None) -> tuple:
    """Return all numbers of a content."""
    assert content is not None
    waves = [(p.force.tobytes(), p.motion.tobytes()) for t in content.tests for p in t.points]
    frfs = None if content.frfs is None else content.frfs.values.tobytes()
    geometry = content.geometry
    modal = content.modal
    shapes = (
        None if modal is None or modal.shapes is None else (modal.frequency.tobytes(), modal.shapes.tobytes())
    )
    return waves, frfs, shapes, geometry.nodes, geometry.coordinates.tobytes(), geometry.lines.tobytes()


def silent(before: UffContent, after: UffContent | None) -> bool:
    """Tell whether numbers changed without a word."""
    return (
        after is not None
        and not set(after.warnings) - set(before.warnings)
        and numbers(after) != numbers(before)
    )


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


def table(number: int, *lines: str) -> bytes:
    return (f"    -1\n{number:6d}\n" + "".join(line + "\n" for line in lines) + "    -1\n").encode()


def row(pattern: str, values) -> str:
    return "".join(pattern % v for v in values)


@pytest.fixture
def drawn(rng) -> bytes:
    """Return units, nodes, trace lines and modes of two kinds."""
    nodes = (1, 2, 13, 104)
    unit = "  1.00000000000000000D+00"
    header = table(164, f"{1:10d}{'SI':20s}{2:10d}", 3 * unit, "  0.00000000000000000D+00")
    grid = table(15, *[row("%10d", (n, 1, 0, 8)) + row("%13.5E", rng.standard_normal(3)) for n in nodes])
    trace = table(82, row("%10d", (1, 8, 0)), "NONE", row("%10d", (1, 2, 13, 104, 0, 2, 13, 1)))
    normal = [
        table(
            55,
            *["NONE"] * 5,
            row("%10d", (1, 2, 2, 8, 2, 3)),
            row("%10d", (2, 4, 1, k)),
            row("%13.5e", (10.0 * k, 2.5, 0.01, 0)),
            *[line for n in nodes for line in (f"{n:10d}", row("%13.5e", rng.standard_normal(3)))],
        )
        for k in (1, 2)
    ]
    return header + grid + trace + b"".join(normal)


@pytest.mark.long
def test_damage_to_tables_of_nodes_lines_and_modes(drawn, reread):
    before = reread(drawn)
    assert before.warnings == () and len(before.modal) == 2 and len(before.geometry.nodes) == 4
    start = drawn.index(b"\n", drawn.index(b"    15\n")) + 1
    for place in range(start, len(drawn)):
        old = drawn[place : place + 1]
        if old in b" +-\n" or (drawn[place - 1 : place] == b" " and drawn[place + 1 : place + 2].isdigit()):
            continue  # signs, and first digits of whole numbers: other numbers as good
        assert not silent(before, reread(drawn[:place] + b" " + drawn[place + 1 :])), place
        assert not silent(before, reread(drawn[:place] + drawn[place + 1 :])), place


def test_one_mode_twice_in_a_file_counts_once(tmp_path, drawn, reread):
    modes = drawn[drawn.index(b"    -1\n    55") :]
    first = modes[: modes.index(b"    -1\n    55", 8)]
    content = reread(drawn + first)
    assert len(content.modal) == 2
    assert any(
        "the same mode stands in x.uff, data set 55" in w and "counts once" in w for w in content.warnings
    )
    turned = first.replace(
        b"         2         4         1         1", b"         2         4         1         3"
    )
    assert len(reread(drawn + turned).modal) == 2
    other = first.replace(b"  1.00000e+01", b"  1.10000e+01")
    assert len(reread(drawn + other).modal) == 3


def test_a_copy_of_a_mode_that_lost_a_node_is_not_silent(drawn, reread):
    modes = drawn[drawn.index(b"    -1\n    55") :]
    lines = modes[: modes.index(b"    -1\n    55", 8)].split(b"\n")
    cut = b"\n".join(lines[:-4] + lines[-2:])  # without its last node
    content = reread(drawn + cut)
    assert len(content.modal) == 3
    assert any("frequency and damping are exactly those of" in w for w in content.warnings)


def test_exchanged_lines_of_a_shape_are_not_silent(tmp_path, reread, rng):
    shapes = rng.standard_normal((3, 1)) + 0j
    one = np.array([0.01])
    modal = ModalData(
        frequency=np.array([12.5]),
        frequency_sigma=one,
        damping=one,
        damping_sigma=one,
        dofs=tuple(Dof(n, 3) for n in (1, 2, 3)),
        shapes=shapes,
        shape_sigma=None,
        scaled=True,
    )
    write_uff(tmp_path / "x.uff", modal=modal)
    lines = (tmp_path / "x.uff").read_bytes().split(b"\n")
    before = reread(b"\n".join(lines))
    assert before.warnings == () and len(before.modal) == 1
    first = lines.index(b"    55") + 9
    for a in range(first, first + 5):
        for b in range(a + 1, first + 6):
            changed = list(lines)
            changed[a], changed[b] = lines[b], lines[a]
            if (b - a) % 2:  # a node's number and another line of values
                assert not silent(before, reread(b"\n".join(changed))), (a, b)


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


def test_what_is_not_used_is_said_in_one_line(drawn, reread):
    content = reread(drawn + table(161, "x") + table(161, "y") + table(17, "z"))
    assert content.warnings == ("x.uff: not used: 2 data sets 161; 1 data sets 17",)


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


def chained(count: int, first: int = 0) -> bytes:
    """Return a node and systems each given in the one before."""
    lines = []
    for label in range(2, count + 2):
        lines += [row("%10d", (label, 0, label - 1 if label > 2 else first, 8, 1)), "CS"]
        lines += [row("%13.5E", (1e-3, 0, 0, 1.001, 0, 0)), row("%13.5E", (0.001, 0, 1))]
    nodes = [row("%10d", (n, n, 0, 8)) + row("%13.5E", (0, 0, 0)) for n in range(2, count + 2)]
    return table(18, *lines) + table(15, *nodes)


@pytest.mark.long
@pytest.mark.usefixtures("no_hang")  # each system is placed once; through all others it was minutes
def test_chain_of_3000_coordinate_systems(reread):
    content = reread(chained(3000))
    assert np.allclose(content.geometry.coordinates[-1], [3.0, 0, 0])
    content = reread(chained(3000, first=7777))
    assert any("coordinate system 7777 is not defined" in w for w in content.warnings)


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


def test_modal_data_of_some_scaled_modes(tmp_path, drawn, reread):
    assert reread(drawn).modal.scaled
    content = reread(drawn.replace(b"  2.00000e+01  2.50000e+00", b"  2.00000e+01  0.00000e+00"))
    assert not content.modal.scaled and any("modal mass" in w for w in content.warnings)


def test_shape_sigmas_come_back(tmp_path, rng):
    dofs = (Dof(1, 3), Dof(2, 1), Dof(2, 3))
    shapes = rng.standard_normal((3, 2)) + 0j
    sigma = np.abs(rng.standard_normal((3, 2)))
    modal = ModalData(
        frequency=np.array([5.0, 7.0]),
        frequency_sigma=np.array([0.1, 0.2]),
        damping=np.array([0.01, 0.02]),
        damping_sigma=None,
        dofs=dofs,
        shapes=shapes,
        shape_sigma=sigma,
        scaled=True,
        geometry=Geometry((1, 2), np.eye(3)[:2]),
    )
    write_uff(tmp_path / "a.uff", modal=modal)
    content = read_uff(tmp_path / "a.uff")
    back = content.modal
    assert (
        content.warnings == () and back is not None and len(back) == 2 and back.dofs == dofs and back.scaled
    )
    assert np.allclose(back.shapes, shapes, rtol=1e-5) and np.allclose(back.shape_sigma, sigma, rtol=1e-5)


def test_values_too_large_to_be_meant_are_refused(tmp_path, reread, rng):
    write_uff(tmp_path / "a.uff", frfs=some_frfs(rng))
    data = (tmp_path / "a.uff").read_bytes()
    start = bodies(data)[0][0]
    content = reread(data[: start + 64] + np.array([1e200]).tobytes() + data[start + 72 :])
    assert content.frfs is None and any(
        "too large to be meant, the first at point 5" in w for w in content.warnings
    )
