"""From FRFs to modes with uncertainties."""

from typing import TYPE_CHECKING

from acquisition.lazy import load_on_demand

if TYPE_CHECKING:
    from identification.band.health import frf_health, mode_coherence
    from identification.band.informed import at_cut_edge, informed_band
    from identification.fit.equations.residues import Residues, fit_residues
    from identification.identify import Prepared, identify, prepare
    from identification.level_dependence import LevelDependence
    from identification.levels.one_level import at_one_level, is_smeared, with_line_doubt
    from identification.levels.products import Growth, growth
    from identification.levels.slopes import follows_level, level_dependence, why_no_level_dependence
    from identification.levels.stretched import Stretched, stretched_averages
    from identification.levels.sums import coincidences, combination
    from identification.mac import (
        auto_mac,
        comac,
        common_dofs,
        coordinate_table,
        ecomac,
        fdac,
        frac,
        frac_table,
        mac,
        mac_table,
        macx,
        modes_table,
        mpc,
        msf,
        subspace_mac,
    )
    from identification.model import ModalModel
    from identification.pairing import Correlation, Pair, Subspace, correlate, pair
    from identification.pole_reasons import Origins, PoleReason, pole_origins
    from identification.poles import ESTIMATORS, PoleEstimator, PoleSets, lsce, lscf
    from identification.poles.cmif import cmif
    from identification.poles.mvmif import mvmif
    from identification.poles.stabilisation import StabilisationChart, stabilise
    from identification.scaling import Shapes, modal_constants, mode_shapes, real_modes
    from identification.sdypy_bridge import beside, from_sdypy, second_opinion, to_sdypy
    from identification.trend import Trend

__all__ = [
    "ESTIMATORS",
    "Correlation",
    "Growth",
    "LevelDependence",
    "ModalModel",
    "Origins",
    "Pair",
    "PoleEstimator",
    "PoleReason",
    "PoleSets",
    "Prepared",
    "Residues",
    "Shapes",
    "StabilisationChart",
    "Stretched",
    "Subspace",
    "Trend",
    "at_cut_edge",
    "at_one_level",
    "auto_mac",
    "beside",
    "cmif",
    "coincidences",
    "comac",
    "combination",
    "common_dofs",
    "coordinate_table",
    "correlate",
    "ecomac",
    "fdac",
    "fit_residues",
    "follows_level",
    "frac",
    "frac_table",
    "frf_health",
    "from_sdypy",
    "growth",
    "identify",
    "informed_band",
    "is_smeared",
    "level_dependence",
    "lsce",
    "lscf",
    "mac",
    "mac_table",
    "macx",
    "modal_constants",
    "mode_coherence",
    "mode_shapes",
    "modes_table",
    "mpc",
    "msf",
    "mvmif",
    "pair",
    "pole_origins",
    "prepare",
    "real_modes",
    "second_opinion",
    "stabilise",
    "stretched_averages",
    "subspace_mac",
    "to_sdypy",
    "why_no_level_dependence",
    "with_line_doubt",
]

load_on_demand(
    __name__,
    {
        ".poles.cmif": "cmif",
        ".poles.mvmif": "mvmif",
        ".band.health": "frf_health mode_coherence",
        ".identify": "Prepared identify prepare",
        ".band.informed": "at_cut_edge informed_band",
        ".levels.one_level": "at_one_level is_smeared with_line_doubt",
        ".levels.products": "Growth growth",
        ".levels.sums": "coincidences combination",
        ".levels.stretched": "Stretched stretched_averages",
        ".level_dependence": "LevelDependence",
        ".levels.slopes": "follows_level level_dependence why_no_level_dependence",
        ".mac": (
            "auto_mac comac common_dofs coordinate_table ecomac fdac frac frac_table mac mac_table macx modes_table "
            "mpc msf subspace_mac"
        ),
        ".model": "ModalModel",
        ".pairing": "Correlation Pair Subspace correlate pair",
        ".pole_reasons": "Origins PoleReason pole_origins",
        ".poles": "ESTIMATORS PoleEstimator PoleSets lsce lscf",
        ".fit.equations.residues": "Residues fit_residues",
        ".scaling": "Shapes modal_constants mode_shapes real_modes",
        ".sdypy_bridge": "beside from_sdypy second_opinion to_sdypy",
        ".poles.stabilisation": "StabilisationChart stabilise",
        ".trend": "Trend",
    },
)
