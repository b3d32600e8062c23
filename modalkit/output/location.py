"""Where the gap sits, in a sentence."""

from __future__ import annotations

from acquisition.display import counted
from modalkit.output.names import zone_in_words
from modalkit.output.words import located, phrase
from updating import Diagnosis

NAMED = 4
"""Most sets of effects that a title names; of more, it states how many [-]."""


def localisation_title(diagnosis: Diagnosis) -> str:
    """State where the gap sits, as far as the answer's own sets of effects show it."""
    where = diagnosis.where
    if where.channel == "none":
        return "There is no gap beyond tolerances and noise"
    top = max(where.zones, key=lambda z: z.probability, default=None)
    if diagnosis.verdict == "unknown" and top is not None:
        return f"No explanation was found for the gap; a change of {zone_in_words(top.name)} alone would fit best"
    if _in_doubt(diagnosis):
        return "These data cannot show whether the gap lies in the measurement or in the structure"
    if spans(diagnosis):
        points = f" of point{'s' * (len(where.points) > 1)} {', '.join(map(str, where.points))}"
        inside = (
            f", {located(diagnosis)}" if where.location is not None and where.channel != "measurement" else ""
        )
        return f"The gap sits in the measurement{points if where.points else ''} and in the structure{inside}"
    if where.channel == "measurement" and (where.points or where.location is None):
        named = f" of point{'s' * (len(where.points) > 1)} {', '.join(map(str, where.points))}"
        return f"The gap sits in the measurement{named if where.points else ''}, not in the structure"
    if where.location is not None:
        others = len(where.locations) - 1
        more = f", or at {'another place' if others == 1 else f'{others} other places'}" if others else ""
        leader = diagnosis.ranking[0].effects if diagnosis.ranking else ()
        if diagnosis.verdict == "class" and leader:
            return f"If it is {phrase(leader)}: {located(diagnosis)}{more}"
        whole = "Part of the gap" if diagnosis.sets and len(diagnosis.sets[0]) > 1 else "The gap"
        return f"{whole} sits {located(diagnosis)}{more}"
    if diagnosis.verdict not in ("named", "class"):
        return "No explanation was found for the gap, and it has no single place"
    listed = [phrase(names) for names in diagnosis.sets[:NAMED]]
    if len(diagnosis.sets) > NAMED:
        listed.append(counted(len(diagnosis.sets) - NAMED, "other"))
    whole = listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} or {listed[-1]}"
    return f"The gap has no single place: {whole} acts all over the structure"


def _in_doubt(diagnosis: Diagnosis) -> bool:
    """Return whether some sets of the answer lie in the measurement alone and others do not."""
    acting = [{diagnosis.known[n].channel for n in names if n in diagnosis.known} for names in diagnosis.sets]
    alone = [channels == {"measurement"} for channels in acting]
    return diagnosis.verdict == "class" and any(alone) and not all(alone)


def spans(diagnosis: Diagnosis) -> bool:
    """Return whether the first explanation has a cause in the measurement and one in the structure."""
    leader = diagnosis.ranking[0].effects if diagnosis.ranking else ()
    acting = {diagnosis.known[name].channel for name in leader if name in diagnosis.known}
    return diagnosis.verdict in ("named", "class") and "measurement" in acting and len(acting) > 1
