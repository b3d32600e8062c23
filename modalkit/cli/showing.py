"""What the commands that look at a test print, save and draw."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acquisition import HitVerdict, force_range, hits_table, write_uff
from modalkit.cli.common import out, several, show_table, show_warnings, working
from modalkit.write import write_json

if TYPE_CHECKING:
    import pandas as pd

    from identification import ModalModel
    from modalkit.reading import Processed


def save_modes(
    processed: Processed, model: ModalModel, warnings: Sequence[str], json: Path | None, uff: Path | None
) -> None:
    """Write the modes as JSON and as UFF, where files are given, and say so."""
    from modalkit.records import modes_record

    if json is not None:
        write_json(json, modes_record(model, processed.hits, warnings))
        out.print(f"written: {json}", markup=False)
    if uff is not None:
        write_uff(uff, modal=model.modal, geometry=model.modal.geometry, title=processed.content.title)
        out.print(f"written: {uff}", markup=False)


def show_rejected(hits: Sequence[HitVerdict], more: Sequence[str] = ()) -> None:
    """Print the points that were left out, with the reason."""
    from modalkit.records import without_hits

    for text in [*without_hits(hits), *more]:
        out.print(f"left out: {text}", markup=False)


def show_modes(model: ModalModel) -> None:
    """Print the modes, and what is to be known of their shapes."""
    digits = {"frequency [Hz]": 4, "sigma [Hz]": 5, "damping [%]": 4, "sigma [%]": 5, "MPC": 3}
    title = f"{several(len(model), 'mode')} between {model.band[0]:g} and {model.band[1]:g} Hz"
    show_table(model.table(), title, digits=digits)
    scaled = "mass-normalised" if model.modal.scaled else "not mass-normalised (no drive point to trust)"
    out.print(f"Shapes at {several(len(model.modal.dofs), 'degree')} of freedom, {scaled}.")
    if model.frfs.decay:
        out.print(f"Window: {model.frfs.decay:.4g} 1/s of decay was taken out of the damping.")


def show_hits(hits: Sequence[HitVerdict]) -> None:
    """Print how many hits are used, what is thought of the others, and what the forces reach."""
    if not hits:
        return
    left = [h for h in hits if not h.used]
    out.print(f"{several(len(hits), 'hit')}, {len(left)} left out" + (":" if left else "."))
    table = hits_table(hits)
    noted: pd.DataFrame = table[[bool(h.reasons) for h in hits]]
    if len(noted):
        show_table(noted)
    force = force_range(hits)
    if force is not None:
        out.print(f"Force: {force}.")


def show_second_opinion(processed: Processed, model: ModalModel) -> None:
    """Print the poles of sdypy-EMA beside the modes."""
    from identification import beside, second_opinion

    with working("asking sdypy-EMA"):
        table = second_opinion(processed.frfs, band=model.band)
    both = beside(model.modal, table)
    title = "Second opinion, beside ours: sdypy-EMA (LSCF)"
    show_table(both, title, digits=dict.fromkeys(both.columns, 4))
    show_warnings(table.attrs.get("warnings", ()))


def frf_figures(processed: Processed) -> dict[str, Any]:
    """Draw FRFs and hits."""
    from modalkit.figures import frf_figure

    return {"frf": frf_figure(processed.frfs), **_hit_figures(processed)}


def _hit_figures(processed: Processed) -> dict[str, Any]:
    from modalkit.figures import hits_figure

    names = ["hits"] + [f"hits_{n}" for n in range(2, len(processed.judged) + 1)]
    return {n: hits_figure(j.test, j.verdicts) for n, j in zip(names, processed.judged, strict=False)}


def mode_figures(processed: Processed, model: ModalModel) -> dict[str, Any]:
    """Draw FRFs, modes and hits."""
    from modalkit.figures import auto_mac_figure, frf_figure, shapes_figure, stabilisation_figure

    return {
        "frf": frf_figure(model.frfs, model),
        "stabilisation": stabilisation_figure(model),
        "auto_mac": auto_mac_figure(model.modal),
        "shapes": shapes_figure(model.modal),
        **_hit_figures(processed),
    }
