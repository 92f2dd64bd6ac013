"""Numbers, and values with commas, for argparse's `type`: wrong ones are refused in the words that were typed."""

from __future__ import annotations

import argparse
import math


def words(text: str) -> tuple[str, ...]:
    """Words such as `a,b`, each once; at least one."""
    found = tuple(dict.fromkeys(word.strip() for word in text.split(",") if word.strip()))
    if not found:
        raise argparse.ArgumentTypeError(f"expected a list such as a,b, got '{text}'")
    return found


def above_zero(text: str) -> float:
    """A finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"expected a number above 0, got '{text}'")
    return value


def numbers(text: str) -> tuple[float, ...]:
    """Finite numbers above 0, such as `30,7.5`."""
    return tuple(above_zero(word) for word in words(text))


def count(text: str) -> int:
    """A whole number of 1 or more."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number of 1 or more, got '{text}'")
    return int(text)


def counts(text: str) -> tuple[int, ...]:
    """Whole numbers of 1 or more, such as `1,2,4`."""
    return tuple(count(word) for word in words(text))


def wholes(text: str) -> tuple[int, ...]:
    """Whole numbers, such as `32,128,0`."""
    found = words(text)
    if not all(word.isdecimal() for word in found):
        raise argparse.ArgumentTypeError(f"expected whole numbers such as 32,128,0, got '{text}'")
    return tuple(map(int, found))
