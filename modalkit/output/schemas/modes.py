"""The document of an identification, ``modalkit.modes/1``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of


class ShapeEntry(TypedDict):
    """One degree of freedom of a mode shape."""

    node: Annotated[int, "node number of the test [-]"]
    direction: Annotated[
        int, "UFF direction code: 1, 2, 3 along x, y, z, 4 to 6 about them, negative against them, 0 none [-]"
    ]
    re: Annotated[float, "real part, mass-normalised where `scaled` [kg^-1/2, or -]"]
    im: Annotated[float, "imaginary part [kg^-1/2, or -]"]
    sigma: Annotated[float | None, "standard deviation; null where none is known [as `re`]"]


class ModeEntry(TypedDict):
    """One mode."""

    frequency_hz: Annotated[float, "undamped natural frequency [Hz]"]
    frequency_sigma_hz: Annotated[
        float | None, "its standard deviation; null where a file of modes has none [Hz]"
    ]
    damping_ratio: Annotated[float | None, "viscous damping ratio; null where a file of modes has none [-]"]
    damping_sigma: Annotated[float | None, "its standard deviation; null where a file of modes has none [-]"]
    shape: Annotated[Sequence[ShapeEntry], "mode shape; empty where the modes have none"]
    mpc: Annotated[
        float | None,
        "modal phase collinearity, 1 for a real shape; null without shape, or at one point only [-]",
    ]
    scaled: Annotated[bool, "whether the shapes are mass-normalised, which takes a drive point"]


class HitEntry(TypedDict):
    """The verdict on one hit."""

    point: Annotated[str, "where it hit: node, sign and axis, `3-Z`"]
    hit: Annotated[int, "number of the hit at that point, from 1 [-]"]
    used: Annotated[bool, "whether it is among the averaged"]
    reasons: Annotated[Sequence[str], "what is against it; empty for a good one"]


class NodeEntry(TypedDict):
    """The place of a node."""

    node: Annotated[int, "node number [-]"]
    x: Annotated[float, "coordinate in the axes of the test [m]"]
    y: Annotated[float, "likewise [m]"]
    z: Annotated[float, "likewise [m]"]


class TrendEntry(TypedDict):
    """Change of the frequencies over a test that roves, about the modes listed, which are those in its middle."""

    rate: Annotated[float, "relative change from the first point to the last, in the order of the file [-]"]
    sigma: Annotated[float, "its standard deviation [-]", Of("rate_sigma")]
    points: Annotated[
        int, "number of points, or sets of FRFs, measured one after the other [-]", Of("setups")
    ]


class ModesDocument(TypedDict):
    """Written by `modalkit identify --json` (or `-o` with the ending `.json`), and read back like any file of modes."""

    schema: Annotated[Literal["modalkit.modes/1"], "kind and version of the document"]
    modes: Annotated[Sequence[ModeEntry], "modes by frequency"]
    points_rejected: Annotated[Sequence[str], "points, or FRFs, that are not used, each with the reason"]
    hits: Annotated[Sequence[HitEntry], "verdicts on the raw hits; empty where the file holds none"]
    window_decay_removed: Annotated[
        float, "decay rate of the exponential window that was removed from the damping; 0 for none [1/s]"
    ]
    warnings: Annotated[Sequence[str], "what the user should know"]
    nodes: Annotated[Sequence[NodeEntry], "places of the nodes; empty where the file has none"]
    trend: Annotated[
        TrendEntry | None,
        "drift of the frequencies over the test; null where it does not rove, or for modes that were read",
    ]
