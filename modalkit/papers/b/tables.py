"""Tables 2-5 of paper B, and the FRAC of its Figs. 6 and 9."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from modalkit.papers.a.chain import sample_folder
from modalkit.papers.b import printed
from modalkit.papers.b.chain import Taped, open_taped
from modalkit.papers.b.notes import DAMPER_NOTES, DAMPING_NOTES, FRAC_NOTES, FREQUENCY_NOTES, SECTION_NOTES
from modalkit.papers.b.staged import Staged, staged_update
from modalkit.papers.render import PaperTable
from updating.models.state import NOMINAL

NONE = pd.DataFrame()


def tables_b(update: Staged | None = None) -> list[PaperTable]:
    """Work out paper B's tables from the sample test of the taped beam.

    Parameters
    ----------
    update : Staged, optional
        The updated beam, worked out before; left out, that of the samples that come with the package.
    """
    update = update or staged_update(open_taped(sample_folder()))
    taped = update.taped
    return [
        PaperTable("B", 2, "Updated geometry", _parameters(printed.SECTION, update), NONE, SECTION_NOTES),
        PaperTable("B", 3, "Frequencies and MAC", _frequencies(taped, update), NONE, FREQUENCY_NOTES),
        PaperTable(
            "B", 4, "Coefficients of damping", _parameters(printed.DAMPERS, update), NONE, DAMPER_NOTES
        ),
        PaperTable("B", 5, "Damping ratios", *_damping(taped, update), DAMPING_NOTES),
        PaperTable("B", "Figs. 6 and 9", "FRAC of the receptances", *_frac(taped, update), FRAC_NOTES),
    ]


def _parameters(rows: Mapping[str, tuple[str, float, float, float]], update: Staged) -> pd.DataFrame:
    found = []
    for name, (parameter, scale, estimated, updated) in rows.items():
        start, value, sigma = (scale * v for v in update.parameters[parameter])
        found.append(
            {
                "parameter": name,
                "unit": printed.UNITS[parameter.split(".")[1]],
                "estimated": estimated,
                "estimated, ours": start,
                "updated": updated,
                "updated, ours": value,
                "sigma, ours": sigma,
                "factor": updated / estimated,
                "factor, ours": value / start,
                "erratum": printed.BETA_ERRATUM if name == "beta_2" else "",
            }
        )
    table = pd.DataFrame(found)
    if rows is printed.SECTION:
        table.insert(8, f"times {printed.GAIN}, ours", printed.GAIN * table["updated, ours"])
    return table


def _frequencies(taped: Taped, update: Staged) -> pd.DataFrame:
    test = np.array(printed.FREQUENCY)
    own = printed.printed_state(taped.regions, section=True, dampers=False)
    before, after = taped.frequency_of(NOMINAL), taped.frequency_of(update.section)
    columns = {
        "mode": printed.MODES,
        "test [Hz]": test,
        "test, ours": taped.identified[0],
        "before [Hz]": printed.BEFORE,
        "before, ours": before,
        "error before [%]": printed.BEFORE_ERROR,
        "error before, ours": 100 * (before / test - 1),
        "MAC before [%]": printed.MAC,
        "MAC before, ours": 100 * taped.mac_of(NOMINAL),
        "after [Hz]": printed.AFTER,
        "after at the printed A and I, ours": taped.frequency_of(own),
        "after, ours": after,
        "error after [%]": printed.AFTER_ERROR,
        "error after, ours": 100 * (after / test - 1),
        "MAC after [%]": printed.MAC,
        "MAC after, ours": 100 * taped.mac_of(update.section),
        "erratum": [printed.TABLE_3_ERRATA.get(mode, "") for mode in printed.MODES],
    }
    return pd.DataFrame(columns)


def _damping(taped: Taped, update: Staged) -> tuple[pd.DataFrame, pd.DataFrame]:
    test = np.array(printed.DAMPING)
    section = printed.printed_state(taped.regions, section=True, dampers=False)
    both = printed.printed_state(taped.regions, section=True, dampers=True)
    before, after = 100 * taped.damping_of(section), 100 * taped.damping_of(update.both)
    columns = {
        "mode": printed.MODES,
        "damping, test [%]": test,
        "damping, test, ours": 100 * taped.identified[1],
        "damping before [%]": printed.DAMPING_BEFORE,
        "damping before, ours": before,
        "error before [%]": printed.DAMPING_BEFORE_ERROR,
        "error before, ours": 100 * (before / test - 1),
        "damping after [%]": printed.DAMPING_AFTER,
        "damping after at the printed parameters, ours": 100 * taped.damping_of(both),
        "damping after, ours": after,
        "error after [%]": printed.DAMPING_AFTER_ERROR,
        "error after, ours": 100 * (after / test - 1),
    }
    means = {
        "mean error before [%]": [_mean(np.array(printed.DAMPING_BEFORE), test)],
        "mean error before, ours": [_mean(before, test)],
        "mean error after [%]": [_mean(np.array(printed.DAMPING_AFTER), test)],
        "mean error after, ours": [_mean(after, test)],
    }
    return pd.DataFrame(columns), pd.DataFrame(means)


def _mean(values: FloatArray, test: FloatArray) -> float:
    return float(100 * np.mean(np.abs(values / test - 1)))


def _frac(taped: Taped, update: Staged) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return FRAC by point and in the mean; the first stage has no damping, so there are columns without."""
    bare = printed.undamped(taped.regions)
    states = {
        "before, undamped": bare,
        "before": NOMINAL,
        "after stage 1, undamped": update.section.plus(bare),
        "after stage 1": update.section,
        "after both": update.both,
    }
    values = {f"FRAC {name}": taped.frac_of(state) for name, state in states.items()}
    nodes = [f"{r.node}" for r in taped.frfs.responses]
    table = pd.DataFrame({"point": nodes, **values})
    return table, pd.DataFrame({f"mean {name}": [float(v.mean())] for name, v in values.items()})
