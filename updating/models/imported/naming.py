"""Which of the matrices in one file is the stiffness, and which the mass: by the names that Nastran gives them."""

from __future__ import annotations

from collections.abc import Mapping

from acquisition.errors import StudyError

LETTERS = {"stiffness": "K", "mass": "M"}
"""What the names of stiffness and mass begin with."""

SHOWN = 20
"""Names that a message lists at most [-]."""


def chosen(held: Mapping[str, bool], kind: str, name: str | None, source: str) -> str:
    """Return the name of the matrix that is the stiffness or the mass.

    Without a stated name it is the square matrix whose name begins with K or M. Of several it is the one that has a
    companion in the same file: K4GG beside KGG and MGG has none.

    Parameters
    ----------
    held : mapping of str to bool
        Names of the matrices in the file, and whether each is square.
    kind : {"stiffness", "mass"}
        Which one is needed.
    name : str, optional
        The name that the study states, in upper or lower case.
    source : str
        File, for messages.

    Raises
    ------
    StudyError
        If there is no such matrix, or several.
    """
    listed = ", ".join([*list(held)[:SHOWN], *(["..."] if len(held) > SHOWN else [])]) or "none"
    if name is not None:
        found = [one for one in held if one.upper() == name.strip().upper()]
        if not found:
            raise StudyError(
                f"{source}: no matrix {name!r} in it; the file has {listed}: correct {kind}_name under [model]"
            )
        return found[0]
    letter, other = LETTERS[kind], next(one for of, one in LETTERS.items() if of != kind)
    begun = [one for one in held if one[:1].upper() == letter]
    square = [one for one in begun if held[one]] or begun
    upper = {one.upper() for one in held}
    found = [one for one in square if other + one[1:].upper() in upper] or square
    if len(found) != 1:
        raise StudyError(
            f"{source}: one matrix whose name begins with {letter} is needed as {kind}; the file has {listed}: write "
            f'{kind}_name = "..." under [model]'
        )
    return found[0]
