"""Text that is not UTF-8: what it is instead, and what to type."""

from __future__ import annotations

from pathlib import Path

_TEXT = frozenset(range(0x20, 0x100)) - frozenset(range(0x7F, 0x80)) | {0x09, 0x0A, 0x0C, 0x0D}
_UTF16 = {b"\xff\xfe": "UTF-16LE", b"\xfe\xff": "UTF-16BE"}


def not_utf8(path: Path, content: bytes) -> str | None:
    """Return what is wrong with the encoding of a text file, and how to mend it; None where it is UTF-8, or no text.

    Parameters
    ----------
    path : Path
        The file, for the message.
    content : bytes
        What is in it.
    """
    if content[:2] in _UTF16 and _is_text_in_utf16(content):
        return _message(path, "it is written in UTF-16", _UTF16[content[:2]])
    try:
        content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if not _TEXT.issuperset(content):
            return None
        line = content[: error.start].count(b"\n") + 1
        character = content[error.start : error.start + 1].decode("cp1252", errors="replace")
        what = f"line {line} holds {character!r} in another encoding, probably Latin-1 (Windows-1252)"
        return _message(path, what, "WINDOWS-1252")
    return None


def _is_text_in_utf16(content: bytes) -> bool:
    try:
        text = content.decode("utf-16")
    except UnicodeDecodeError:
        return False
    return all(character.isprintable() or character.isspace() for character in text) and "\n" in text


def _message(path: Path, what: str, encoding: str) -> str:
    target = f"{path.stem}_utf8{path.suffix}"
    return (
        f"{path}: not UTF-8: {what}; save it as UTF-8 in the editor, or type "
        f"iconv -f {encoding} -t UTF-8 {path.name} > {target}"
    )
