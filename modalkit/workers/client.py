"""The asking side: a warm process that is given one command after another, and a new one when it dies."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from acquisition.errors import EstimationError
from modalkit.module_path import child_environment

COMMAND = (sys.executable, "-P", "-m", "modalkit.cli.warm")
"""Starts what serves modalkit's commands; another command may serve others."""

TIMEOUT = 900.0
ATTEMPTS = 3
_GRACE = 60.0  # s beyond a command's time in which the process must have answered
_START = 300.0  # s in which it must have loaded
_KEPT = frozenset(
    (
        *("PATH", "HOME", "USERPROFILE", "LANG", "LC_ALL", "LC_CTYPE", "TMPDIR", "TEMP", "TMP"),
        *("PYTHONHOME", "VIRTUAL_ENV", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH"),
        *("SYSTEMROOT", "PATHEXT", "COMSPEC"),
    )
)
_SET = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}


class CommandFailedError(EstimationError):
    """A command ended with a code, not with a result.

    Parameters
    ----------
    command : str
        Its name.
    code : int
        The code [-].
    message : str
        Its message on failure.
    """

    def __init__(self, command: str, code: int, message: str) -> None:
        """State what failed, and how."""
        super().__init__(f"`modalkit {command}` ended with code {code}: {message}")
        self.message = message


class WarmProcess:
    """A process with modalkit loaded, for commands that must be independent of this one.

    It gets what an interpreter needs of the environment, no descriptors but its pipes, and one BLAS thread; the
    current folder is not on its module path. One
    command at a time; a process that dies is replaced, and the command repeated.

    Parameters
    ----------
    command : sequence of str
        What is started; it uses the protocol of :mod:`modalkit.workers.server`.
    timeout : float
        Longest time a command may take [s].
    attempts : int
        How often a command is tried whose process dies [-].
    """

    def __init__(
        self,
        *,
        command: Sequence[str] = COMMAND,
        timeout: float = TIMEOUT,
        attempts: int = ATTEMPTS,
    ) -> None:
        """State what is to be started; it starts with the first command."""
        self.command = tuple(command)
        self.timeout = timeout
        self.attempts = attempts
        self._process: subprocess.Popen[bytes] | None = None
        self._greeted = False
        self._over = False

    def __enter__(self) -> Self:
        """Start the process."""
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the process."""
        self.close()

    @property
    def pid(self) -> int | None:
        """Number of the process; None before it is started."""
        return None if self._process is None else self._process.pid

    def start(self, *, wait: bool = True) -> None:
        """Start the process, if there is none.

        Parameters
        ----------
        wait : bool
            Whether to wait until everything is loaded in it.

        Raises
        ------
        EstimationError
            If it does not come up, or was closed.
        """
        if self._over:
            raise EstimationError("the process was closed; start another one")
        if self._process is None:
            self._process = subprocess.Popen(
                self.command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={k: v for k, v in os.environ.items() if k in _KEPT} | _SET | child_environment(),
                start_new_session=True,
            )
            self._greeted = False
        if wait and not self._greeted:
            hello = self._read(_START)
            if hello is None or "ready" not in hello:
                self._end()
                raise EstimationError(
                    f"the process `{' '.join(self.command)}` did not start; start it by hand to see why"
                )
            self._greeted = True

    def close(self) -> None:
        """End the process for good; what it is at work on is lost."""
        self._over = True
        self._end()

    def _end(self) -> int:
        """End the process and return its exit code; no code is 0."""
        process, self._process = self._process, None
        if process is None:
            return 0
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(OSError):
            process.stdin.close()  # it ends when no request comes any more
        if not self._greeted:
            process.kill()  # it is still loading, and at work on nothing
        try:
            code = process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        process.stdout.close()
        return code

    def run(self, folder: Path, arguments: Sequence[str]) -> None:
        """Run a command and wait for its end.

        Parameters
        ----------
        folder : Path
            Where it runs.
        arguments : sequence of str
            Its words, without ``modalkit``.

        Raises
        ------
        EstimationError
            If it fails, does not end in time, or its process dies again and again.
        """
        request = {"folder": str(folder.resolve()), "arguments": list(arguments), "timeout": self.timeout}
        died = "it did not start"
        for _ in range(self.attempts):
            self.start()
            answer = self._ask(request)
            if answer is None:
                died = self._bury()
            elif answer["late"]:
                raise EstimationError(f"`modalkit {arguments[0]}` did not end within {self.timeout:g} s")
            elif answer["signal"] is not None:
                died = f"ended by {_signal_name(answer['signal'])}"
            elif answer["code"] != 0:
                message = answer["message"].removeprefix("modalkit: ") or "no message"
                raise CommandFailedError(arguments[0], answer["code"], message)
            else:
                return
        raise EstimationError(
            f"the process of `modalkit {arguments[0]}` died {self.attempts} times ({died}); memory may be "
            "too small, or another program ends it"
        )

    def _ask(self, request: Mapping[str, Any]) -> dict[str, Any] | None:
        """Return the answer to a request; None where the process has died of it."""
        process = self._process
        if process is None or process.stdin is None:
            return None
        try:
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        except (OSError, ValueError):
            return None
        return self._read(self.timeout + _GRACE)

    def _read(self, seconds: float) -> dict[str, Any] | None:
        """Return the next line; None where there is none, or not in time."""
        process = self._process
        if process is None or process.stdout is None:
            return None
        alarm = threading.Timer(seconds, process.kill)
        alarm.daemon = True
        alarm.start()
        try:
            line = process.stdout.readline()
        finally:
            alarm.cancel()
        try:
            content: dict[str, Any] = json.loads(line)
        except ValueError:
            return None
        return content

    def _bury(self) -> str:
        """Clear a dead process away and return what it died of."""
        code = self._end()
        return f"ended by {_signal_name(-code)}" if code < 0 else f"ended with code {code}"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
