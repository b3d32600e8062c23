"""The document of a localisation, ``modalkit.localisation/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypedDict

from modalkit.output.fields import Of


class LocalisedRegion(TypedDict):
    """A region of the model."""

    name: Annotated[str, "its name"]
    center: Annotated[Sequence[float], "its centre, in as many coordinates as a place on the model has [m]"]


class MethodEntry(TypedDict):
    """What one method finds; lists are in the order of `regions`."""

    method: Annotated[str, "its name, as `--method` takes it"]
    scores: Annotated[
        Sequence[float], "score of each region, higher is more suspect; for `evidence` its probability [-]"
    ]
    ranks: Annotated[Sequence[float], "rank of each region from 1; equal scores share their mean rank [-]"]
    summary: Annotated[str, "what it compares"]
    needs: Annotated[str, "the data that it needs"]
    misleads: Annotated[str, "when its first region is the wrong one"]
    source: Annotated[str, "where it is published"]


class AgreementEntry(TypedDict):
    """How far the methods agree."""

    region: Annotated[str, "region that most methods put first"]
    methods: Annotated[int, "number of these methods [-]"]
    kendall_w: Annotated[
        float | None,
        "Kendall's coefficient of concordance of their ranks, 1 where all are alike; null with one method [-]",
    ]


class LocalisationDocument(TypedDict):
    """Written by `modalkit localise STUDY --json`."""

    schema: Annotated[Literal["modalkit.localisation/1"], "kind and version of the document"]
    study: Annotated[str, "title of the study", Of("title")]
    kind: Annotated[str, "property of a region that may be wrong: `stiffness`, `mass` or `damping`"]
    regions: Annotated[Sequence[LocalisedRegion], "regions in the order of the model"]
    methods: Annotated[Sequence[MethodEntry], "methods used, the most reliable first"]
    not_used: Annotated[Mapping[str, str], "methods that cannot be used, with the reason"]
    agreement: Annotated[AgreementEntry, "how far the methods agree"]
    unchanged: Annotated[
        float | None, "probability that no region is changed, by `evidence`; null without it [-]"
    ]
    warnings: Annotated[Sequence[str], "what the user should know"]
