"""Sealed truths: a commitment that can be published first and checked afterwards."""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.errors import InputError

SALT_BYTES = 16


@dataclass(frozen=True)
class Seal:
    """A sealed statement.

    Parameters
    ----------
    statement : str
        Canonical JSON of what is sealed.
    salt : str
        128 random bits, hexadecimal.
    """

    statement: str
    salt: str

    @property
    def commitment(self) -> str:
        """SHA-256 of salt and statement, hexadecimal: what is published beforehand."""
        return hashlib.sha256(bytes.fromhex(self.salt) + self.statement.encode()).hexdigest()


def seal(content: Mapping[str, Any]) -> Seal:
    """Seal a statement with a fresh salt from the operating system.

    Parameters
    ----------
    content : mapping
        What JSON can carry.

    Returns
    -------
    Seal
        Keep it secret, publish ``commitment``.
    """
    statement = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return Seal(statement, secrets.token_hex(SALT_BYTES))


def open_seal(sealed: Seal, commitment: str) -> dict[str, Any]:
    """Check a statement against the commitment published before, and return it.

    Parameters
    ----------
    sealed : Seal
        Statement and salt.
    commitment : str
        What was published, hexadecimal.

    Returns
    -------
    dict
        The statement.

    Raises
    ------
    InputError
        If the salt is not 128 bits or the statement is not the one that was sealed.
    """
    try:
        salt = bytes.fromhex(sealed.salt)
    except ValueError as error:
        raise InputError(f"the seal's salt {sealed.salt!r} is not hexadecimal; it was changed") from error
    if len(salt) != SALT_BYTES:
        raise InputError(f"the seal's salt has {8 * len(salt)} bits, not {8 * SALT_BYTES}; it was changed")
    if not hmac.compare_digest(sealed.commitment, commitment):
        raise InputError(
            f"the sealed statement gives {sealed.commitment}, the published commitment is {commitment}; "
            "statement, salt or commitment were changed after sealing"
        )
    content: dict[str, Any] = json.loads(sealed.statement)
    return content
