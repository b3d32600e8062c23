"""Figures of a result by name, which a notebook shows as pictures."""

from __future__ import annotations

from base64 import b64encode
from html import escape

from matplotlib.figure import Figure

from modalkit.figures.save import png


class Drawings(dict[str, Figure]):
    """Figures by name; a cell of a notebook that ends with them shows them one below the other."""

    def _repr_html_(self) -> str:
        return "".join(
            f'<figure style="margin:0 0 1em"><img alt="{escape(name, quote=True)}" style="max-width:100%" '
            f'src="data:image/png;base64,{b64encode(png(figure)).decode()}"></figure>'
            for name, figure in self.items()
        )

    def __repr__(self) -> str:
        """Return the names and sizes, for a terminal."""
        sizes = (figure.get_size_inches() for figure in self.values())
        stated = [f"{name} ({w:.1f} x {h:.1f} in)" for name, (w, h) in zip(self, sizes, strict=True)]
        return f"Drawings: {', '.join(stated) or 'none'}"
