"""IFC GlobalIds: 128 bits in 22 characters, the keys of objects and records."""

from __future__ import annotations

import re
import uuid

from planning.base.errors import InputError
from planning.base.messages import say

ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$"
"""Digits of the base 64 that IFC has of its own (buildingSMART, implementation guide on GUIDs)."""

LENGTH = 22

_PAIRS = tuple(first + second for first in ALPHABET for second in ALPHABET)
_FORM = re.compile(r"[0-3][0-9A-Za-z_$]{21}")
_NAMESPACE = uuid.uuid5(uuid.NAMESPACE_URL, "urn:reflight:objects")


def is_global_id(text: str) -> bool:
    """Whether a text is an IFC GlobalId: 22 characters of the alphabet, the first of 0 to 3 (132 bits hold 128)."""
    return _FORM.fullmatch(text) is not None


def check_global_id(text: str, field: str) -> None:
    """Refuse what is no GlobalId.

    Raises
    ------
    InputError
        It is none.
    """
    if not is_global_id(text):
        raise InputError(say("expected an IFC GlobalId ({} characters), got '{}'", LENGTH, text[:40], place=field))


def compressed(number: uuid.UUID) -> str:
    """GlobalId of a UUID."""
    value, pairs = number.int, []
    for _ in range(LENGTH // 2):
        value, pair = divmod(value, len(_PAIRS))
        pairs.append(_PAIRS[pair])
    return "".join(reversed(pairs))


def global_id_of(site_name: str, name: str) -> str:
    """GlobalId of an object that has none of its own: the same for the same two names, always.

    Parameters
    ----------
    name
        Of the object, unique on the site.
    """
    # The length keeps ("a", "bc") and ("ab", "c") apart.
    return compressed(uuid.uuid5(_NAMESPACE, f"{len(site_name)}:{site_name}{name}"))


def new_global_id() -> str:
    """GlobalId that is random."""
    return compressed(uuid.uuid4())
