"""The serving side: read a command per line, run it in a fork with nothing else loaded, answer a line."""

from __future__ import annotations

import contextlib
import gc
import io
import json
import os
import select
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, Literal, NoReturn

from modalkit.version import __version__

Program = Callable[[], None]
"""What is served: it takes its words from ``sys.argv`` and ends as programs do, or returns."""

_LAST = 4000  # bytes of a command's messages that are kept


def serve_standard(program: Program) -> None:
    """Serve a program, which is loaded already, on standard input and output until the input ends.

    Each line in is ``{"folder", "arguments", "timeout"}``: where the command runs, its words without
    ``modalkit``, and the longest time it may take [s]. Each line out is ``{"code", "signal", "late",
    "message"}``: the exit code or the signal that ended it, whether its time was over, and its last line on
    standard error. The first line out, ``{"ready": version}``, means that everything is loaded.

    Parameters
    ----------
    program : callable
        What each command runs.
    """
    requests = os.fdopen(os.dup(0), "rb", buffering=0)
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    os.close(nothing)
    serve(program, requests, answers)


def serve(program: Program, requests: BinaryIO, answers: BinaryIO) -> None:
    """Answer requests until they end.

    Parameters
    ----------
    program : callable
        What each command runs.
    requests, answers : binary file
        Unbuffered; one JSON document a line.
    """
    gc.collect()
    gc.freeze()  # what is loaded is shared with the forks; collecting in it would copy it
    answers.write(_line({"ready": __version__}))
    run = _forked if hasattr(os, "fork") else _here
    while line := requests.readline():
        request = json.loads(line)
        answer = run(program, request, requests)
        if answer is None:
            return
        answers.write(_line(answer))


def _line(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content).encode() + b"\n"


def _forked(program: Program, request: Mapping[str, Any], requests: BinaryIO) -> dict[str, Any] | None:
    """Run a command in a fork; None where nobody is left who waits for the answer."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _become(program, writing, Path(request["folder"]), request["arguments"])
    os.close(writing)
    output, ended = _listen(reading, requests, time.monotonic() + float(request["timeout"]))
    os.close(reading)
    if ended != "done":
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)  # in case it had no group of its own yet
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if ended == "alone":
        return None
    return _answer(code, output.decode(errors="replace"), late=ended == "late")


def _answer(code: int, output: str, *, late: bool = False) -> dict[str, Any]:
    return {
        "code": code if code >= 0 else None,
        "signal": -code if code < 0 else None,
        "late": late,
        "message": (output.strip().splitlines() or [""])[-1],
    }


def _listen(reading: int, requests: BinaryIO, end: float) -> tuple[bytes, Literal["done", "late", "alone"]]:
    """Gather the output of a fork until it is done, late, or no longer needed; keeps the last of it."""
    output = b""
    while (left := end - time.monotonic()) > 0:
        ready, _, _ = select.select([reading, requests.fileno()], [], [], left)
        if (
            requests.fileno() in ready
        ):  # there is no further request before the answer: the other side has gone
            return output, "alone"
        if reading in ready:
            part = os.read(reading, 65536)
            if not part:
                return output, "done"
            output = (output + part)[-_LAST:]
    return output, "late"


def _become(program: Program, saying: int, folder: Path, arguments: Sequence[str]) -> NoReturn:
    """Turn a fork into the command: own group, own folder, no descriptor but the one it writes to."""
    code = 70
    try:
        os.setsid()
        os.dup2(saying, 2)
        os.closerange(3, os.sysconf("SC_OPEN_MAX"))
        code = _command(program, folder, arguments)
        sys.stderr.flush()
    finally:
        os._exit(code)


def _command(program: Program, folder: Path, arguments: Sequence[str]) -> int:
    """Run a command in a folder and return its exit code."""
    os.chdir(folder)
    sys.argv = ["modalkit", *arguments]
    try:
        program()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return 0


def _here(program: Program, request: Mapping[str, Any], _: BinaryIO) -> dict[str, Any]:
    """Run a command in this process, where there are no forks."""
    home, words, output = Path.cwd(), sys.argv, io.StringIO()
    try:
        with contextlib.redirect_stderr(output):
            code = _command(program, Path(request["folder"]), request["arguments"])
    finally:
        os.chdir(home)
        sys.argv = words
    return _answer(code, output.getvalue())
