"""The page of the modes: the chart with a reason for every pole, the table, the fit, the auto-MAC."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from acquisition import InputError, ModalData
from acquisition.warned import in_order
from identification import ModalModel, cmif, mpc, mvmif
from identification.identify import Provisional
from identification.pole_reasons import Origins
from modalkit.study.read import Study
from modalkit.views.charts.frf import frf_names
from modalkit.views.charts.test import auto_mac_chart
from modalkit.views.curves import check_frf, lines
from modalkit.views.hits import first_frf, frf_page
from modalkit.views.stability import MEANINGS, pole_stability
from modalkit.workflow.existing import Modes
from modalkit.workflow.processed import Processed

WHENCE = {
    "chain": "stable poles of the chart",
    "refinement": "added by the refinement: the fit left a peak here that no pole of the chart explained",
    "named": "picked by you",
    "file": "read from the file",
}
"""Text on the origin of a mode."""


def table_of(modes: ModalModel | Modes, origins: Origins | None) -> list[dict[str, Any]]:
    """Return one row per mode."""
    modal = modes.modal
    assert modal.damping is not None
    assert modal.damping_sigma is not None
    purity = None if modal.shapes is None else mpc(modal.shapes)
    whence = ["file"] * len(modal) if origins is None else list(origins.modes)
    return [
        {
            "mode": r + 1,
            "frequency_hz": modal.frequency[r],
            "frequency_sigma_hz": modal.frequency_sigma[r],
            "damping_ratio": modal.damping[r],
            "damping_sigma": modal.damping_sigma[r],
            "mpc": None if purity is None else purity[r],
            "origin": whence[r],
            "whence": WHENCE[whence[r]],
        }
        for r in range(len(modal))
    ]


def modes_page(
    processed: Processed | None,
    modes: ModalModel | Modes,
    origins: Origins | None,
    study: Study,
    references: Sequence[str] = (),
) -> dict[str, Any]:
    """Return everything of the page but the fit of single FRFs; ``references`` are all that the files have."""
    page = {
        "table": table_of(modes, origins),
        "identified": False,
        "scaled": modes.modal.scaled,
        "warnings": list(in_order(modes.warnings)),
        "mac": _auto_mac(modes.modal),
        "band": study.test.band,
    }
    if processed is None or isinstance(modes, Modes) or origins is None:
        return page
    wanted = {name.strip().upper() for name in study.test.references}
    return page | {
        "identified": True,
        "band": modes.band,
        "band_stated": study.test.band is not None,
        "lines": [float(processed.frfs.frequency[0]), float(processed.frfs.frequency[-1])],
        "order": study.test.order,
        "picked": study.test.add,
        "dropped": study.test.drop,
        "references": [{"name": n, "used": not wanted or n.upper() in wanted} for n in references],
        "rejected": list(modes.points_rejected),
        "frfs": frf_names(modes.frfs),
        "first": first_frf(modes.frfs),
        "unit": modes.frfs.unit,
        "chart": _chart(modes, origins),
        "sum": _sum(modes),
    }


def _auto_mac(modal: ModalData) -> dict[str, Any] | None:
    """Return how alike the modes are; None of one mode, and at one degree of freedom."""
    chart = auto_mac_chart(modal, "mac") if len(modal) > 1 and len(modal.dofs) > 1 else None
    return None if chart is None else chart.data()


def _chart(model: ModalModel, origins: Origins) -> dict[str, Any]:
    """Return the poles in and next to the band, each with the number of its reason."""
    chart = model.chart
    low, high = model.band
    edge = 0.05 * (high - low)
    near = (chart.frequency >= low - edge) & (chart.frequency <= high + edge)
    return {
        "frequency": chart.frequency[near],
        "order": chart.orders[chart.level[near]],
        "damping": chart.damping[near],
        "reason": origins.chain[near],
        "letter": "".join(pole_stability(chart)[near]),
        "letters": MEANINGS,
        "reasons": [{"kind": r.kind, "text": r.text, "mode": r.mode} for r in origins.reasons],
        "orders": chart.orders,
        "references": chart.participation.shape[1],
    }


def _sum(model: ModalModel) -> dict[str, Any]:
    """Return the summed magnitude over the lines."""
    total = np.abs(model.frfs.values).sum(axis=0)
    return lines(model.frfs.frequency, sum=np.where(total > 0, total, np.nan))


def measured_page(processed: Processed, study: Study) -> dict[str, Any]:
    """Return the FRFs of a test before anything is identified: their sum, and the one that is shown first."""
    frfs = processed.frfs
    total = np.abs(frfs.values).sum(axis=0)
    return {
        "sum": lines(frfs.frequency, sum=np.where(total > 0, total, np.nan)),
        "band": study.test.band or [float(frfs.frequency[0]), float(frfs.frequency[-1])],
        "unit": frfs.unit,
        "frf": frf_page(processed, first_frf(frfs)),
    }


def indicators_page(model: ModalModel) -> dict[str, Any]:
    """Return the mode indicator functions over the lines, complex and multivariate; why, where there are none."""
    frfs = model.frfs
    try:
        found = {"CMIF": cmif(frfs), "MvMIF": mvmif(frfs)}
    except InputError as error:
        return {"why": str(error)}
    curves = {f"{name} {k}": np.asarray(table[k]) for name, table in found.items() for k in table.columns}
    return lines(frfs.frequency, **curves) | {"why": ""}


def fit_page(model: ModalModel, index: int) -> dict[str, Any]:
    """Return an FRF, its fit, and what the fit leaves beside the noise.

    Raises
    ------
    InputError
        If there is no such FRF.
    """
    frfs = model.frfs
    check_frf(frfs, index)
    measured, fitted = frfs.values[index], model.synthesise().values[index]
    noise = None if frfs.variance is None else np.sqrt(frfs.variance[index])
    return lines(
        frfs.frequency,
        measured=np.abs(measured),
        fitted=np.abs(fitted),
        residual=np.abs(measured - fitted),
        noise=noise,
        phase=np.degrees(np.angle(measured)),
        fitted_phase=np.degrees(np.angle(fitted)),
    ) | {"name": frf_names(frfs)[index], "unit": frfs.unit}


def provisional_page(found: Provisional, index: int) -> dict[str, Any]:
    """Return poles and one FRF of a fit whose last digits are being worked out."""
    frfs = found.frfs
    row = min(max(index, 0), len(frfs.responses) - 1)
    frequency = np.abs(found.poles) / (2 * np.pi)
    return {
        "frequency_hz": frequency,
        "damping_ratio": -found.poles.real / np.abs(found.poles),
        "fit": lines(
            frfs.frequency,
            fitted=np.abs(frfs.values[row]),
            fitted_phase=np.degrees(np.angle(frfs.values[row])),
        ),
    }
