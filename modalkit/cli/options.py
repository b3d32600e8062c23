"""Options that several commands share: how files and hits are to be treated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal, cast

import typer

from acquisition import ESTIMATORS, Estimator, FrfWindow, InputError
from modalkit.workflow.processing_options import ProcessingOptions, hit_name, sensor_mass


def quantity(unit: str) -> Callable[[object], object]:
    """Return what reads an option as a number, or as one with its unit, ``5kHz`` [``unit`` where it has none]."""

    def number(text: object) -> object:
        try:
            return float(text)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            from acquisition.si_units import si_value  # loads a table of units: not for plain numbers

            try:
                return si_value(text, unit)
            except ValueError as error:
                raise typer.BadParameter(str(error)) from error

    number.__name__ = "quantity"
    return number


Files = Annotated[list[Path], typer.Argument(help="file(s) of one test: UFF, or column text with --layout")]
Figures = Annotated[Path | None, typer.Option("--figures", help="folder for figures")]
Layout = Annotated[Path | None, typer.Option(help="layout of column text (docs/howto/column_text.md)")]
Decay = Annotated[
    float,
    typer.Option(
        help="decay of an exponential window applied before the file was written [1/s]",
        parser=quantity("1/s"),
    ),
]
WindowOn = Annotated[
    str | None,
    typer.Option(
        help="'both' or 'responses': channels to which the window of --decay was applied; default: detected"
    ),
]
Window = Annotated[
    float,
    typer.Option(
        help="decay of another exponential window, which this command applies [1/s]", parser=quantity("1/s")
    ),
]
FrfWindowOption = Annotated[
    str | None,
    typer.Option(
        "--frf-window",
        help="'none' or 'hann': window on the blocks that FRFs were averaged over; default: detected",
    ),
]
Band = Annotated[
    tuple[float, float] | None,
    typer.Option(help="frequency band [Hz], as 5 500 or 5Hz 1.2kHz", parser=quantity("Hz")),
]
Add = Annotated[
    list[float] | None,
    typer.Option(help="frequency at which a mode is kept [Hz]; may be repeated", parser=quantity("Hz")),
]
Drop = Annotated[
    list[float] | None,
    typer.Option(help="frequency of a mode to leave out [Hz]; may be repeated", parser=quantity("Hz")),
]
Estimate = Annotated[str, typer.Option("--estimator", help="H1, H2 or Hv")]
Use = Annotated[list[str] | None, typer.Option(help="rejected hit to use anyway, as 12+Z:3; may be repeated")]
Leave = Annotated[list[str] | None, typer.Option(help="hit to leave out, as 12+Z:3; may be repeated")]
SensorMass = Annotated[
    list[str] | None,
    typer.Option(
        "--sensor-mass",
        help="accelerometer whose mass is removed, as 25+Z=0.0086 (kg) or 25+Z=8.6g; may be repeated",
    ),
]
Report = Annotated[
    Path | None,
    typer.Option("--report", help="file for a report with figures: one HTML page, or .docx for Word"),
]


def processing(
    *,
    decay: float,
    window_on: str | None,
    window: float,
    estimator: str,
    use: list[str] | None,
    leave: list[str] | None,
    layout: Path | None,
    sensors: list[str] | None,
    frf_window: str | None = None,
) -> ProcessingOptions:
    """Return what the options say.

    Raises
    ------
    InputError
        If one of them cannot be understood.
    """
    if window_on not in (None, "both", "responses"):
        raise InputError(f"--window-on {window_on}: write both or responses")
    return ProcessingOptions(
        decay=decay,
        window_on=cast("Literal['both', 'responses'] | None", window_on),
        window=window,
        estimator=cast("Estimator", {e.lower(): e for e in ESTIMATORS}.get(estimator.lower(), estimator)),
        use=tuple(hit_name(h) for h in use or ()),
        leave=tuple(hit_name(h) for h in leave or ()),
        layout=layout,
        sensor_masses=tuple(sensor_mass(s) for s in sensors or ()),
        frf_window=cast("FrfWindow | None", frf_window),
    )
