"""From files without a layout to modes: `inspect --write-layout`, then `identify --layout`, nothing edited between."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

Run = Callable[..., tuple[int, str, str]]
RATE, SAMPLES = 1024.0, 2048
TIME = np.arange(SAMPLES) / RATE


def hits(folder: Path) -> list[Path]:
    """Write two hits at each of two points of a structure with a mode at 85 Hz and 1 % damping."""
    paths = []
    rng = np.random.default_rng(4)
    decay = np.exp(-0.01 * 2 * np.pi * 85 * TIME) * np.cos(2 * np.pi * np.sqrt(1 - 1e-4) * 85 * TIME)
    for node, shape in ((1, 1.0), (2, 0.6)):
        for hit in (1, 2):
            force = np.exp(-(((TIME - 0.02) / 0.0015) ** 2)) * 100
            motion = shape * np.convolve(force, decay)[:SAMPLES] / 100
            rows = np.stack([TIME, force, motion + 1e-5 * rng.standard_normal(SAMPLES)], axis=1)
            paths.append(folder / f"P{node}_{hit}.csv")
            np.savetxt(paths[-1], rows, "%.8g", ",", header="time,hammer [N],acc 1 [m/s2]", comments="")
    return paths


def test_a_written_layout_leads_to_modes(run: Run, tmp_path: Path) -> None:
    paths, layout = hits(tmp_path), tmp_path / "l.toml"
    code, text, err = run("inspect", *paths, "--write-layout", layout)
    assert (code, err) == (0, "")
    assert "written: " in text and "4 hits at 2 points (1+Z, 2+Z), seen at 1 point (1+Z)" in text
    code, text, _ = run("identify", *paths, "--layout", layout, "--band", "20", "200")
    assert code == 0
    (frequency,) = re.findall(r"^ +1 +([\d.]+) ", text, re.MULTILINE)
    assert float(frequency) == pytest.approx(85, rel=1e-3)


def test_a_layout_replaces_no_other_file_and_no_other_layout(run: Run, tmp_path: Path) -> None:
    paths = hits(tmp_path)
    (tmp_path / "study.toml").write_text('title = "mine"\n')
    code, _, err = run("inspect", *paths, "--write-layout", tmp_path / "study.toml")
    assert code == 2 and "study.toml" in err
    assert (tmp_path / "study.toml").read_text() == 'title = "mine"\n'
    code, _, err = run(
        "inspect", paths[0], "--layout", tmp_path / "study.toml", "--write-layout", tmp_path / "l.toml"
    )
    assert code == 2 and "leave one out" in err


def test_several_tables_without_a_layout_are_refused_with_the_option_to_add(run: Run, tmp_path: Path) -> None:
    code, _, err = run("inspect", *hits(tmp_path))
    assert code == 2
    assert "these files were read as tables of modes" in err
    assert "for hits or FRFs add --layout" in err and "--write-layout" in err


@pytest.mark.parametrize(
    ("name", "page"), [("a.tdms", "recorders"), ("a.wav", "recorders"), ("a.h5", "recorders")]
)
def test_a_file_of_a_recorder_without_a_layout_is_refused(
    run: Run, tmp_path: Path, name: str, page: str
) -> None:
    (tmp_path / name).write_bytes(b"x")
    code, _, err = run("inspect", tmp_path / name)
    assert code == 2
    assert "needs a layout file" in err and f"docs/howto/{page}.md" in err and len(err.splitlines()) == 1


def test_frfs_without_a_stated_window_say_that_one_would_be_in_the_damping(run: Run, tmp_path: Path) -> None:
    lines = np.arange(1.0, 201.0)
    s = 2j * np.pi * lines
    frf = s**2 / (s**2 + 12.0 * s + (2 * np.pi * 85.0) ** 2)
    frf = frf + 1e-3 * np.random.default_rng(1).standard_normal((200, 2)) @ np.array([1.0, 1j])
    savemat(tmp_path / "h.mat", {"f": lines, "H": frf[:, None]})
    code, _, err = run("inspect", tmp_path / "h.mat", "--write-layout", tmp_path / "l.toml")
    assert (code, err) == (0, "")
    known = (tmp_path / "h.mat", "--layout", tmp_path / "l.toml")
    code, text, _ = run("identify", *known)
    assert code == 0 and "Window: none is stated" in text and "--decay removes it" in text
    code, text, _ = run("identify", *known, "--decay", "2")
    assert code == 0 and "none is stated" not in text and "2 1/s of decay was removed" in text
