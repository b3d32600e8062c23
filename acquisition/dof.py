"""Degrees of freedom: a node and a signed UFF direction code."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError

_LETTERS = {1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ", 0: "scalar"}
_WRITTEN = re.compile(r"(\d+)([+-])(R?[XYZ])")


@dataclass(frozen=True, order=True)
class Dof:
    """A degree of freedom of the test.

    Parameters
    ----------
    node : int
        Node number of the test geometry.
    direction : int
        UFF direction code: 1, 2, 3 for +x, +y, +z; 4, 5, 6 for rotations about them; negative when the
        transducer points the other way; 0 for a scalar.
    """

    node: int
    direction: int

    @classmethod
    def of(cls, text: str) -> Dof:
        """Return the degree of freedom written as it prints, ``12-Z``.

        Raises
        ------
        InputError
            If it is written otherwise.
        """
        found = _WRITTEN.fullmatch(text.strip().upper())
        if found is None:
            raise InputError(
                f"{text!r} is not a degree of freedom; write node, sign and axis, as 12+Z or 3-X"
            )
        node, sign, character = found.groups()
        code = next(code for code, name in _LETTERS.items() if name == character)
        return cls(int(node), -code if sign == "-" else code)

    @property
    def sign(self) -> int:
        """+1 or -1: which way along its axis the transducer points [-]."""
        return -1 if self.direction < 0 else 1

    @property
    def axis(self) -> int:
        """0, 1 or 2 for x, y, z; 3, 4, 5 for rotations about them; -1 for a scalar."""
        return abs(self.direction) - 1

    @property
    def unit_vector(self) -> FloatArray:
        """Signed direction of a translation, shape (3,) [-]; zero for rotations and scalars."""
        vector = np.zeros(3)
        if 0 <= self.axis < 3:
            vector[self.axis] = self.sign
        return vector

    def __str__(self) -> str:
        """Print as test engineers write it: ``12-Z``."""
        return f"{self.node}{'-' if self.sign < 0 else '+'}{_LETTERS[abs(self.direction)]}"
