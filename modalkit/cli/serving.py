"""The command that opens the app."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modalkit.cli.common import out
from modalkit.cli.options import Layout


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command(name="app")(open_app)


def open_app(
    file: Annotated[
        Path,
        typer.Argument(
            help="study file, a file of hits, FRFs or modes, or a folder of text or recorder files"
        ),
    ],
    no_browser: Annotated[bool, typer.Option("--no-browser", help="only print the address")] = False,
    port: Annotated[int, typer.Option(min=0, max=65535, help="port on this machine; 0: any free one")] = 0,
    layout: Layout = None,
) -> None:
    """Open the app on this machine: pick poles, watch shapes, compare with the model, diagnose."""
    from modalkit.app.serve import serve

    def ready(address: str) -> None:
        out.print(address, markup=False)
        out.print("Only this machine can reach it; Ctrl-C stops it and keeps all changes.", markup=False)

    serve(file, layout=layout, port=port, browser=not no_browser, ready=ready)
