"""What cannot be identified is refused with the reason, and with the band that was asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, FrfSet, HammerTest, Hits, InputError, write_uff
from acquisition.errors import EstimationError
from modalkit.workflow.files import read_files
from modalkit.workflow.identification import read
from modalkit.workflow.processed import _naming_band


def stored_frf(path: Path) -> str:
    """Write one FRF as text, and return the file's content."""
    values = np.ones((1, 64)) * (1 + 1j)
    frfs = FrfSet(np.arange(64.0), values, (Dof(1, 3),), (Dof(1, 3),))
    write_uff(path, frfs=frfs, form="ascii")
    return path.read_text(encoding="ascii")


def test_an_uneven_abscissa_is_the_reason_that_inspect_gives(tmp_path: Path) -> None:
    """Field 3 of record 7 states the spacing: 1 for even, 0 for uneven."""
    path = tmp_path / "uneven.uff"
    rows = stored_frf(path).splitlines()
    (place,) = [k for k, row in enumerate(rows) if row.split()[:3] == ["6", "64", "1"]]
    rows[place] = rows[place][:20] + f"{0:10d}" + rows[place][30:]
    path.write_text("\n".join(rows) + "\n", encoding="ascii")
    content = read_files(path)
    assert content.reasons and "uneven.uff, data set 58" in content.reasons[0]
    with pytest.raises(InputError) as raised:
        read(path)
    assert str(raised.value).startswith(content.reasons[0]) and "no raw hits and no FRFs are usable" in str(
        raised.value
    )


def test_responses_without_a_force_are_the_reason_that_inspect_gives(tmp_path: Path) -> None:
    path = tmp_path / "responses.uff"
    wave = np.sin(0.1 * np.arange(256.0))
    hits = Hits(Dof(1, 3), (Dof(2, 3),), np.eye(1, 256, 9), wave[None, None])
    write_uff(path, tests=HammerTest(256.0, (hits,)), form="ascii")
    whole = path.read_text(encoding="ascii").split("    -1\n    58")
    kept = [part for k, part in enumerate(whole) if k != 1]
    path.write_text("    -1\n    58".join(kept), encoding="ascii")
    (reason,) = read_files(path).reasons
    assert "without a force" in reason
    with pytest.raises(InputError, match="without a force"):
        read(path)


def test_where_nothing_is_found_the_band_asked_for_is_named_with_why_a_part_was_used() -> None:
    frfs = FrfSet(np.arange(2.0), np.ones((1, 2)), (Dof(1, 3),), (Dof(1, 3),), source="a.uff")
    with (
        pytest.raises(
            EstimationError, match=r"a\.uff: no mode is found between 5 and 500 Hz; the force is weak"
        ),
        _naming_band(frfs, (5.0, 500.0), "the force is weak"),
    ):
        raise EstimationError("no pole is stable between 5 and 310 Hz")
    with (
        pytest.raises(EstimationError, match=r"between 5 and 310 Hz"),
        _naming_band(frfs, (5.0, 310.0), None),
    ):
        raise EstimationError("no pole is stable between 5 and 310 Hz")
