"""From FRFs to modes with uncertainties."""

from identification.identify import identify
from identification.mac import auto_mac, comac, ecomac, fdac, frac, mac, macx, mpc, msf
from identification.model import ModalModel
from identification.pairing import Pair, pair
from identification.poles import ESTIMATORS, PoleEstimator, PoleSets, lsce, lscf
from identification.residues import Residues, fit_residues
from identification.scaling import Shapes, mode_shapes
from identification.sdypy_bridge import from_sdypy, second_opinion, to_sdypy
from identification.stabilisation import StabilisationChart, stabilise

__all__ = [
    "ESTIMATORS",
    "ModalModel",
    "Pair",
    "PoleEstimator",
    "PoleSets",
    "Residues",
    "Shapes",
    "StabilisationChart",
    "auto_mac",
    "comac",
    "ecomac",
    "fdac",
    "fit_residues",
    "frac",
    "from_sdypy",
    "identify",
    "lsce",
    "lscf",
    "mac",
    "macx",
    "mode_shapes",
    "mpc",
    "msf",
    "pair",
    "second_opinion",
    "stabilise",
    "to_sdypy",
]
