"""Figures: pure functions from finished results to matplotlib figures that belong to no window."""

from modalkit.figures.blind.all import blind_figures
from modalkit.figures.chart import chart_figure, sheet_figure
from modalkit.figures.charts import (
    auto_mac_figure,
    cmif_figure,
    damping_figure,
    frf_figure,
    mac_figure,
    mvmif_figure,
    overlay_figure,
    stabilisation_figure,
    update_figure,
)
from modalkit.figures.diagnosis.figure import diagnosis_figure
from modalkit.figures.diagnosis.localisation import localisation_figure
from modalkit.figures.every import draw
from modalkit.figures.hits import hits_figure
from modalkit.figures.save import save_figures
from modalkit.figures.shapes.shapes import shapes_figure

__all__ = [
    "auto_mac_figure",
    "blind_figures",
    "chart_figure",
    "cmif_figure",
    "damping_figure",
    "diagnosis_figure",
    "draw",
    "frf_figure",
    "hits_figure",
    "localisation_figure",
    "mac_figure",
    "mvmif_figure",
    "overlay_figure",
    "save_figures",
    "shapes_figure",
    "sheet_figure",
    "stabilisation_figure",
    "update_figure",
]
