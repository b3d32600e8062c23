"""Warm processes: they run what they are handed, and know nothing else of modalkit."""

from __future__ import annotations

import sys
from pathlib import Path

from modalkit.workers import WarmProcess

PROGRAM = """
import sys
from pathlib import Path
from modalkit.workers.server import serve_standard

def program():
    Path(sys.argv[1]).write_text(" ".join(sys.modules))

serve_standard(program)
"""


def test_the_program_that_is_handed_over_runs_and_the_command_line_is_not_loaded(tmp_path: Path) -> None:
    with WarmProcess(command=[sys.executable, "-P", "-c", PROGRAM]) as process:
        process.run(tmp_path, ["loaded.txt"])
    loaded = (tmp_path / "loaded.txt").read_text().split()
    assert "modalkit.workers.server" in loaded
    assert "modalkit.cli" not in loaded
