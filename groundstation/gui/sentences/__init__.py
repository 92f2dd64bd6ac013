"""Templates of the sentences that the parts without Qt make, for Qt Linguist and to recognise them by.

One module for each field, found by itself; `groundstation.services.sentences` says what fields a template has.
"""

from __future__ import annotations

import importlib
import pkgutil


def sentence_tables() -> dict[str, tuple[str, ...]]:
    """Templates of each module here, by its name."""
    names = [module.name for module in pkgutil.iter_modules(__path__)]
    return {name: importlib.import_module(f"{__name__}.{name}").SENTENCES for name in names}
