"""The command line."""

from __future__ import annotations

import sys

import typer
from rich.console import Console
from threadpoolctl import threadpool_limits

from acquisition.errors import ModalkitError
from modalkit.cli import batching, blinding, compare, demonstrate, diagnosing, fitting, look, simulating

app = typer.Typer(
    help="From hammer hits to modes, to an updated model, to the cause of the gap between test and model.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for module in (look, compare, fitting, diagnosing, simulating, blinding, batching, demonstrate):
    module.add_commands(app)

_Usage: type[Exception] = typer.BadParameter.__mro__[1]
"""The error of wrong arguments, whichever click typer brings along."""


def main() -> None:
    """Run the command line; an error on purpose is one line and exit code 2."""
    arguments = [a for a in sys.argv[1:] if a != "--debug"]
    debug = len(arguments) < len(sys.argv) - 1
    try:
        with threadpool_limits(1, user_api="blas"):  # two threads are slower on small eigenproblems
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
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        MemoryError,
        OSError,
        TypeError,
        ValueError,
    ) as error:
        if debug:
            raise
        _fail(f"this should not have happened: {type(error).__name__}: {error}; run again with --debug")
    else:
        sys.exit(code if isinstance(code, int) else 0)


def _message(error: Exception) -> str:
    """Return what click has to say about wrong arguments."""
    return str(getattr(error, "format_message", lambda: error)())


def _fail(message: str) -> None:
    Console(stderr=True, soft_wrap=True, highlight=False).print(
        f"modalkit: {message}", markup=False, style="bold red"
    )
    sys.exit(2)
