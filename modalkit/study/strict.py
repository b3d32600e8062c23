"""A table of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, model_validator


class Strict(BaseModel):
    """A table without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _no_switches(cls, table: Any) -> Any:
        """See that no key is ``true`` or ``false``, which would count as 1 or 0."""
        for key, value in table.items() if isinstance(table, dict) else ():
            if any(isinstance(v, bool) for v in (value if isinstance(value, list) else [value])):
                raise ValueError(f"{key} cannot be true or false; give a number, text or list")
        return table


def rising(name: str, ends: tuple[float, float] | None) -> None:
    """See that the ends of a range stand in order.

    Raises
    ------
    ValueError
        If they do not.
    """
    if ends is not None and not ends[0] < ends[1]:
        raise ValueError(f"{name} = [{ends[0]:g}, {ends[1]:g}] ends before it begins; give [low, high]")
