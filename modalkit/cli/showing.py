"""What the commands that look at a test print, save and draw."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition import EstimationError, HitVerdict, force_range, hits_table
from acquisition.display import counted
from modalkit.cli.common import out, show_table, show_warnings
from modalkit.cli.progress import working
from modalkit.output.whole import write_json
from modalkit.workflow.existing import Modes
from modalkit.workflow.stages import SECOND_OPINION

if TYPE_CHECKING:
    import pandas as pd

    from identification import ModalModel
    from modalkit.workflow.processed import Processed


def save_modes(
    processed: Processed | None,
    model: ModalModel | Modes,
    warnings: Sequence[str],
    json: Path | None,
    output: Path | None,
) -> None:
    """Write the modes as JSON, and as what the ending of the output names, where files are given, and say so."""
    from modalkit.output.documents import modes_document
    from modalkit.output.modes import write_modes

    hits = () if processed is None else processed.hits
    title = "" if processed is None else processed.content.title
    if json is not None:
        write_json(json, modes_document(model, hits, warnings))
        out.print(f"written: {json}", markup=False)
    if output is not None:
        write_modes(output, model, hits=hits, warnings=warnings, title=title)
        out.print(f"written: {output}", markup=False)


def show_rejected(hits: Sequence[HitVerdict], more: Sequence[str] = ()) -> None:
    """Print the points that were left out, with the reason."""
    from modalkit.output.documents import without_hits

    for text in [*without_hits(hits), *more]:
        out.print(f"left out: {text}", markup=False)


def show_modes(model: ModalModel | Modes) -> None:
    """Print the modes, and what is to be known of their shapes."""
    digits = {"frequency [Hz]": 4, "sigma [Hz]": 5, "damping [%]": 4, "sigma [%]": 5, "MPC": 3}
    if isinstance(model, Modes):
        where, unscaled = f"from {model.source}", "not mass-normalised"
    else:
        where = f"between {model.band[0]:g} and {model.band[1]:g} Hz"
        unscaled = "not mass-normalised (no reliable drive point)"
    show_table(model.table(), f"{counted(len(model), 'mode')} {where}", digits=digits)
    if model.modal.shapes is None:
        out.print("No shapes.")
        return
    scaled = "mass-normalised" if model.modal.scaled else unscaled
    out.print(f"Shapes at {counted(len(model.modal.dofs), 'degree')} of freedom, {scaled}.")
    if isinstance(model, Modes):
        return
    if model.frfs.decay:
        out.print(f"Window: {model.frfs.decay:.4g} 1/s of decay was removed from the damping.")
    elif model.frfs.record is None and model.frfs.line_shape is None:
        out.print(
            "Window: none is stated. If an exponential window was applied, its decay is still in the "
            "damping; --decay removes it."
        )


def show_hits(hits: Sequence[HitVerdict]) -> None:
    """Print how many hits are used, what is thought of the others, and what the forces reach."""
    if not hits:
        return
    left = [h for h in hits if not h.used]
    out.print(f"{counted(len(hits), 'hit')}, {len(left)} left out" + (":" if left else "."))
    table = hits_table(hits)
    noted: pd.DataFrame = table[[bool(h.reasons) for h in hits]]
    if len(noted):
        show_table(noted)
    force = force_range(hits)
    if force is not None:
        out.print(f"Force: {force}.")


def show_second_opinion(processed: Processed, model: ModalModel) -> None:
    """Print the poles of sdypy-EMA beside the modes, or why it has none."""
    from identification import beside, second_opinion

    try:
        with working(SECOND_OPINION):
            table = second_opinion(processed.frfs, band=model.band)
    except EstimationError as error:
        show_warnings([f"no comparison: {error}"])
        return
    both = beside(model.modal, table)
    title = "For comparison: sdypy-EMA (LSCF)"
    show_table(both, title, digits=dict.fromkeys(both.columns, 4))
    show_warnings(table.attrs.get("warnings", ()))
