"""TDMS, WAV, HDF5, npz and MATLAB records through the layout that text has; the libraries write the files here."""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat, wavfile

from acquisition import Dof, InputError, estimate_frfs, judge_hits
from acquisition.columns import Layout, layout_from, read_columns, read_frf_columns
from acquisition.readers import read_test

RATE = 2048.0
HITS, SAMPLES = 2, 64
FORCE = np.random.default_rng(1).uniform(-1, 1, (HITS, SAMPLES)).round(3)
MOTION = np.random.default_rng(2).uniform(-1, 1, (HITS, SAMPLES)).round(3)
GRAVITY = 9.80665


def layout(
    *, force: dict[str, Any] | None = None, motion: dict[str, Any] | None = None, **more: Any
) -> Layout:
    columns = [
        {"name": "force", "quantity": "force", "node": 3, "direction": "-z"} | (force or {}),
        {"name": "acc", "quantity": "acceleration", "unit": "g"} | (motion or {}),
    ]
    return layout_from({"column": columns} | more)


def tdms(path: Path, *, rate: float | None = RATE, name: str = "force", slow: bool = False) -> Path:
    step = {} if rate is None else {"wf_increment": 1 / rate}
    with TdmsWriter(path) as file:
        for k in range(HITS):
            file.write_segment(
                [
                    ChannelObject(f"hit {k}", name, FORCE[k], {**step, "unit_string": "kN"}),
                    ChannelObject(f"hit {k}", "acc", MOTION[k], {"wf_increment": 0.5} if slow else step),
                ]
            )
    return path


def hdf5(path: Path) -> Path:
    with h5py.File(path, "w") as file:
        file["fs"] = RATE
        file["test/force"] = FORCE
        file["test/force"].attrs["units"] = "kN"
        file["test/acc"] = MOTION
    return path


def npz(path: Path) -> Path:
    np.savez(path, fs=RATE, force=FORCE, acc=MOTION)
    return path


def mat(path: Path) -> Path:
    savemat(path, {"fs": RATE, "test": {"force": FORCE.T, "acc": MOTION.T}}, do_compression=True)
    return path


KINDS: dict[str, tuple[Callable[[Path], Path], dict[str, Any]]] = {
    "a.tdms": (tdms, {}),
    "a.h5": (
        hdf5,
        {"force": {"name": "test/force"}, "motion": {"name": "test/acc"}, "rate": "fs"},
    ),
    "a.npz": (npz, {"force": {"unit": "kN"}, "rate": "fs"}),
    "a.mat": (
        mat,
        {
            "force": {"name": "test.force", "unit": "kN"},
            "motion": {"name": "test.acc"},
            "rate": "fs",
        },
    ),
}


@pytest.mark.parametrize("name", list(KINDS))
def test_hits_rate_and_units_are_those_written(tmp_path: Path, name: str) -> None:
    write, more = KINDS[name]
    (test,) = read_test(write(tmp_path / name), layout=layout(**more))
    (point,) = test.points
    assert test.rate == pytest.approx(RATE) and point.count == HITS and point.reference == Dof(3, -3)
    np.testing.assert_allclose(point.force, 1e3 * FORCE, rtol=1e-12)
    np.testing.assert_allclose(point.motion[:, 0], GRAVITY * MOTION, rtol=1e-12)


BITS = {"u1": 8, "i2": 16, "i4": 32}


def wav24(path: Path, values: np.ndarray) -> None:
    """Write whole numbers of 24 bits, two channels, by the format's own description."""
    packed = b"".join(struct.pack("<i", int(v))[:3] for v in values.ravel())
    head = struct.pack("<HHIIHH", 1, values.shape[1], 4096, 4096 * 6, 6, 24)
    parts = b"fmt " + struct.pack("<I", 16) + head + b"data" + struct.pack("<I", len(packed)) + packed
    path.write_bytes(b"RIFF" + struct.pack("<I", 4 + len(parts)) + b"WAVE" + parts)


def wav_layout(*, scale: bool = True) -> Layout:
    columns: list[dict[str, Any]] = [
        {"name": "Channel 1", "quantity": "force", "unit": "N"},
        {"index": 1, "quantity": "acceleration", "unit": "m/s2"},
    ]
    for column, full in zip(columns, (500.0, 50.0) if scale else (), strict=scale):
        column["scale"] = full
    return layout_from({"column": columns})


@pytest.mark.parametrize("kind", ["u1", "i2", "i4", "f4", 24])
def test_full_scale_of_a_wav_file_is_the_scale(tmp_path: Path, kind: str | int) -> None:
    path, values = tmp_path / "a.wav", np.stack([FORCE[0], MOTION[0]], axis=1)
    if kind == 24:
        wav24(path, np.round(values * 2**23))
    elif kind == "f4":
        wavfile.write(path, 4096, values.astype("f4"))
    else:
        full = 2 ** (BITS[str(kind)] - 1)
        wavfile.write(path, 4096, (np.round(values * full) + (128 if kind == "u1" else 0)).astype(kind))
    test = read_columns(path, wav_layout())
    step = 2.0 ** -(23 if kind in (24, "f4") else BITS[str(kind)] - 1)
    assert test.rate == 4096.0
    np.testing.assert_allclose(test.points[0].force[0], 500 * FORCE[0], atol=500 * step)
    np.testing.assert_allclose(test.points[0].motion[0, 0], 50 * MOTION[0], atol=50 * step)


def test_parts_of_a_full_scale_that_is_not_stated_are_refused(tmp_path: Path) -> None:
    wav24(tmp_path / "a.wav", np.round(np.stack([FORCE[0], MOTION[0]], axis=1) * 2**23))
    with pytest.raises(InputError, match=r"'Channel 1' holds fractions of full scale; give scale"):
        read_columns(tmp_path / "a.wav", wav_layout(scale=False))
    wavfile.write(tmp_path / "b.wav", 4096, np.stack([FORCE[0], MOTION[0]], axis=1))
    np.testing.assert_array_equal(
        read_columns(tmp_path / "b.wav", wav_layout(scale=False)).points[0].force[0], FORCE[0]
    )


def test_a_wav_file_that_was_cut_off_is_refused(tmp_path: Path) -> None:
    wav24(tmp_path / "a.wav", np.round(np.stack([FORCE[0], MOTION[0]], axis=1) * 2**23))
    whole = (tmp_path / "a.wav").read_bytes()
    (tmp_path / "a.wav").write_bytes(whole[:-12])
    with pytest.raises(InputError, match="cut off or damaged"):
        read_columns(tmp_path / "a.wav", wav_layout())


def test_a_wav_header_that_cuts_samples_in_pieces_is_refused(tmp_path: Path) -> None:
    """Six channels of one byte where there are two of three: sizes and rate still belong together."""
    wav24(tmp_path / "a.wav", np.round(np.stack([FORCE[0], MOTION[0]], axis=1) * 2**23))
    whole = bytearray((tmp_path / "a.wav").read_bytes())
    whole[22] = 6
    (tmp_path / "a.wav").write_bytes(whole)
    with pytest.raises(InputError, match="6 channels of 24 bits in 6 bytes"):
        read_columns(tmp_path / "a.wav", wav_layout())


def test_a_cut_tdms_file_is_refused_in_one_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """nptdms reads what is left of it, and writes a note of its own to stderr."""
    whole = tdms(tmp_path / "a.tdms").read_bytes()
    for content in (whole[:-8], whole + b"TDSm", whole.replace(b"unit_string", b"unit_str\xff\xfeg")):
        (tmp_path / "a.tdms").write_bytes(content)
        with pytest.raises(InputError, match=r"a\.tdms: (its segments do not end|not a whole TDMS file)"):
            read_columns(tmp_path / "a.tdms", layout())
    assert capfd.readouterr().err == ""


def test_channels_of_one_array_are_named_by_number_and_complex_ones_by_part(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", data=np.stack([FORCE[0], MOTION[0]], axis=1))
    test = read_columns(
        tmp_path / "a.npz", layout(force={"name": "data[0]"}, motion={"name": "data[1]"}, rate="2.048 kHz")
    )
    np.testing.assert_array_equal(test.points[0].force[0], FORCE[0])
    lines, frf = np.arange(1.0, 33.0), np.arange(32.0) * (1 - 2j)
    np.savez(tmp_path / "b.npz", f=lines, H=frf)
    columns = [{"name": f"H {part}", "quantity": "accelerance", "part": part} for part in ("real", "imag")]
    frfs = read_frf_columns(tmp_path / "b.npz", layout_from({"frequency_column": "f", "column": columns}))
    np.testing.assert_array_equal(frfs.frequency, lines)
    np.testing.assert_array_equal(frfs.values, [frf])


def test_groups_with_other_channels_are_one_record(tmp_path: Path) -> None:
    with TdmsWriter(tmp_path / "a.tdms") as file:
        step = {"wf_increment": 1 / RATE}
        file.write_segment(
            [
                ChannelObject("hammer", "force", FORCE[0], step),
                ChannelObject("plate", "acc", MOTION[0], step),
                ChannelObject("bench", "acc", MOTION[1], step),
                ChannelObject("bench", "temperature", np.arange(3.0), {"wf_increment": 1.0}),
            ]
        )
    test = read_columns(tmp_path / "a.tdms", layout(motion={"name": "plate/acc"}))
    np.testing.assert_allclose(test.points[0].motion[0, 0], GRAVITY * MOTION[0])


MISTAKES = [
    ("a.tdms", lambda p: tdms(p, rate=None), {}, r"no sampling rate; add rate = "),
    ("a.tdms", tdms, {"motion": {"name": "accel"}}, r"'accel' is missing; the headings are 'force', 'acc'"),
    ("a.tdms", lambda p: tdms(p, slow=True), {}, r"rates, column 'acc' at 2 Hz and column 'force' at 2048 Hz"),
    ("a.tdms", tdms, {"rate": 1000.0}, r"2048 Hz by its header, at 1000 Hz by"),
    ("a.npz", npz, {"motion": {"name": "ac"}, "rate": "fs"}, r"no array 'ac' in it; there are 'fs', 'force'"),
    ("a.npz", npz, {"motion": {"name": "acc[2]"}}, r"there is no 'acc\[2\]': the array has shape \(2, 64\)"),
    ("a.npz", npz, {"rate": "acc"}, r"rate = 'acc' of shape \(2, 64\) is not one positive number"),
    ("a.h5", hdf5, {"force": {"name": "force"}}, r"no data set 'force' in it; there are 'fs', 'test/acc'"),
    ("a.mat", mat, {"force": {"name": "force"}}, r"no variable 'force' in it"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "write", "more", "message"), MISTAKES)
def test_mistakes_are_named(
    tmp_path: Path, name: str, write: Callable[[Path], Path], more: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        read_columns(write(tmp_path / name), layout(**more))


def test_named_arrays_have_no_numbers(tmp_path: Path) -> None:
    numbered = {"column": [{"index": 0, "quantity": "force"}, {"name": "acc", "quantity": "acceleration"}]}
    with pytest.raises(InputError, match="its arrays are named, not numbered"):
        read_columns(npz(tmp_path / "a.npz"), layout_from({**numbered, "rate": "fs"}))


@pytest.mark.parametrize("name", ["a.tdms", "a.h5", "a.wav", "a.npz", "a.mat"])
def test_a_file_that_is_none_of_its_kind_is_one_line(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"no such file, whatever its ending says" * 20)
    with pytest.raises(InputError) as error:
        read_columns(tmp_path / name, layout())
    assert str(tmp_path / name) in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("ahead", [0, 512])
def test_an_hdf5_file_that_goes_on_behind_its_end_is_refused(tmp_path: Path, newer: bool, ahead: int) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", userblock_size=ahead, libver="latest" if newer else "earliest") as file:
        file["fs"], file["force"], file["acc"] = RATE, FORCE, MOTION
    assert read_columns(path, layout(rate="fs")).rate == RATE
    with path.open("ab") as file:
        file.write(b"1.0\n")
    with pytest.raises(InputError, match=r"its header states \d+ bytes, the file has"):
        read_columns(path, layout(rate="fs"))


def test_hdf5_numbers_of_fewer_digits_than_their_bits_have_are_refused(tmp_path: Path) -> None:
    kind = h5py.h5t.IEEE_F64LE.copy()
    kind.set_fields(63, 52, 11, 0, 32)
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", libver="earliest") as file:
        file["fs"], file["force"] = RATE, FORCE
        space = h5py.h5s.create_simple(MOTION.shape)
        h5py.h5d.create(file.id, b"acc", kind, space).write(space, space, np.ascontiguousarray(MOTION))
    with pytest.raises(InputError, match="'acc' has an unknown format of 64-bit numbers"):
        read_columns(path, layout(rate="fs"))


@pytest.mark.parametrize("newer", [False, True])
def test_hdf5_numbers_that_lack_a_chunk_are_refused(tmp_path: Path, newer: bool) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", libver="latest" if newer else "earliest") as file:
        file["fs"] = RATE
        file.create_dataset("force", data=FORCE, chunks=(1, 16), compression="gzip")
        acc = file.create_dataset("acc", FORCE.shape, "f8", chunks=(1, 16), compression="gzip")
        acc[0], acc[1, :32], acc[1, 48:] = MOTION[0], MOTION[1, :32], MOTION[1, 48:]
    with pytest.raises(InputError, match=r"'acc' lacks the numbers from index 1, 32 on, one of its chunks"):
        read_columns(path, layout(rate="fs"))
    with h5py.File(path, "a") as file:
        file["acc"][1] = MOTION[1]
    assert read_columns(path, layout(rate="fs")).points[0].count == HITS


@pytest.mark.parametrize("kind", [">f8", "<f4", "<i2", ">i4", "u1"])
def test_hdf5_numbers_of_any_ordinary_kind_are_read(tmp_path: Path, kind: str) -> None:
    values = np.round(30 * np.abs(FORCE)).astype(kind)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["fs"], file["force"], file["acc"] = RATE, values, values
    found = read_columns(tmp_path / "a.h5", layout(rate="fs"))
    np.testing.assert_array_equal(found.points[0].force, np.asarray(values, dtype=float))


@pytest.mark.parametrize(("name", "library"), [("a.tdms", "nptdms"), ("a.h5", "h5py")])
def test_a_library_that_is_not_there_is_named_with_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, library: str
) -> None:
    write, more = KINDS[name]
    write(tmp_path / name)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(
        InputError, match=rf"{library}, which is not installed; install modalkit-ema\[recorders\]"
    ):
        read_columns(tmp_path / name, layout(**more))


def test_a_beam_of_one_mode_has_its_frequency(tmp_path: Path) -> None:
    """One mode of 85 Hz hit by an impulse: the FRF of a recorder's file peaks there."""
    time = np.arange(4096) / RATE
    force = np.zeros_like(time)
    force[8] = 1.0
    response = np.exp(-0.01 * 2 * np.pi * 85 * time) * np.sin(2 * np.pi * 85 * time)
    np.savez(tmp_path / "a.npz", fs=RATE, force=force, acc=np.roll(response, 8) * (time >= 8 / RATE))
    (test,) = read_test(tmp_path / "a.npz", layout=layout(rate="fs"))
    frfs = estimate_frfs(test, verdicts=judge_hits(test))
    assert frfs.frequency[np.abs(frfs.values[0]).argmax()] == pytest.approx(85, abs=frfs.df)
