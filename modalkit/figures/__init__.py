"""Figures: pure functions from finished results to matplotlib figures that belong to no window."""

from modalkit.figures.blind.all import blind_figures
from modalkit.figures.diagnosis import diagnosis_figure
from modalkit.figures.diagnosis.localisation import localisation_figure
from modalkit.figures.every import draw
from modalkit.figures.overlay import overlay_figure
from modalkit.figures.save import save_figures
from modalkit.figures.shapes.matrix import auto_mac_figure, mac_figure
from modalkit.figures.shapes.shapes import shapes_figure
from modalkit.figures.test.cmif import cmif_figure
from modalkit.figures.test.frf import frf_figure
from modalkit.figures.test.hits import hits_figure
from modalkit.figures.test.stabilisation import stabilisation_figure
from modalkit.figures.update.errors import update_figure
from modalkit.figures.update.evolution import evolution_figure
from modalkit.figures.update.frac import frac_figure

__all__ = [
    "auto_mac_figure",
    "blind_figures",
    "cmif_figure",
    "diagnosis_figure",
    "draw",
    "evolution_figure",
    "frac_figure",
    "frf_figure",
    "hits_figure",
    "localisation_figure",
    "mac_figure",
    "overlay_figure",
    "save_figures",
    "shapes_figure",
    "stabilisation_figure",
    "update_figure",
]
