"""All tables and figures of one paper, or of both, worked out once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.papers.a.chain import Walk, sample_folder, walk_all
from modalkit.papers.a.fluid import fluid_tables
from modalkit.papers.a.joint import joint_table
from modalkit.papers.a.tables import tables_a
from modalkit.papers.b.chain import open_taped
from modalkit.papers.b.staged import Staged, staged_update
from modalkit.papers.b.tables import tables_b
from modalkit.papers.render import PaperTable


@dataclass(frozen=True, eq=False)
class Work:
    """What the tables and figures are made of.

    Parameters
    ----------
    folder : Path
        Where the sample studies are.
    walks : tuple of Walk
        Paper A's tests; empty where it is not asked for.
    staged : Staged, optional
        Paper B's.
    """

    folder: Path
    walks: tuple[Walk, ...]
    staged: Staged | None

    def tables(self) -> list[PaperTable]:
        """Return the tables, our value beside the published one."""
        made = [*tables_a(self.walks), joint_table(self.folder)] if self.walks else []
        return made if self.staged is None else [*made, *tables_b(self.staged)]

    def figures(self) -> dict[str, Figure]:
        """Return our versions of the papers' figures, by file name."""
        from modalkit.papers.a.figures import figures_a
        from modalkit.papers.b.figures import figures_b

        made = figures_a(self.walks)
        return made if self.staged is None else {**made, **figures_b(self.staged)}


@dataclass(frozen=True)
class FluidWork:
    """Paper A's wet tables with the water computed; there are no figures.

    Parameters
    ----------
    folder : Path
        Where the sample studies are.
    """

    folder: Path

    def tables(self) -> list[PaperTable]:
        """Return the tables of all variants."""
        return fluid_tables(self.folder)

    def figures(self) -> dict[str, Figure]:
        """Return nothing."""
        return {}


def fluid_work(paper: str | None = None) -> FluidWork:
    """Return paper A's wet tables, to be worked out with the water computed.

    Parameters
    ----------
    paper : {"A"}, optional
        Which paper; there is no water in the other.

    Raises
    ------
    InputError
        If another paper is asked for.
    """
    if paper is not None and paper.upper() != "A":
        raise InputError(f"no water in paper {paper!r}; use --fluid with --paper A (submerged structures)")
    return FluidWork(sample_folder())


def work(paper: str | None = None) -> Work:
    """Walk the chain for a paper: hits to FRFs to poles to pairs to the updated model.

    Parameters
    ----------
    paper : {"A", "B"}, optional
        Which paper; left out, both.

    Raises
    ------
    InputError
        If there is no such paper.
    """
    wanted = ("A", "B") if paper is None else (paper.upper(),)
    if unknown := [name for name in wanted if name not in ("A", "B")]:
        raise InputError(
            f"no tables of paper {unknown[0]!r}; use --paper A (submerged structures) or B (tape)"
        )
    folder = sample_folder()
    walks = walk_all(folder) if "A" in wanted else ()
    return Work(folder, walks, staged_update(open_taped(folder)) if "B" in wanted else None)


def tables(paper: str | None = None) -> list[PaperTable]:
    """Work out the tables of a paper, or of both, from the sample tests; see :func:`work`."""
    return work(paper).tables()
