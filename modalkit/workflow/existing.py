"""Modes that exist already: read from a file, they get what identified ones get."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition import InputError, ModalData
from acquisition.display import Animated, Shown, named_files

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Modes(Shown, Animated):
    """Modes of a test as a file holds them: data sets 55 and 2414, a table, our own JSON, a .mat with a layout.

    Parameters
    ----------
    modal : ModalData
        The modes.
    source : str
        Where they came from, for messages.
    title : str
        Title of the test.
    warnings : tuple of str
        What the user should know.
    """

    modal: ModalData
    source: str = "arrays"
    title: str = ""
    warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.modal)

    def table(self) -> pd.DataFrame:
        """Return one row per mode: frequency [Hz], damping ratio [%], their standard deviations, MPC [-]."""
        from identification import modes_table

        return modes_table(self.modal)

    def identify(self, *, band: tuple[float, float] | None = None) -> Modes:
        """Return the modes, those of a band: they are identified already.

        Parameters
        ----------
        band : tuple of float, optional
            Lowest and highest frequency [Hz].

        Raises
        ------
        InputError
            If the band holds none of them.
        """
        if band is None:
            return self
        inside = (self.modal.frequency >= band[0]) & (self.modal.frequency <= band[1])
        if not inside.any():
            raise InputError(f"{self.source}: no mode between {band[0]:g} and {band[1]:g} Hz; widen the band")
        return replace(self, modal=self.modal.modes(inside))

    def _headline(self) -> str:
        return f"{self.modal._headline()}; from {self.source}"


def existing(
    modal: ModalData | None, paths: list[Path], title: str, warnings: tuple[str, ...]
) -> Modes | None:
    """Return the modes that files hold, None where they hold none."""
    if modal is None or not len(modal):
        return None
    return Modes(modal, named_files(paths), title, (*warnings, *modal.doubts()))
