"""Which variable of a MATLAB file is what: the table ``[mat]`` of a layout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.columns.units import QUANTITIES, RESPONSES
from acquisition.dof import Dof
from acquisition.errors import InputError

AXES = ("line", "response", "reference")


@dataclass(frozen=True)
class MatLayout:
    """What the variables of a MATLAB file hold: FRFs or modes.

    Parameters
    ----------
    frequency : str
        Variable with the lines, or the modes' frequencies [Hz]; a field of a structure with a dot, ``"test.f"``. "" of
        FRFs whose lines follow from ``rate`` and ``samples`` of the layout.
    frfs : str
        Variable with the FRFs; "" for modes.
    axes : tuple of str
        What its dimensions are, in their order: ``line``, ``response``, ``reference``; of two dimensions, one of the
        latter is left out.
    quantity, unit : str
        What the FRFs are, as in ``[[column]]``; "" for SI units.
    responses, references : tuple of str
        Degrees of freedom along these dimensions, ``3-Z``; exactly one where the dimension is left out.
    damping, damping_unit : str
        Variable with the modes' damping, and whether it is a ``ratio`` or in ``percent``.
    shapes : str
        Variable with the shapes, (degrees of freedom, modes).
    dofs : tuple of str
        Degrees of freedom of the shapes.
    scaled : bool
        Whether the shapes are mass-normalised.
    """

    frequency: str = ""
    frfs: str = ""
    axes: tuple[str, ...] = AXES
    quantity: str = "accelerance"
    unit: str = ""
    responses: tuple[str, ...] = ()
    references: tuple[str, ...] = ()
    damping: str = ""
    damping_unit: str = "ratio"
    shapes: str = ""
    dofs: tuple[str, ...] = ()
    scaled: bool = False


def mat_layout(table: Any, source: str) -> MatLayout:
    """Return the mapping of a ``[mat]`` table.

    Raises
    ------
    InputError
        If a key is unknown, has a value of the wrong kind, or the keys do not go together.
    """
    if not isinstance(table, Mapping):
        raise InputError(f'{source}: mat is not a table; write [mat] with lines such as frequency = "f"')
    known = MatLayout.__dataclass_fields__
    values: dict[str, Any] = {}
    for key, value in table.items():
        if key == "rate":
            raise InputError(f"{source}: [mat] has no rate; write rate = {value!r} above it, beside samples")
        if key not in known:
            raise InputError(f"{source}: [mat] has unknown key {key!r}; keys are {', '.join(known)}")
        values[key] = _value(value, known[key].default, f"{source}: [mat] {key}")
    layout = MatLayout(**values)
    _check(layout, source)
    return layout


def check_axis(layout: MatLayout, rate: float | str | None, source: str) -> None:
    """See that there are lines of FRFs or frequencies of modes: named, or of FRFs those that a sampling rate makes.

    Raises
    ------
    InputError
        If there are none, or both.
    """
    if bool(layout.frequency) == (rate is not None) or (rate is not None and not layout.frfs):
        raise InputError(
            f"{source}: [mat] needs frequency, of the lines or of the modes; for FRFs without it, give rate and "
            "samples above [mat]"
        )


def _value(value: Any, default: Any, where: str) -> Any:
    """Return the value of a key, of the kind its default has: a list of texts, a text, or true or false."""
    if isinstance(default, tuple):
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise InputError(f"{where} = {value!r} is not a list of texts")
        return tuple(value)
    kind = bool if isinstance(default, bool) else str
    if not isinstance(value, kind):
        raise InputError(f"{where} = {value!r} is not {'a text' if kind is str else 'true or false'}")
    return value


def _check(layout: MatLayout, source: str) -> None:
    if bool(layout.shapes) != bool(layout.dofs):
        raise InputError(f"{source}: [mat] shapes and dofs go together; give both or neither")
    if layout.damping_unit not in ("ratio", "percent"):
        raise InputError(f"{source}: [mat] damping_unit = {layout.damping_unit!r}; write ratio or percent")
    if layout.frfs:
        if layout.damping or layout.shapes:
            raise InputError(f"{source}: [mat] names FRFs and modes; give a layout for each")
        if layout.quantity not in QUANTITIES or layout.quantity not in RESPONSES:
            raise InputError(f"{source}: [mat] quantity = {layout.quantity!r}; use {', '.join(RESPONSES)}")
        if not layout.responses or not layout.references:
            raise InputError(f'{source}: [mat] frfs need responses and references, as ["1+Z", "2+Z"]')
        if (
            "line" not in layout.axes
            or len(set(layout.axes)) < len(layout.axes)
            or set(layout.axes) - set(AXES)
        ):
            raise InputError(
                f"{source}: [mat] axes = {list(layout.axes)}; name line, response, reference in order"
            )
    for text in (*layout.responses, *layout.references, *layout.dofs):
        try:
            Dof.of(text)
        except InputError as error:
            raise InputError(f"{source}: [mat] {error}") from None
