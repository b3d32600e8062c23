"""Frequencies and damping ratios as they were published [Hz, -]."""

PUBLISHED: dict[str, tuple[float, ...]] = {
    "beam_dry": (24.47, 153.96, 429.15),
    "beam_wet": (19.17, 119.80, 337.86),
    "plate_dry": (
        16.76,
        70.69,
        104.91,
        229.96,
        296.64,
        425.51,
        446.90,
        574.19,
        591.14,
        731.06,
        843.22,
        951.13,
    ),
    "plate_wet": (7.27, 39.61, 48.60, 132.58, 146.44, 262.12, 268.27, 310.61, 367.30, 446.70, 531.26, 539.65),
    "tape_taped": (24.3, 67.2, 130.3, 217.1, 323.8, 453.2),
}

PUBLISHED_DAMPING: dict[str, tuple[float, ...]] = {
    "tape_taped": (0.0130, 0.0082, 0.0056, 0.0048, 0.0041, 0.0056),
}

PAPER = (
    "Badan, Rade, Pillet and Pena, 'Experimental characterization and adjustment of finite element models of "
    "submerged structures'"
)
TAPE_PAPER = "'FE-model updating of beam structure presenting non proportional damping'"

TABLES: dict[str, str] = {
    "beam_dry": "Table 1",
    "beam_wet": "Table 2",
    "plate_dry": "Table 3",
    "plate_wet": "Table 4",
    "tape_taped": "Tables 3 and 5",
}
