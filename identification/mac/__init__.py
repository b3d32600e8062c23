"""Comparison of mode shapes and of FRFs: the MAC family, one file for each kind of thing compared."""

from identification.mac.coordinates import comac, ecomac
from identification.mac.frfs import fdac, frac
from identification.mac.shapes import auto_mac, mac, macx, mpc, msf
from identification.mac.subspace import subspace_mac
from identification.mac.tables import (
    CommonDofs,
    common_dofs,
    coordinate_table,
    frac_table,
    mac_table,
    modes_table,
)

__all__ = [
    "CommonDofs",
    "auto_mac",
    "comac",
    "common_dofs",
    "coordinate_table",
    "ecomac",
    "fdac",
    "frac",
    "frac_table",
    "mac",
    "mac_table",
    "macx",
    "modes_table",
    "mpc",
    "msf",
    "subspace_mac",
]
