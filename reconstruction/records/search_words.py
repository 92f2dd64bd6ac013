"""Words of users for the search index: nothing in them can be taken for its query language."""

from __future__ import annotations

import re

KIND_BITS, FIELD_BITS = 4, 4
"""Of a text's number in the index, below the row's: which kind of entry, which of its fields."""

OBJECT_CODE = 0
"""Kind of the names of objects."""

MAX_QUERY = 500
"""Characters of a query that are looked at."""

MAX_QUERY_WORDS = 16

# Scripts without blanks between words: every character is a word, and what is searched a phrase of them.
_WITHOUT_BLANKS = re.compile("([\u0e00-\u0eff\u3040-\u30ff\u3400-\u4dbf\u4e00-\u9fff\uac00-\ud7af\uf900-\ufaff])")
_WORD = re.compile(r"[^\W_]+")


def indexed_text(text: str) -> str:
    """Text as the index takes it."""
    text = text.replace("_", " ")
    return text if text.isascii() else _WITHOUT_BLANKS.sub(r" \1 ", text)


def query_of(words: str) -> str | None:
    """Query for texts that hold all words, the last letters of each left open; None without a word.

    Only letters and digits of the user's get into it, each run of them in quotes.
    """
    found = []
    for word in _WORD.findall(words[:MAX_QUERY].replace("_", " "))[:MAX_QUERY_WORDS]:
        found.append(f'"{" ".join(indexed_text(word).split())}"*')
    return " ".join(found) or None
