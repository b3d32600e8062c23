"""A small program in the diagnosing process's place: it always answers that there is no gap."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

NONE: dict[str, Any] = json.loads((Path(__file__).resolve().parents[2] / "no_gap.json").read_text())


def command(*words: object) -> list[str]:
    """Return the command that starts this program."""
    return [sys.executable, str(Path(__file__).resolve()), *map(str, words)]


def diagnose(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
    """Diagnose in this process."""
    return NONE


def text_of(path: Path) -> str:
    """Return what can be read of a file, without waiting for a pipe's other end."""
    with contextlib.suppress(OSError):
        if path.is_file():
            return path.read_bytes().decode("latin-1")
    return ""


def everything(folder: Path) -> str:
    """Return all that a diagnosis could look at for the truth."""
    parent = Path("/proc") / str(os.getppid())
    seen = [str(sys.argv), str(os.environ), str(folder), str(Path.cwd())]
    for above in (folder, *folder.parents):
        seen += [p.name for p in above.iterdir()]
    seen += [text_of(p) for p in folder.parent.rglob("*")]  # the folder for temporary files, all of it
    seen += [text_of(parent / "cmdline"), text_of(parent / "environ")]
    with contextlib.suppress(OSError):
        for link in (parent / "fd").iterdir():
            with contextlib.suppress(OSError):
                seen += [str(link.readlink()), text_of(link)]
    seen += [f"fd {p.name}" for p in Path("/proc/self/fd").iterdir()] if Path("/proc").is_dir() else []
    return "\n".join(seen)


def answer(mode: str, words: list[str], folder: Path) -> None:
    """Do what the mode says, then write the diagnosis."""
    if mode == "always-dies" or (mode == "dies-once" and not Path(words[0]).exists()):
        if mode == "dies-once":
            Path(words[0]).write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    if mode == "slow":
        time.sleep(float(words[0]))
    if mode == "curious":
        with Path(words[0]).open("a") as file:
            file.write(json.dumps(everything(folder)) + "\n")
    if mode != "silent":
        (folder / "diagnosis.json").write_text(json.dumps(NONE))


def say(document: Mapping[str, Any]) -> None:
    sys.stdout.write(json.dumps(document) + "\n")
    sys.stdout.flush()


def main() -> None:
    mode, *words = sys.argv[1:] or ["plain"]
    say({"ready": "stub"})
    for line in sys.stdin:
        answer(mode, words, Path(json.loads(line)["folder"]))
        say({"code": 0, "signal": None, "late": False, "message": ""})


if __name__ == "__main__":
    main()
