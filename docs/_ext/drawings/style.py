"""How the figures of the explanations look: on white, whatever the page."""

import matplotlib
from matplotlib.figure import Figure

matplotlib.rcParams["font.size"] = 8

COLOURS = ("#999999", "#e69f00", "#0072b2", "#000000")


def show(figure: Figure, name: str) -> None:
    """Write a figure where the page looks for it."""
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(f"{name}.png", dpi=150)
