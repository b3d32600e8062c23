"""A localisation as the document of its JSON file."""

from __future__ import annotations

from modalkit.output.fields import fill
from modalkit.output.schemas.localisation import LocalisationDocument
from updating.localisation import METHODS, Localisation


def localisation_document(found: Localisation) -> LocalisationDocument:
    """Return a localisation as ``modalkit.localisation/1``.

    Parameters
    ----------
    found : Localisation
        The result.
    """
    best, count = found.favourite
    return fill(
        LocalisationDocument,
        found,
        regions=[
            {"name": name, "center": center}
            for name, center in zip(found.regions, found.centres.tolist(), strict=True)
        ],
        methods=[
            {
                "method": one.method,
                "scores": one.scores.tolist(),
                "ranks": one.ranks.tolist(),
                "summary": METHODS[one.method].summary,
                "needs": METHODS[one.method].needs,
                "misleads": METHODS[one.method].misleads,
                "source": METHODS[one.method].source,
            }
            for one in found.found
        ],
        agreement={"region": found.regions[best], "methods": count, "kendall_w": found.concordance},
    )
