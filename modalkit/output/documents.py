"""Results as the documents of the JSON files, whose keys are a contract."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition import HitVerdict, ModalData, rejected_points
from identification import ModalModel, mpc
from modalkit.output.fields import fill
from modalkit.output.schemas.diagnosis import (
    SOMETHING_ELSE,
    CauseEntry,
    DiagnosisDocument,
    EstimateEntry,
    RankedEntry,
)
from modalkit.output.schemas.modes import HitEntry, ModeEntry, ModesDocument, ShapeEntry, TrendEntry
from modalkit.workflow.existing import Modes
from updating import Diagnosis
from updating.diagnosis.answer.in_no_library import SomethingElse
from updating.diagnosis.answer.ranked import Ranked
from updating.diagnosis.answer.verdict import NAME


def modes_document(
    model: ModalModel | Modes, hits: Sequence[HitVerdict] = (), warnings: Sequence[str] = ()
) -> ModesDocument:
    """Return an identification, or modes that were read, as ``modalkit.modes/1``.

    Beside the contract's keys it has ``nodes``, where their places are known, so that the file can be read back, and
    the ``trend`` of the frequencies over the test, which is not.
    """
    modal = model.modal
    assert modal.damping is not None
    assert modal.damping_sigma is not None
    purity = None if modal.shapes is None else mpc(modal.shapes)
    modes: list[ModeEntry] = [
        {
            "frequency_hz": modal.frequency[r],
            "frequency_sigma_hz": modal.frequency_sigma[r],
            "damping_ratio": modal.damping[r],
            "damping_sigma": modal.damping_sigma[r],
            "shape": _shape(modal, r),
            "mpc": None if purity is None else purity[r],
            "scaled": modal.scaled,
        }
        for r in range(len(modal))
    ]
    return {
        "schema": "modalkit.modes/1",
        "modes": modes,
        "points_rejected": [
            *without_hits(hits),
            *(() if isinstance(model, Modes) else model.points_rejected),
        ],
        "hits": [hit_document(h) for h in hits],
        "window_decay_removed": 0.0 if isinstance(model, Modes) else model.frfs.decay,
        "warnings": list(warnings),
        "nodes": [
            {"node": node, "x": x, "y": y, "z": z}
            for node, (x, y, z) in zip(modal.geometry.nodes, modal.geometry.coordinates, strict=True)
        ],
        "trend": None if isinstance(model, Modes) or model.trend is None else fill(TrendEntry, model.trend),
    }


def _shape(modal: ModalData, mode: int) -> list[ShapeEntry]:
    if modal.shapes is None:
        return []
    return [
        {
            "node": dof.node,
            "direction": dof.direction,
            "re": modal.shapes[i, mode].real,
            "im": modal.shapes[i, mode].imag,
            "sigma": None if modal.shape_sigma is None else modal.shape_sigma[i, mode],
        }
        for i, dof in enumerate(modal.dofs)
    ]


def without_hits(hits: Sequence[HitVerdict]) -> list[str]:
    """Return the points of which no hit is used, with the reason."""
    return [f"{point}: none of its hits is used" for point in rejected_points(hits)]


def hit_document(hit: HitVerdict) -> HitEntry:
    """Return the verdict on one hit."""
    return fill(HitEntry, hit)


def diagnosis_document(diagnosis: Diagnosis, warnings: Sequence[str] = ()) -> DiagnosisDocument:
    """Return a diagnosis as ``modalkit.diagnosis/1``."""
    rows = [_ranked_document(row, named=row.effects in diagnosis.sets) for row in diagnosis.ranking]
    ranking = _with_something_else(rows, diagnosis.something_else)
    return fill(
        DiagnosisDocument,
        diagnosis,
        cause=fill(CauseEntry, diagnosis, ranking=ranking),
        rules=diagnosis.rules.changed,
        warnings=[*diagnosis.warnings, *warnings],
    )


def _with_something_else(rows: list[RankedEntry], other: SomethingElse | None) -> list[RankedEntry]:
    """Return the rows of the ranking with that of a cause in no library, all shares those of the whole."""
    if other is None:
        return rows
    sets, rest = sum(row["probability"] for row in rows), 1.0 - other.probability
    whole = rest + sets * other.probability
    shared: list[RankedEntry] = [{**row, "probability": row["probability"] * rest / whole} for row in rows]
    own: RankedEntry = {
        "effects": [SOMETHING_ELSE],
        "probability": sets * other.probability / whole,
        "equivalents": [],
        "parameters": {},
        "plausible": True,
        "fit_p_value": None,
        "set_aside": [],
    }
    return sorted([*shared, own], key=lambda row: -row["probability"])


def _ranked_document(row: Ranked, *, named: bool) -> RankedEntry:
    """Return a row of the ranking; points and sensors stand in the rows of the answer alone, all else in all."""
    aside = {n for n, e in row.parameters.items() if isinstance(e.value, tuple | str) and e.unit != NAME}
    stated = {n: fill(EstimateEntry, e) for n, e in row.parameters.items() if named or n not in aside}
    return fill(RankedEntry, row, parameters=stated)
