"""Seals: what was sealed can be proved, what was changed is found out."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition.errors import InputError
from modalkit.blind.seal import open_seal, seal

numbers = st.floats(allow_nan=False, allow_infinity=False)
contents = st.dictionaries(st.text(max_size=8), st.one_of(numbers, st.text(max_size=8), st.lists(numbers)))


@given(contents)
def test_opens_to_what_was_sealed(content: dict[str, object]) -> None:
    sealed = seal(content)
    assert open_seal(sealed, sealed.commitment) == content
    assert len(bytes.fromhex(sealed.salt)) == 16
    digest = hashlib.sha256(bytes.fromhex(sealed.salt) + sealed.statement.encode()).hexdigest()
    assert sealed.commitment == digest


def test_same_truth_twice_cannot_be_recognised() -> None:
    commitments = {seal({"effect": "E"}).commitment for _ in range(50)}
    assert len(commitments) == 50


def test_tampering_is_found() -> None:
    sealed = seal({"effect": "E", "factor": 1.1})
    forged = replace(sealed, statement=sealed.statement.replace("1.1", "1.2"))
    with pytest.raises(InputError, match="changed after sealing"):
        open_seal(forged, sealed.commitment)
    resalted = replace(sealed, salt="00" * 16)
    with pytest.raises(InputError, match="changed after sealing"):
        open_seal(resalted, sealed.commitment)


def test_a_moved_border_between_salt_and_statement_is_found() -> None:
    sealed = seal({"effect": "E"})
    head, tail = sealed.statement[:1], sealed.statement[1:]
    shifted = replace(sealed, salt=sealed.salt + head.encode().hex(), statement=tail)
    assert shifted.commitment == sealed.commitment
    with pytest.raises(InputError, match="136 bits"):
        open_seal(shifted, sealed.commitment)
    with pytest.raises(InputError, match="not hexadecimal"):
        open_seal(replace(sealed, salt="salt"), sealed.commitment)
