"""What can be done to a study in the app: pure functions from its tables to new ones."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.errors import InputError
from modalkit.app.form import model_of

Content = dict[str, Any]
Arguments = Mapping[str, Any]

NEAR = 0.01
"""Relative distance at which a frequency named takes back another one: that of `identify`, which finds the mode to drop
within it [-]."""


@dataclass(frozen=True)
class Action:
    """One kind of change.

    Parameters
    ----------
    change : callable
        From tables, which it may change, and arguments to a word on what was done.
    """

    change: Callable[[Content, Arguments], str]

    def __call__(self, content: Mapping[str, Any], arguments: Arguments) -> tuple[Content, str]:
        """Return changed tables and what was done; those given stay as they are.

        Raises
        ------
        InputError
            If an argument is missing or is not what it should be.
        """
        changed = copy.deepcopy(dict(content))
        try:
            label = self.change(changed, arguments)
        except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"this change cannot be made: {error}") from error
        return changed, label


def _test(content: Content) -> Content:
    found: Content = content["test"]
    return found


def _put(table: Content, key: str, value: Any) -> None:
    """Set a key, or take it out where the value is empty."""
    if value is None or value == []:
        table.pop(key, None)
    else:
        table[key] = value


def judge_hit(content: Content, a: Arguments) -> str:
    """Use a hit or leave it out; where that is what is proposed, nothing needs to be stated."""
    point, hit, used = str(a["point"]), int(a["hit"]), bool(a["used"])
    test = _test(content)
    for key in ("use", "leave"):
        kept = [
            h for h in test.get(key, []) if (str(h[0]).strip().upper(), int(h[1])) != (point.upper(), hit)
        ]
        _put(test, key, kept)
    if used != bool(a["proposed"]):
        key = "use" if used else "leave"
        _put(test, key, [*test.get(key, []), [point, hit]])
    return f"{'use' if used else 'leave out'} hit {hit} at {point}"


def pick(content: Content, a: Arguments) -> str:
    """Keep a mode at a frequency, or take back that it was dropped."""
    return _named(_test(content), float(a["hertz"]), wanted="add", other="drop", word="pick")


def drop(content: Content, a: Arguments) -> str:
    """Leave a mode out, or take back that it was picked."""
    return _named(_test(content), float(a["hertz"]), wanted="drop", other="add", word="drop")


def _named(test: Content, hertz: float, *, wanted: str, other: str, word: str) -> str:
    from acquisition.si_units import si_value

    opposite = [value for value in test.get(other, []) if abs(si_value(value, "Hz") - hertz) > NEAR * hertz]
    if len(opposite) == len(test.get(other, [])):
        _put(test, wanted, [*test.get(wanted, []), hertz])
    _put(test, other, opposite)
    return f"{word} {hertz:.6g} Hz"


def band(content: Content, a: Arguments) -> str:
    """Set the band; without limits, as far as the force reaches."""
    limits = None if a.get("low") is None or a.get("high") is None else [float(a["low"]), float(a["high"])]
    _put(_test(content), "band", limits)
    return "band as the force reaches" if limits is None else f"band {limits[0]:g} to {limits[1]:g} Hz"


def order(content: Content, a: Arguments) -> str:
    """Set the highest model order."""
    value = None if a.get("order") is None else int(a["order"])
    _put(_test(content), "order", value)
    return "order as usual" if value is None else f"order {value}"


def references(content: Content, a: Arguments) -> str:
    """Set the forces used; none named is all."""
    names = [str(name) for name in a["names"]]
    _put(_test(content), "references", names)
    return f"references {', '.join(names) or 'all'}"


def estimator(content: Content, a: Arguments) -> str:
    """Set the FRF estimator."""
    _put(_test(content), "estimator", str(a["name"]))
    return f"estimator {a['name']}"


def pair(content: Content, a: Arguments) -> str:
    """State which model mode a measured mode is; 0 that it is none, nothing that it is found out."""
    test, hertz = _test(content), float(a["hertz"])
    kept = [p for p in test.get("pairs", []) if abs(float(p[0]) - hertz) > NEAR * hertz]
    if a.get("model") is not None:
        kept.append([hertz, int(a["model"])])
    _put(test, "pairs", sorted(kept))
    if a.get("model") is None:
        return f"pair {hertz:.6g} Hz as found"
    partner = int(a["model"])
    return f"pair {hertz:.6g} Hz with {f'mode {partner}' if partner else 'none'}"


def join(content: Content, a: Arguments) -> str:
    """Join two points by a line in drawings, or part them; ``drawn`` are the lines so far, as pairs of points."""
    test, pair = _test(content), sorted((int(a["points"][0]), int(a["points"][1])))
    if pair[0] == pair[1]:
        raise InputError(f"point {pair[0]} cannot be joined with itself; choose another one")
    lines = [sorted(map(int, line)) for line in test.get("lines") or a["drawn"]]
    joined = pair not in lines
    left = [*lines, pair] if joined else [line for line in lines if line != pair]
    if not left:
        raise InputError("this is the last line; join other points first")
    test["lines"] = left
    return f"{'connect' if joined else 'disconnect'} points {pair[0]} and {pair[1]}"


def set_value(content: Content, a: Arguments) -> str:
    """Set one key of the study; an empty text takes it out."""
    *tables, key = [str(part) for part in a["path"]]
    table = content
    for name in tables:
        table = table[int(name)] if isinstance(table, list) else table.setdefault(name, {})
    value = a.get("value")
    _put(table, key, None if value == "" else value)
    return f"{'.'.join((*tables, key))} = {value if value not in (None, '') else 'left out'}"


def replace_text(content: Content, a: Arguments) -> str:
    """Take the tables of a text of TOML in place of all."""
    try:
        new = tomllib.loads(str(a["text"]))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"not valid TOML: {error}") from error
    content.clear()
    content.update(new)
    return "edit the study"


ACCEPTED = "accept "
"""How the label of an accepted row begins."""


def accept(content: Content, a: Arguments) -> str:
    """Put effects into the model; further ones of a kind stand beside those there are.

    ``places`` are those of points after an exchange of labels.
    """
    entries = [dict(entry) for entry in a["effects"]]
    places = {str(node): list(place) for node, place in dict(a.get("places", {})).items()}
    model = content.setdefault("model", {})
    _put(model, "effect", [*model.get("effect", []), *entries])
    if places:
        test = _test(content)
        test["places"] = {**test.get("places", {}), **places}
    words = [str(entry["name"]).replace("_", " ") for entry in entries]
    words += [f"places of points {' and '.join(places)} exchanged"] * bool(places)
    return f"{ACCEPTED}{', '.join(words)}"


def remove(content: Content, a: Arguments) -> str:
    """Take an effect out of the model."""
    effects = list(content["model"].get("effect", []))
    gone = effects.pop(int(a["index"]))
    _put(content["model"], "effect", effects)
    return f"take {gone.get('name')} out of the model"


ACTIONS: Mapping[str, Action] = {
    "hit": Action(judge_hit),
    "pick": Action(pick),
    "drop": Action(drop),
    "band": Action(band),
    "order": Action(order),
    "references": Action(references),
    "estimator": Action(estimator),
    "pair": Action(pair),
    "join": Action(join),
    "set": Action(set_value),
    "text": Action(replace_text),
    "model": Action(model_of),
    "accept": Action(accept),
    "remove": Action(remove),
}
"""By the name under which the page asks for them."""
