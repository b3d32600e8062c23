"""What was found in universal files."""

from __future__ import annotations

from dataclasses import dataclass, field

import pandas as pd

from acquisition.display import Displayed
from acquisition.frfs.frf import FrfSet
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest
from acquisition.modal_data import ModalData


@dataclass(frozen=True)
class DatasetInfo:
    """One data set of a file.

    Parameters
    ----------
    file : str
        Name of the file.
    number : int
        Data set number; 0 for what has none that can be read.
    kind : str
        What it is, in words.
    line : int
        Line where it begins, from 1.
    description : str
        What it holds.
    ok : bool
        Whether it was read.
    message : str
        What is wrong with it or odd about it; empty if nothing.
    unused : str
        What it is called in the list of what is not used, in the plural; empty if it is used.
    warning : str
        What the warnings say of it; empty if nothing.
    """

    file: str
    number: int
    kind: str
    line: int
    description: str
    ok: bool = True
    message: str = ""
    unused: str = ""
    warning: str = ""

    @property
    def place(self) -> str:
        """File, data set and line, for messages."""
        if self.number == 0:
            return f"{self.file}, line {self.line}"
        return f"{self.file}, data set {self.number} at line {self.line}"

    @property
    def fault(self) -> str:
        """What is wrong with it, with its place."""
        return f"{self.place}: {self.message}"


@dataclass(frozen=True, eq=False, kw_only=True)
class UffContent(Displayed):
    """Everything that one test's universal files hold, in SI units.

    Parameters
    ----------
    tests : tuple of HammerTest
        Raw time records, one entry for each combination of rate, length and quantity.
    frfs : FrfSet, optional
        FRFs with their coherence, read or made of auto- and cross-spectra.
    modal : ModalData, optional
        Modes of data sets 55 and 2414.
    geometry : Geometry
        Nodes of data sets 15 and 2411, with the lines of data sets 82 and 2412.
    datasets : tuple of DatasetInfo
        Every data set in the files, good or bad.
    warnings : tuple of str
        What had to be assumed or left out.
    title : str
        Title of the test.
    unused : tuple of str
        What could be read but not be used, and why; among the warnings too.
    """

    tests: tuple[HammerTest, ...] = ()
    frfs: FrfSet | None = None
    modal: ModalData | None = None
    geometry: Geometry = field(default_factory=Geometry.empty)
    datasets: tuple[DatasetInfo, ...] = ()
    warnings: tuple[str, ...] = ()
    title: str = ""
    unused: tuple[str, ...] = ()

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why something in the files is not used: faults of data sets, then what does not fit together."""
        return (*(info.fault for info in self.datasets if not info.ok), *self.unused)

    def table(self) -> pd.DataFrame:
        """Return one row per data set."""
        return pd.DataFrame(
            [[d.file, d.line, d.number, d.kind, d.description, d.ok, d.message] for d in self.datasets],
            columns=["file", "line", "data set", "kind", "description", "ok", "message"],
        )

    def _headline(self) -> str:
        held = [f"{len(self.geometry.nodes)} nodes"] if self.geometry.nodes else []
        held += [part._headline() for part in (*self.tests, self.frfs, self.modal) if part is not None]
        return f"{self.title or 'no title'}: {'; '.join(held) or 'nothing that can be used'}"
