"""An update as the document of its JSON file, whose keys are a contract."""

from __future__ import annotations

from modalkit.output.fields import fill
from modalkit.output.schemas.update import ByFrfs, UpdateDocument, UpdatedPair
from updating.frf_update import FrfUpdate
from updating.update import Update


def to_json(update: Update) -> UpdateDocument:
    """Return an update as ``modalkit.update/1``; what is not finite becomes None.

    Parameters
    ----------
    update : Update
        The result. ``value``, ``sigma``, ``low`` and ``high`` of a parameter are in its ``unit``; ``study`` is
        None for a parameter that several studies share.
    """
    pairs = [fill(UpdatedPair, {"shape_sigma": None, **row}) for row in update.pairs.to_dict("records")]
    return fill(
        UpdateDocument,
        update,
        pairs=pairs,
        rms_percent={"before": update.rms_percent("before"), "after": update.rms_percent("after")},
        frf=fill(ByFrfs, update) if isinstance(update, FrfUpdate) else None,
    )
