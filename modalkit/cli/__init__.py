"""The command line."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from acquisition.errors import ModalkitError
from modalkit.cli.on_demand import CommandsOnDemand
from modalkit.module_path import leave_current_folder

app = typer.Typer(
    cls=CommandsOnDemand,
    help="From hammer hits to modes, to an updated model, to the cause of the gap between test and model.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)

_Usage: type[Exception] = typer.BadParameter.__mro__[1]
"""The error of wrong arguments, whichever click typer brings along."""

_BLAS_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def _version(asked: bool) -> None:
    if asked:
        from modalkit.version import __version__

        sys.stdout.write(f"modalkit {__version__}\n")
        raise typer.Exit


@app.callback()
def _program(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="show the version and exit")
    ] = False,
) -> None:
    """Stand for the program, which is a group even where it holds one command."""


def main() -> None:
    """Run the command line; an error on purpose is one line and exit code 2."""
    leave_current_folder()
    arguments = [a for a in sys.argv[1:] if a != "--debug"]
    debug = len(arguments) < len(sys.argv) - 1
    try:
        with _one_blas_thread():
            code = app(args=arguments, prog_name="modalkit", standalone_mode=False)
    except ModalkitError as error:
        if debug:
            raise
        _fail(str(error))
    except _Usage as error:
        if type(error).__name__ == "NoArgsIsHelpError":
            sys.stdout.write(_message(error) + "\n")
            sys.exit(0)
        _fail(_message(error))
    except (typer.Abort, KeyboardInterrupt):
        _fail("interrupted; nothing was written")
    except MemoryError as error:
        if debug:
            raise
        _fail(f"there is not enough memory ({error}); give fewer or shorter records, or a narrower band")
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        OSError,
        TypeError,
        ValueError,
    ) as error:
        if debug:
            raise
        _fail(f"internal error: {type(error).__name__}: {error}; `modalkit --debug ...` shows where")
    else:
        sys.exit(code if isinstance(code, int) else 0)


@contextmanager
def _one_blas_thread() -> Iterator[None]:
    """Keep linear algebra to one thread: two are slower on small eigenproblems.

    What is loaded later takes it from the environment, what is loaded already has to be asked.
    """
    os.environ.update(dict.fromkeys(_BLAS_THREADS, "1"))
    if "numpy" not in sys.modules:
        yield
        return
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def _message(error: Exception) -> str:
    """Return what click has to say about wrong arguments."""
    return str(getattr(error, "format_message", lambda: error)())


def _fail(message: str) -> None:
    from rich.console import Console

    Console(stderr=True, soft_wrap=True, highlight=False).print(
        f"modalkit: {message}", markup=False, style="bold red"
    )
    sys.exit(2)
