"""Accelerometers whose mass the user wants out of the FRFs."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition import Dof, FrfSet, InputError, remove_sensor_mass
from acquisition.quantities import quantity
from acquisition.warned import Consequential


def without_sensors(frfs: FrfSet, masses: Sequence[tuple[str, float]], warnings: list[str]) -> FrfSet:
    """Return the FRFs without the mass of accelerometers, and say so.

    Parameters
    ----------
    frfs : FrfSet
        FRFs.
    masses : sequence of (str, float)
        Where accelerometers sat during the whole test, as printed, and their masses [kg]. Other responses are
        taken to weigh nothing.
    warnings : list of str
        Warnings are added here.

    Raises
    ------
    InputError
        If there is no such response, or it is named twice.
    EstimationError
        If an FRF that is needed was not measured.
    """
    if not masses:
        return frfs
    given: dict[Dof, float] = {}
    there = {_plain(dof) for dof in frfs.responses}
    for name, mass in masses:
        dof = _plain(Dof.of(name))
        if dof not in there:
            known = ", ".join(str(d) for d in sorted(there)[:8])
            raise InputError(
                f"{frfs.source}: no response at {name}, so no sensor mass can be removed there; responses are {known}"
            )
        if dof in given:
            raise InputError(f"{frfs.source}: the mass of the sensor at {name} is given twice; give it once")
        given[dof] = mass
    result = remove_sensor_mass(frfs, mass=dict.fromkeys(there, 0.0) | given)
    stated = ", ".join(f"{quantity(mass, 'kg')} at {dof}" for dof, mass in given.items())
    warnings.append(Consequential(f"the mass of the accelerometers was removed from the FRFs: {stated}"))
    return result


def _plain(dof: Dof) -> Dof:
    return Dof(dof.node, abs(dof.direction))
