"""A layout that is written for files: what it guesses reads them as they were measured, or states what is lacking."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat, wavfile

from acquisition import Dof, FrfSet, HammerTest, InputError, propose_layout
from acquisition.columns import Layout, layout_from
from acquisition.columns.guesses import node_pattern, roundest_rate
from acquisition.readers import read_test

RATE, SAMPLES = 1024.0, 256
TIME = np.arange(SAMPLES) / RATE
FORCE = 80.0 * np.exp(-(((TIME - 0.01) / 0.002) ** 2))
MOTION = np.where(TIME > 0.01, np.exp(-3 * (TIME - 0.01)) * np.sin(2 * np.pi * 85 * (TIME - 0.01)), 0.0)


def proposed(paths: list[Path]) -> Layout:
    return layout_from(tomllib.loads(propose_layout(paths)))


def table(path: Path, heading: str, *columns: np.ndarray, separator: str = ",", decimal: str = ".") -> Path:
    rows = [
        separator.join(f"{v:.9g}".replace(".", decimal) for v in row) for row in zip(*columns, strict=True)
    ]
    path.write_text(heading + "\n".join(rows) + "\n", encoding="utf-8")
    return path


HEADINGS: list[tuple[str, dict[str, Any]]] = [
    ("Time (s),Force (N),Acc 5 (m/s^2)\n", {}),
    ("t,hammer,a5\ns,N,m/s2\n", {}),
    ("# beam\nTime [ms],Force [kN],Acc 5 [g]\n", {"time": 1e3, "force": 1e-3, "motion": 1 / 9.80665}),
    ("Zeit;Kraft;Beschl 5\n", {"separator": ";", "decimal": ","}),
    ("time,ch2,a5\n", {}),
]


@pytest.mark.parametrize(("heading", "how"), HEADINGS)
def test_hits_as_text_are_read_by_the_layout_that_is_written(
    tmp_path: Path, heading: str, how: dict[str, Any]
) -> None:
    factors = [how.pop(key, 1.0) for key in ("time", "force", "motion")]
    columns = [f * c for f, c in zip(factors, (TIME, FORCE, MOTION), strict=True)]
    paths = [
        table(tmp_path / f"P{node}_{hit}.csv", heading, columns[0], *(hit * c for c in columns[1:]), **how)
        for node in (3, 12)
        for hit in (1, 2)
    ]
    (test,) = read_test(paths, layout=proposed(paths))
    assert isinstance(test, HammerTest) and test.rate == pytest.approx(RATE, rel=1e-6)
    assert [(p.reference, p.count) for p in test.points] == [(Dof(3, 3), 2), (Dof(12, 3), 2)]
    assert test.points[0].responses == (Dof(5, 3),) and test.form == "accelerance"
    np.testing.assert_allclose(test.points[0].force[0], FORCE, atol=1e-6)
    np.testing.assert_allclose(test.points[0].motion[0, 0], MOTION, atol=1e-6)


def test_a_file_without_headings_has_the_shortest_pulse_as_force(tmp_path: Path) -> None:
    path = table(tmp_path / "a.txt", "", TIME, MOTION, FORCE, separator="\t")
    layout = proposed([path])
    assert [(c.index, c.quantity) for c in layout.columns] == [(1, "acceleration"), (2, "force")]
    assert layout.time_column == 0


def test_every_guess_says_why_and_what_is_not_in_the_files(tmp_path: Path) -> None:
    text = propose_layout([table(tmp_path / "P3.csv", "t,hammer,acc\n", TIME, FORCE, MOTION)])
    assert text.startswith("# Layout by modalkit")
    guesses = [line for line in text.splitlines() if "=" in line and not line.startswith("#")]
    unexplained = [line for line in guesses if "#" not in line and not line.startswith("name = ")]
    assert not unexplained
    assert 'unit = "N"  # not in the file: correct it' in text and "by its name, hammer" in text


def test_frequency_response_as_text(tmp_path: Path) -> None:
    lines, frf = np.arange(1.0, 65.0), np.arange(64.0) * (1 - 0.5j)
    path = table(tmp_path / "h.csv", "Frequency [Hz],Real,Imag\n", lines, frf.real, frf.imag)
    (frfs,) = read_test(path, layout=proposed([path]))
    assert isinstance(frfs, FrfSet)
    np.testing.assert_allclose(frfs.values, [frf])


def test_recorders_files(tmp_path: Path) -> None:
    step = {"wf_increment": 1 / RATE}
    with TdmsWriter(tmp_path / "P7.tdms") as file:
        file.write_segment(
            [
                ChannelObject("hit", "Hammer", FORCE, {**step, "unit_string": "N"}),
                ChannelObject("hit", "Acc 2 +x", MOTION, {**step, "unit_string": "g"}),
            ]
        )
    np.savez(
        tmp_path / "P7.npz", fs=RATE, force=np.stack([FORCE, 2 * FORCE]), acc=np.stack([MOTION, 2 * MOTION])
    )
    (one,) = read_test(tmp_path / "P7.tdms", layout=proposed([tmp_path / "P7.tdms"]))
    (two,) = read_test(tmp_path / "P7.npz", layout=proposed([tmp_path / "P7.npz"]))
    assert one.rate == pytest.approx(RATE) and two.rate == RATE and two.points[0].count == 2
    assert (one.points[0].reference, one.points[0].responses) == (Dof(7, 3), (Dof(2, 1),))
    np.testing.assert_array_equal(two.points[0].force[1], 2 * FORCE)


def test_a_wav_file_lacks_its_full_scale_and_says_so(tmp_path: Path) -> None:
    wavfile.write(tmp_path / "a.wav", 1024, (np.stack([FORCE, MOTION], 1) * 300).astype("i2"))
    assert propose_layout([tmp_path / "a.wav"]).count("# scale = ...") == 2
    with pytest.raises(InputError, match="holds fractions of full scale; give scale"):
        read_test(tmp_path / "a.wav", layout=proposed([tmp_path / "a.wav"]))


@pytest.mark.parametrize(
    ("names", "pattern"),
    [
        (["P1_1.csv", "P1_2.csv", "P12_1.csv"], "P{node}_*.csv"),
        (["hit1.csv", "hit2.csv"], None),
        (["001.csv", "002.csv"], "{node}.csv"),
        (["2024-05-01_point3_hit1.csv", "2024-05-01_point4_hit1.csv"], "2024-05-01_point{node}_hit1.csv"),
        (["beam_run2_n7.txt"], "beam_run2_n{node}.txt"),
        (["a.csv", "b.csv"], None),
    ],
)
def test_nodes_are_found_in_names(names: list[str], pattern: str | None) -> None:
    found = node_pattern([Path(name) for name in names])
    assert (None if found is None else found.value) == pattern


@pytest.mark.parametrize("axis", ["lines", "rate"])
@pytest.mark.parametrize("shape", [(65, 3), (3, 65), (65, 3, 2), (65, 1)])
def test_frfs_of_a_matlab_file(tmp_path: Path, axis: str, shape: tuple[int, ...]) -> None:
    frfs = np.random.default_rng(1).standard_normal((*shape, 2)) @ np.array([1.0, 1j])
    more = {"f": np.arange(65) * 4.0} if axis == "lines" else {"Fs": 512.0}
    savemat(tmp_path / "a.mat", {"test": {"H": frfs}, "note": "beam", "mass": np.eye(3), **more})
    (found,) = read_test(tmp_path / "a.mat", layout=proposed([tmp_path / "a.mat"]))
    assert isinstance(found, FrfSet) and found.form == "accelerance"
    np.testing.assert_array_equal(found.frequency, np.arange(65) * 4.0)
    along = np.moveaxis(frfs, shape.index(65), -1)
    np.testing.assert_array_equal(found.values, along.reshape(-1, 65))
    assert "where it was hit, not in the file: correct it" in propose_layout([tmp_path / "a.mat"])


@pytest.mark.parametrize("digits", [4, 6, 9])
def test_a_rate_has_no_more_digits_than_the_times(tmp_path: Path, digits: int) -> None:
    """Times in ms written with few decimals make 5119.99997 Hz of 5120 if they are taken to the last bit."""
    times = np.round(1e3 * np.arange(600) / 5120.0, digits)
    rows = [f"{t:.{digits}f},{k % 7},{k % 5}" for k, t in enumerate(times)]
    (tmp_path / "a.csv").write_text("t [ms],hammer [N],acc [g]\n" + "\n".join(rows), encoding="utf-8")
    assert proposed([tmp_path / "a.csv"]).rate == 5120.0
    assert "whose last digit allows" in propose_layout([tmp_path / "a.csv"])


@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_a_rate_of_binary_times(kind: str) -> None:
    times = (np.arange(5000) / 51.2).astype(kind).astype(float)
    rate, least, largest = roundest_rate(times, 1e-3)
    assert rate == 51200.0 and least <= 51200 <= largest and largest - least < 0.02


def test_volts_are_not_read_as_newtons(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "Time [s],Hammer [V],Acc [mV]\n", TIME, FORCE, MOTION)
    text = propose_layout([path])
    assert 'unit = "V"  # from the file, but not a unit of force: write "N" and scale' in text
    with pytest.raises(
        InputError, match=r"'V' is not a known unit of force.* and scale = \.\.\. for the value of one volt"
    ):
        read_test(path, layout=proposed([path]))
    mended = text.replace('unit = "V"', 'unit = "N"\nscale = 440.0').replace('"mV"', '"g"\nscale = 0.01')
    (test,) = read_test(path, layout=layout_from(tomllib.loads(mended)))
    np.testing.assert_allclose(test.points[0].force[0], 440 * FORCE, atol=1e-5)


def test_one_channel_makes_no_layout(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", force=FORCE)
    with pytest.raises(InputError, match="holds 1 channels; a hit has a force and a response"):
        propose_layout([tmp_path / "a.npz"])
