"""The dry beam and the dry plate updated together from the published frequencies, which paper A did not do."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from modalkit.papers.a.chain import sample_folder
from modalkit.papers.render import PaperTable
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import Case
from updating.update import Update, update
from updating.update.estimate import Estimate

COMMON = ("length", "sensor_mass")
"""What beam and plate share in every variant: one clamp, one accelerometer."""


@dataclass(frozen=True)
class Variant:
    """One way of sharing, and what an independent computation found for it.

    Parameters
    ----------
    name : str
        What is free.
    beam, plate, shared : tuple of str
        Parameters of the beam, of the plate, and those that have one value in both.
    reference : tuple of float
        Extension [mm], accelerometer [g], E of the beam and of the plate [-], r.m.s. error [%].
    """

    name: str
    beam: tuple[str, ...]
    plate: tuple[str, ...]
    shared: tuple[str, ...]
    reference: tuple[float, float, float, float, float]


VARIANTS = (
    Variant("E of the plate alone", COMMON, (*COMMON, "E"), COMMON, (18.2, 10.9, 1.0, 0.93, 0.52)),
    Variant("E shared", (*COMMON, "E"), (*COMMON, "E"), (*COMMON, "E"), (11.0, 2.0, 0.86, 0.86, 0.65)),
    Variant("E of each", (*COMMON, "E"), (*COMMON, "E"), COMMON, (16.0, 8.6, 0.96, 0.91, 0.48)),
)

QUANTITIES = ("length [mm]", "sensor [g]", "E beam [-]", "E plate [-]", "r.m.s. [%]")

NOTES = (
    "From the published frequencies alone (modes.csv), 15 of them, unit weights on relative frequency. The paper "
    "updates beam and plate one by one; both hang in one clamp and carry one accelerometer.",
    "The reference values were computed independently of this program. The spread of the variants is the result: they "
    "fit about equally well, so these frequencies bound the penetration of the clamp to some 11-18 mm and the "
    "accelerometer to some 2-11 g, and no row is the answer.",
    "1.00 where E was held at its nominal 210 GPa.",
)


def joint_table(folder: Path | str | None = None) -> PaperTable:
    """Update beam and plate together in all variants.

    Parameters
    ----------
    folder : path, optional
        Where the sample studies are; left out, those that come with the package.
    """
    home = Path(folder) if folder else sample_folder()
    cases = [open_study(read_study(home / n / "published.toml")).case for n in ("beam_dry", "plate_dry")]
    results = [_updated(variant, cases) for variant in VARIANTS]
    rows = [_row(variant, result, cases) for variant, result in zip(VARIANTS, results, strict=True)]
    return PaperTable(
        "A", "joint", "Dry beam and plate updated together", pd.DataFrame(rows), _sigmas(results), NOTES
    )


def joint_values(variant: Variant, cases: list[Case]) -> list[dict[str, float]]:
    """Return extension [m], mass of the accelerometer [kg] and factor on E that a variant finds, by case."""
    result = _updated(variant, cases)
    found = {(p.name, p.study): p for p in result.parameters}
    shared = {name: found[name, None].value for name in COMMON}
    return [{**shared, "E": modulus} for modulus in _moduli(result, cases)]


def _updated(variant: Variant, cases: list[Case]) -> Update:
    names = [variant.beam, variant.plate]
    return update(cases, parameters=names, shared=variant.shared, weights="relative")


def _row(variant: Variant, result: Update, cases: list[Case]) -> dict[str, object]:
    found = {(p.name, p.study): p for p in result.parameters}
    ours = (
        1e3 * found["length", None].value,
        1e3 * found["sensor_mass", None].value,
        *_moduli(result, cases),
        result.rms_percent(),
    )
    row: dict[str, object] = {"variant": variant.name}
    for name, reference, own_value in zip(QUANTITIES, variant.reference, ours, strict=True):
        row[name] = reference
        row[f"{name.split(' [', maxsplit=1)[0]}, ours"] = own_value
    return row


def _moduli(result: Update, cases: list[Case]) -> list[float]:
    """Return the factor on E of every case, 1 where it was held."""
    found = {(p.name, p.study): p for p in result.parameters}
    owns = [found.get(("E", case.title)) or found.get(("E", None)) for case in cases]
    return [1.0 if own is None or own.factor is None else own.factor for own in owns]


def _sigmas(results: list[Update]) -> pd.DataFrame:
    """Return the parameters with their standard deviations, which hold within a variant only."""
    rows = [
        {"variant": variant.name, **_estimate(p)}
        for variant, result in zip(VARIANTS, results, strict=True)
        for p in result.parameters
    ]
    return pd.DataFrame(rows)


def _estimate(p: Estimate) -> dict[str, object]:
    """Return a parameter in a unit for reading: E as a factor, lengths in mm, masses in g."""
    scale, unit = {"m": (1e3, "mm"), "kg": (1e3, "g")}.get(p.unit, (1.0, p.unit))
    if p.name == "E" and p.factor is not None:
        scale, unit = p.factor / p.value, "-"
    return {
        "parameter": p.name,
        "study": p.study or "both",
        "value, ours": scale * p.value,
        "sigma, ours": scale * p.sigma,
        "unit": unit,
    }
