"""What tests of universal files share."""

from __future__ import annotations

import pytest

from acquisition import (
    InputError,
    UffContent,
    read_uff,
)


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
