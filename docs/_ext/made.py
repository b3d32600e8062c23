"""Parts of a page that are made of what they describe, kept on the page for those who read it in the repository.

``<!-- made: NAME -->`` stands where the part of that name is put when the site is built. Where ``<!-- end made -->``
follows, the part stands between the two, as it was last made: ``python docs/_ext/commands.py --refresh PAGE`` renews
it, and a test compares it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

Makers = Mapping[str, Callable[[], str]]

PART = re.compile(
    r"^<!-- made: (?P<name>[^\n]*) -->\n(?P<kept>(?:(?!^<!-- made: )[^\n]*\n)*?^<!-- end made -->\n)?",
    flags=re.MULTILINE,
)


def inserted(text: str, makers: Makers) -> str:
    """Return a page with what is made in place of each part."""
    return PART.sub(lambda found: makers[found["name"]]().rstrip("\n") + "\n", text)


def renewed(text: str, makers: Makers) -> str:
    """Return a page whose kept parts are as they are made now."""

    def one(found: re.Match[str]) -> str:
        if found["kept"] is None:
            return found[0]
        made = makers[found["name"]]().strip("\n")
        return f"<!-- made: {found['name']} -->\n\n{made}\n\n<!-- end made -->\n"

    return PART.sub(one, text)
