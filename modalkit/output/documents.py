"""Results as the documents of the JSON files, whose keys are a contract."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition import HitVerdict, ModalData, rejected_points
from identification import ModalModel, mpc
from modalkit.output.schemas.diagnosis import (
    DiagnosisDocument,
    GapEntry,
    GapMode,
    RankedEntry,
    RemainderEntry,
    ShrinkEntry,
)
from modalkit.output.schemas.modes import HitEntry, ModeEntry, ModesDocument, ShapeEntry, TrendEntry
from modalkit.workflow.existing import Modes
from updating import Diagnosis
from updating.diagnosis.answer.result import Ranked, Remainder, Shrink
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
        "trend": None if isinstance(model, Modes) else _trend(model),
    }


def _trend(model: ModalModel) -> TrendEntry | None:
    found = model.trend
    if found is None:
        return None
    return {"rate": found.rate, "sigma": found.rate_sigma, "points": found.setups}


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
    return {"point": str(hit.point), "hit": hit.hit, "used": hit.used, "reasons": list(hit.reasons)}


def diagnosis_document(diagnosis: Diagnosis, warnings: Sequence[str] = ()) -> DiagnosisDocument:
    """Return a diagnosis as ``modalkit.diagnosis/1``."""
    where = diagnosis.where
    return {
        "schema": "modalkit.diagnosis/1",
        "title": diagnosis.title,
        "significant": diagnosis.significant,
        "p_value": diagnosis.p_value,
        "gap": _gap_document(diagnosis),
        "where": {
            "channel": where.channel,
            "channels": where.channels,
            "location": where.location,
            "locations": where.locations,
            "points": where.points,
            "names": where.names,
            "zones": [
                {"name": z.name, "center": z.center, "probability": z.probability} for z in where.zones
            ],
        },
        "cause": {
            "verdict": diagnosis.verdict,
            "lacks": diagnosis.lacks,
            "effects": diagnosis.effects,
            "sets": diagnosis.sets,
            "ranking": [_ranked_document(r, named=r.effects in diagnosis.sets) for r in diagnosis.ranking],
        },
        "shrink": _shrink_document(diagnosis.shrink),
        "remainder": _remainder_document(diagnosis.remainder),
        "included": dict(diagnosis.included),
        "next_test": [
            {
                "measure": t.measure,
                "separates": t.separates,
                "expected_sigma": t.expected_sigma,
            }
            for t in diagnosis.next_test
        ],
        "searched": [
            {"causes": s.causes, "sets": s.sets, "possible": s.possible} for s in diagnosis.searched
        ],
        "not_examined": {name: str(why) for name, why in diagnosis.not_examined.items()},
        "warnings": [*diagnosis.warnings, *warnings],
    }


def _shrink_document(shrink: Shrink) -> ShrinkEntry:
    return {
        "metric": shrink.metric,
        "before_percent": shrink.before,
        "after_percent": shrink.after,
        "held_out": {
            "before_percent": shrink.held_before,
            "after_percent": shrink.held_after,
            "runner_up_percent": shrink.held_runner_up,
            "nuisance_only_percent": shrink.held_nuisance,
            "noise_floor_percent": shrink.floor,
            "nuisance_stretch_sigma": shrink.stretch,
            "points": None
            if shrink.points is None
            else {
                "before_percent": shrink.points.before,
                "after_percent": shrink.points.after,
                "nuisance_only_percent": shrink.points.nuisance,
            },
        },
        "closed_percent": None
        if shrink.closed is None
        else {
            "value": shrink.closed.value,
            "low95": shrink.closed.low95,
            "high95": shrink.closed.high95,
        },
    }


def _remainder_document(left: Remainder | None) -> RemainderEntry | None:
    if left is None:
        return None
    return {
        "significant": left.significant,
        "percent": left.percent,
        "sigma": left.sigma,
        "carried_by": left.carried_by,
    }


def _gap_document(diagnosis: Diagnosis) -> GapEntry:
    gap = diagnosis.gap
    modes: list[GapMode] = [
        {
            "study": row["study"],
            "test_hz": row["test [Hz]"],
            "model_hz": row["model [Hz]"],
            "error_percent": row["error [%]"],
            "sigma_percent": row["sigma [%]"],
            "mac": row["MAC"],
            "test_damping": row["test damping"],
            "model_damping": row["model damping"],
        }
        for _, row in gap.modes.iterrows()
    ]
    return {
        "frequency_rms_percent": gap.rms_percent,
        "noise_floor_percent": gap.floor_percent,
        "modes": modes,
        "frac": gap.frac.tolist(),
    }


def _ranked_document(row: Ranked, *, named: bool) -> RankedEntry:
    """Return a row of the ranking; points and sensors stand in the rows of the answer alone, all else in all."""
    aside = {n for n, e in row.parameters.items() if isinstance(e.value, tuple | str) and e.unit != NAME}
    stated = {n: e for n, e in row.parameters.items() if named or n not in aside}
    return {
        "effects": row.effects,
        "probability": row.probability,
        "equivalents": row.equivalents,
        "parameters": {
            name: {
                "value": e.value,
                "unit": e.unit,
                "low95": e.low95,
                "high95": e.high95,
                "at_bound": e.at_bound,
            }
            for name, e in stated.items()
        },
        "plausible": row.plausible,
        "fit_p_value": row.p_value,
    }
