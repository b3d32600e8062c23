"""How sure, how strong, where and how far, as tables of words."""

from __future__ import annotations

import numpy as np
import pandas as pd

from modalkit.blind.scoring.intervals import share
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.section import Section, share_rows, words
from modalkit.blind.scoring.wording import count_text, percent, share_text, value_text


def calibration_section(score: Score) -> Section:
    """Return the scores of the probabilities."""
    some = score.calibration
    rows = []
    for name in some["trials"].unique():
        part = some[some["trials"] == name]
        if not int(part["total"].iloc[0]):
            continue
        values = {str(row["measure"]): value_text(row, digits=2) for _, row in part.iterrows()}
        rows.append({"of": name, "trials": int(part["total"].iloc[0])} | values)
    bins = [
        f"{r['low']:g} to {r['high']:g}: {percent(r['rate'])} % ({count_text(r)})"
        for _, r in score.reliability.iterrows()
    ]
    note = "the first set's probability, and how often it is true: " + "; ".join(bins)
    return Section("Calibration of the probabilities", note, words(rows))


def cover_section(score: Score) -> Section:
    """Return coverage and size of the 95 % set."""
    rows = []
    for _, row in score.cover[score.cover["total"] > 0].iterrows():
        sizes = [str(row[c]) for c in score.cover.columns if c.startswith("size ")]
        rows.append(
            {
                "set": row["set"],
                "holds the truth (95 %)": share_text(row),
                "count": count_text(row),
                "mean size": value_text(row, "mean_size", "mean_"),
                "of size 1, 2, 3, 4, 5, more": ", ".join(sizes),
            }
        )
    return Section("The 95 % set", "", words(rows))


def severity_section(score: Score) -> Section:
    """Return errors and coverage of parameters."""
    rows = [
        {
            "parameter": row["parameter"],
            "median error [%]": value_text(row, "median_error", "median_", scale=100, digits=2),
            "bias [%]": f"{100 * row['bias']:+.1f}",
            "inside its 95 % interval": share_text(row),
            "count": count_text(row),
        }
        for _, row in score.severity_summary.iterrows()
    ]
    return Section(
        "How strong", "where the answer holds the effect; errors relative to the true value", words(rows)
    )


def places_section(score: Score) -> Section:
    """Return errors of place."""
    rows = [
        {
            "effect": row["effect"],
            "nearest place, median error [% of span]": value_text(
                row, "nearest_median", "nearest_", scale=100, digits=2
            ),
            "first place": value_text(row, "first_median", "first_", scale=100, digits=2),
            "nearest within 5 %": share_text(row),
            "count": count_text(row),
            "first within 5 %": f"{row['first_count']}",
            "interval holds it": f"{row['covered']} of {row['intervals']}",
        }
        for _, row in score.place_summary.iterrows()
    ]
    note = (
        "span: length of a beam, diagonal of a plate; on symmetric structures mirrored places are all offered"
    )
    return Section("Where", note, words(rows))


def points_section(score: Score) -> Section:
    """Return how often the test points are right, all together."""
    rows = [
        {"parameter": name, "the same points": share_text(row), "count": count_text(row)}
        for name, some in score.points.groupby("parameter")
        for row in [share(some["same"])]
    ]
    return Section("Which points", "where the answer holds the effect", words(rows))


def channels_section(score: Score) -> Section:
    """Return how often the channel is right."""
    table = score.channels.set_index("channel") if len(score.channels) else pd.DataFrame()
    return Section("The channel", "visible effects of the library", words(share_rows("channel", table)))


def closing_section(score: Score) -> Section:
    """Return how well the shrinkage is predicted."""
    rows = [
        {
            "trials": row["trials"],
            "|said - true| [points of %]": value_text(row, "mean_difference", "mean_"),
            "said": f"{row['said']:.0f} %",
            "true": f"{row['true']:.0f} %",
            "above the band": "-" if np.isnan(row["beyond"]) else f"{row['beyond']:.0f} %",
            "within 10 points": share_text(row),
            "count": count_text(row),
            "inside its 95 % interval": share_text(row, "covered_"),
        }
        for _, row in score.closing_summary.iterrows()
    ]
    note = "share of the gap that closes: as said, and with the answer in the rig's own nominal body"
    return Section("How far the gap closes", note, words(rows))


def silence_section(score: Score) -> Section:
    """Return the p-value where nothing is hidden."""
    table = score.uniformity[score.uniformity["total"] > 0]
    rows = [
        {"p-value below": f"{row['level']:g}", "expected": f"{percent(row['level'])} %"}
        | {"share (95 %)": share_text(row), "count": count_text(row)}
        for _, row in table.iterrows()
    ]
    note = (
        ""
        if table.empty
        else f"Kolmogorov-Smirnov test against a uniform distribution: p = {table['ks_p'].iloc[0]:.2g}"
    )
    return Section("The p-value where nothing is hidden", note, words(rows))
