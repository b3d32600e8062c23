"""Whether the numbers of a text stand in the same columns on every line: what a lost or damaged character breaks."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from acquisition.errors import InputError

_Alike = Callable[[bytes, bytes], bool]
# a line's form: digits as 0, signs and blanks as a blank, exponent letters as e, points and line ends as they are
_KINDS = {b"0123456789": "0", b"+- \t\r": " ", b"eEdD": "e", b".": ".", b"\n": "\n"}
_FORM_OF = bytes(
    next((ord(mark) for members, mark in _KINDS.items() if code in members), ord("x")) for code in range(256)
)
_TOKEN = re.compile(rb"(?:0+\.?0*|\.0+)(?:e ?0+)?|x+")
_NUMBER = re.compile(rb"(?:0+\.?0*|\.0+)(?:e ?0+| 000)?|x+")
_EXPONENTIAL = re.compile(rb"(?<![\d.eEdD])[\d.]{1,40}[eEdD][+-]?\d+")
_EXPONENT = re.compile(rb"e ?0+")
# Most forms that are distinguished; a text of fixed columns has a handful, one of free columns as many as it has
# lines. It bounds memory at some 100 bytes each; doubling it changes nothing for either.
_MOST_FORMS = 4096
# Forms that are tried for the usual one. In a table of a few lines no two are the same, as numbers of nodes have
# other lengths; doubling it doubles the time for such tables.
_MODELS = 8
# Share of lines that may break the columns before they count as none. Printed with trailing zeros dropped, half
# the lines of a text differ; doubling it would refuse some of those.
_BROKEN_SHARE = 0.1
# Lines that a line end in the wrong place makes of one; a text of so few more than usual ones is no free one.
# Doubling it would take a free text of six lines for a damaged one.
_OF_ONE_BREAK = 2


@dataclass
class LineForms:
    """The forms of the lines of a text, counted piece by piece.

    Parameters
    ----------
    count : Counter
        Lines of each form; empty ones are not counted.
    last : bytes
        Form of the last line.
    values : Counter
        Lines by how many numbers stand on them, once there are too many forms to count.
    """

    count: Counter[bytes] = field(default_factory=Counter)
    last: bytes = b""
    values: Counter[int] = field(default_factory=Counter)

    def add(self, text: bytes) -> None:
        """Take note of some whole lines."""
        forms = text.translate(_FORM_OF).split(b"\n")
        self.last = next((bare for form in reversed(forms) if (bare := form.rstrip())), self.last)
        for form, lines in Counter(forms).items():
            self.count[form.rstrip()] += lines
        del self.count[b""]
        if len(self.count) > _MOST_FORMS:
            self.values += _by_values(self.count)
            self.count.clear()

    def broken(self) -> bytes | None:
        """Return the form of a line that leaves the columns of the others; None if none does, or there are none."""
        lines = self.count.total()
        models = [form for form, _ in self.count.most_common(_MODELS)] if not self.values else []
        for alike in (_alike, _aligned):
            wrong = min((self._wrong(model, alike) for model in models), key=self._lines, default=[])
            count = self._lines(wrong)
            if count <= max(1, _BROKEN_SHARE * lines) and lines - count >= 2:
                return wrong[0] if wrong else None
        return None

    def _lines(self, forms: list[bytes]) -> int:
        return sum(self.count[form] for form in forms)

    def _wrong(self, model: bytes, alike: _Alike) -> list[bytes]:
        columns = _columns(model)
        return [form for form in self.count if form != model and not self._fits(form, columns, alike)]

    def _fits(self, form: bytes, columns: list[tuple[int, bytes]], alike: _Alike) -> bool:
        ends = [end for end, _ in columns]
        if len(form) not in (ends if form == self.last and self.count[form] == 1 else ends[-1:]):
            return False
        starts = (0, *ends)
        return all(
            alike(form[start:end].lstrip(), model)
            for start, (end, model) in zip(starts, columns, strict=False)
            if end <= len(form)
        )

    @property
    def on_last(self) -> int:
        """How many numbers stand on the last line."""
        return _values(self.last)

    def uneven(self, wanted: int) -> bool:
        """Return whether a line but the last holds another number of values than most, or the last more.

        Where no number of values is that of most lines, nor of all but those that one break makes, the text is a
        free one, and none is wrong.

        Parameters
        ----------
        wanted : int
            Values on a line where a text is too short to tell.
        """
        values = self.values + _by_values(self.count)
        last = self.on_last
        values[last] -= 1
        values += Counter()
        usual, lines = wanted, values[wanted]
        if values.total() >= 3 and values.total() - lines > _OF_ONE_BREAK:
            usual, lines = values.most_common(1)[0]
            if 2 * lines <= values.total() and values.total() - lines > _OF_ONE_BREAK:
                return False
        return any(one != usual for one in values) or last > usual


def check_columns(text: bytes) -> None:
    """Check that the lines of a table keep to their columns, those with points and those of whole numbers.

    Raises
    ------
    InputError
        If one does not, where the others do.
    """
    for pointed in (True, False):
        lines = [line for line in text.split(b"\n") if (b"." in line) == pointed]
        forms = LineForms()
        forms.add(b"\n".join(lines))
        broken = forms.broken() or (None if pointed else _off_tens(forms.count))
        if broken is not None:
            quoted = next(line for line in lines if form_of(line) == broken).strip()[:80].decode("latin-1")
            raise InputError(
                f"its line {quoted!r} does not keep to the columns of the others: a character is lost or damaged"
            )


def _off_tens(forms: Counter[bytes]) -> bytes | None:
    """Return the form of the only line whose whole numbers do not all end in a tenth column; None if none."""
    ends = {form: [found.end() % 10 for found in _TOKEN.finditer(form)] for form in forms}
    off = [form for form, places in ends.items() if any(places)]
    aligned = sum(places.count(0) for places in ends.values())
    return off[0] if len(off) == 1 and forms[off[0]] == 1 and aligned >= 2 else None


def check_digits(text: bytes) -> None:
    """Check that numbers with exponents are printed with the same digits, where all but one are.

    Raises
    ------
    InputError
        If one is not.
    """
    numbers = _EXPONENTIAL.findall(text)
    forms = Counter(_digits(number) for number in numbers)
    if len(forms) == 2 and min(forms.values()) == 1 < max(forms.values()):
        odd = next(number for number in numbers if forms[_digits(number)] == 1).decode("latin-1")
        raise InputError(f"its number {odd!r} is not printed as the others: a character is lost or damaged")


def _digits(number: bytes) -> tuple[int, int, int]:
    """Return the digits before and behind the point and of the exponent, 2 for three that are needed."""
    mantissa, exponent = re.split(rb"[eEdD]", number)
    whole, _, decimals = mantissa.partition(b".")
    power = exponent.lstrip(b"+-")
    return len(whole), len(decimals), 2 if len(power) == 3 and power[:1] != b"0" else len(power)


def form_of(line: bytes) -> bytes:
    """Return the form of a line."""
    return line.translate(_FORM_OF).rstrip()


def _by_values(count: Counter[bytes]) -> Counter[int]:
    values: Counter[int] = Counter()
    for form, lines in count.items():
        values[_values(form)] += lines
    return values


def _values(form: bytes) -> int:
    return len(_EXPONENT.sub(b"", form).split())


def _columns(form: bytes) -> list[tuple[int, bytes]]:
    """Return where the numbers of a line end, and the form of each."""
    return [(found.end(), found[0]) for found in _TOKEN.finditer(form)]


def _alike(one: bytes, model: bytes) -> bool:
    """Return whether a number is printed as another: the same decimals, or no more where there are exponents."""
    if one == model or (one and not one.strip(b"x")):
        return True
    if _NUMBER.fullmatch(one) is None:
        return False
    mantissa, _, exponent = one.replace(b" 000", b"e 000").partition(b"e")
    (whole, point, decimals), power = mantissa.partition(b"."), model.partition(b"e")[2]
    digits, dot, behind = model.partition(b"e")[0].partition(b".")
    if not power:
        return not exponent and point == dot and len(decimals) == len(behind)
    if not exponent:  # no lost character makes such a number
        return True
    signed = exponent.startswith(b" ") == power.startswith(b" ")
    return signed and whole == digits and len(decimals) <= len(behind)


def _aligned(one: bytes, model: bytes) -> bool:
    """Return whether a number is one, whatever the other is; that it ends in the same column is known."""
    return _NUMBER.fullmatch(one) is not None
