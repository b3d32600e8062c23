"""Where every line of text of a figure is drawn, and whether all of it can be read."""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Written:
    text: str
    box: tuple[float, float, float, float]


class Reader(RendererAgg):
    """A renderer that keeps where every line of text was drawn, in pixels from the top left."""

    def __init__(self, figure: Figure) -> None:
        width, height = figure.get_size_inches() * figure.dpi
        super().__init__(int(width), int(height), figure.dpi)
        self.written: list[Written] = []

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):  # type: ignore[no-untyped-def]
        wide, tall, below = self.get_text_width_height_descent(s, prop, ismath)
        box = (
            (x - tall + below, y - wide, x + below, y)
            if angle == 90
            else (x, y - tall + below, x + wide, y + below)
        )
        self.written.append(Written(s, box))

    def draw_nothing(self, *_args, **_options):  # type: ignore[no-untyped-def]
        """Stand for everything that is no text: it needs no pixels here."""

    draw_path = draw_markers = draw_path_collection = draw_quad_mesh = draw_nothing
    draw_image = draw_gouraud_triangles = draw_nothing


def read(figure: Figure) -> list[Written]:
    reader = Reader(figure)
    figure.draw(reader)
    return [w for w in reader.written if w.text.strip()]


def assert_legible(figure: Figure) -> None:
    """No text outside the figure, no two texts over each other (2 px of grace for the boxes' own air)."""
    written = read(figure)
    assert written
    wide, tall = figure.get_size_inches() * figure.dpi
    for w in written:
        left, top, right, bottom = w.box
        assert left >= -1 and top >= -1 and right <= wide + 1 and bottom <= tall + 1, f"outside: {w}"
    for i, a in enumerate(written):
        for b in written[:i]:
            over = min(a.box[2], b.box[2]) - max(a.box[0], b.box[0])
            down = min(a.box[3], b.box[3]) - max(a.box[1], b.box[1])
            assert over <= 2 or down <= 2, f"{a} overlaps {b}"


def panels(figure: Figure) -> dict[str, Axes]:
    return {str(axes.get_label()): axes for axes in figure.axes}


def words(figure: Figure) -> str:
    return " ".join(w.text for w in read(figure))
