"""All figures of a result in one call."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from acquisition import FrfSet, HammerTest, InputError, ModalData, judge_hits
from acquisition.quantities import hertz
from identification import Correlation, ModalModel
from modalkit.figures.charts import (
    auto_mac_figure,
    cmif_figure,
    damping_figure,
    frf_figure,
    mac_figure,
    mvmif_figure,
    stabilisation_figure,
)
from modalkit.figures.diagnosis.figure import diagnosis_figure
from modalkit.figures.drawings import Drawings
from modalkit.figures.hits import hits_figure
from modalkit.figures.save import save_figures
from modalkit.figures.shapes.shapes import shapes_figure
from modalkit.figures.update import update_figures
from modalkit.workflow.existing import Modes
from modalkit.workflow.processed import Processed
from updating import Diagnosis
from updating.localisation import Localisation
from updating.update import Update


def draw(result: Any, *, folder: Path | str | None = None) -> Drawings:
    """Draw all there is to see of a result.

    Parameters
    ----------
    result : HammerTest, FrfSet, Processed, ModalModel, ModalData, Modes, Localisation, Diagnosis or Update
        What to draw; or a correlation of two tests, ``identification.Correlation``.
    folder : path, optional
        Where the figures are saved as PNG files too; made if it is not there.

    Returns
    -------
    Drawings
        A dictionary of figures by name, which is the file's; a notebook shows them.

    Raises
    ------
    InputError
        If there is no figure of such a thing, or the folder cannot be written to.
    """
    for kind, drawn in _BY_KIND.items():
        if isinstance(result, kind):
            figures = Drawings(drawn(result))
            break
    else:
        names = ", ".join(kind.__name__ for kind in _BY_KIND)
        raise InputError(f"no figures of a {type(result).__name__}; there are some of {names}")
    if folder is not None:
        save_figures(figures, folder)
    return figures


def _of_frfs(frfs: FrfSet) -> dict[str, Figure]:
    try:
        return {"frf": frf_figure(frfs), "cmif": cmif_figure(frfs), "mvmif": mvmif_figure(frfs)}
    except InputError:  # no response was measured with every reference
        return {"frf": frf_figure(frfs)}


def _of_processed(processed: Processed) -> dict[str, Figure]:
    names = ["hits"] + [f"hits_{n}" for n in range(2, len(processed.judged) + 1)]
    hits = {n: hits_figure(j.test, j.verdicts) for n, j in zip(names, processed.judged, strict=False)}
    return _of_frfs(processed.frfs) | hits


def _of_model(model: ModalModel) -> dict[str, Figure]:
    return {
        "frf": frf_figure(model.frfs, model),
        "stabilisation": stabilisation_figure(model),
        **_of_modes(model.modal),
    }


def _of_modes(modal: ModalData) -> dict[str, Figure]:
    known = modal.damping is not None and bool(np.isfinite(modal.damping).any())
    damping = {"damping": damping_figure(modal)} if known else {}
    return damping | {"auto_mac": auto_mac_figure(modal), "shapes": shapes_figure(modal)}


def _of_correlation(found: Correlation) -> dict[str, Figure]:
    rows, columns = (
        [f"{i + 1}: {hertz(f)}" for i, f in enumerate(m.frequency)] for m in (found.test, found.model)
    )
    title = f"{len(found.pairs)} pairs among {len(rows)} and {len(columns)} modes"
    note = f"MAC, shapes at {len(found.dofs)} degrees of freedom in common"
    return {
        "mac": mac_figure(
            found.mac, rows, columns, title=title, note=note, row_name="first test", column_name="second test"
        )
    }


def _of_localisation(found: Localisation) -> dict[str, Figure]:
    scores = np.stack([one.scores / one.scores.max() for one in found.found], axis=1)
    note = f"{found.kind} of each region: score, % of the largest score of the method"
    if found.spread:
        note += f"  ·  {found.spread}"
    return {
        "localisation": mac_figure(
            scores, found.regions, [one.method for one in found.found], title=found.consensus, note=note,
            row_name="region", column_name="method",
        )
    }  # fmt: skip


_BY_KIND: dict[type, Callable[[Any], dict[str, Figure]]] = {
    HammerTest: lambda test: {"hits": hits_figure(test, judge_hits(test))},
    FrfSet: _of_frfs,
    Processed: _of_processed,
    ModalModel: _of_model,
    ModalData: _of_modes,
    Modes: lambda modes: _of_modes(modes.modal),
    Correlation: _of_correlation,
    Localisation: _of_localisation,
    Diagnosis: lambda diagnosis: {"diagnosis": diagnosis_figure(diagnosis)},
    Update: update_figures,
}
