"""Texts as a search compares them, so that a word is found whichever way a keyboard can write it."""

from __future__ import annotations

import re
import unicodedata

_MARKS = re.compile("[\u0300-\u036f]")
"""Accents, dots and rings of Latin, Greek and Cyrillic letters."""


def folded(text: str) -> str:
    """Text without case and accents, ligatures and ß as the letters that they stand for: “Weiß” and “WEISS” are one.

    Letters come apart by Unicode's compatibility decomposition (NFKD) before their marks are dropped.
    """
    if text.isascii():
        return text.casefold()
    return _MARKS.sub("", unicodedata.normalize("NFKD", text)).casefold()
