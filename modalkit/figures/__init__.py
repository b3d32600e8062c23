"""Figures: pure functions from finished results to matplotlib figures that belong to no window."""

from modalkit.figures.blind import blind_figures
from modalkit.figures.cmif import cmif_figure
from modalkit.figures.diagnosis import diagnosis_figure
from modalkit.figures.every import draw
from modalkit.figures.evolution import evolution_figure
from modalkit.figures.frac import frac_figure
from modalkit.figures.frf import frf_figure
from modalkit.figures.hits import hits_figure
from modalkit.figures.localisation import localisation_figure
from modalkit.figures.matrix import auto_mac_figure, mac_figure
from modalkit.figures.overlay import overlay_figure
from modalkit.figures.save import save_figures
from modalkit.figures.shapes import shapes_figure
from modalkit.figures.stabilisation import stabilisation_figure
from modalkit.figures.update import update_figure

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
