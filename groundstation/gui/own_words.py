"""What planning, missions and services say, in the window's language and units.

They make English, metric sentences, which the command line prints as they are. The window recognises them by their
templates (`groundstation.gui.sentences`) and says them again.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from PySide6.QtCore import QCoreApplication

from groundstation.gui.sentences import sentence_tables
from groundstation.services.sentences import Phrasebook
from groundstation.services.units import UnitSystem
from planning.findings import Finding


@cache
def phrasebook() -> Phrasebook:
    """All templates; read when the first sentence is told."""
    return Phrasebook(template for table in sentence_tables().values() for template in table)


def own_words(text: str, units: UnitSystem) -> str:
    """A message, stage or name from below in the user's language and units; as it is where it is not known."""
    return phrasebook().retold(text, _translated, units)


def finding_in_own_words(finding: Finding, units: UnitSystem) -> Finding:
    """A finding whose message and place are in the user's language and units; value and limit stay metric."""
    return replace(finding, message=own_words(finding.message, units), place=own_words(finding.place, units))


def _translated(template: str) -> str:
    return QCoreApplication.translate("Sentences", template)
