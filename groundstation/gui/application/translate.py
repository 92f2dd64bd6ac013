"""What planning, missions and services say, in the window's language and units.

Their messages name commands and options where something is to be typed: the window says its own buttons and fields.
"""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QCoreApplication

from groundstation.gui.application.words import IN_WINDOW, OPTION_FIELDS
from groundstation.services.messages import in_window_words, told
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding


def translated(text: str, units: UnitSystem) -> str:
    """A message, stage or name from below in the user's language and units; as it is where it is not known."""
    return with_fields(told(text, _in_language, units))


def with_fields(text: str) -> str:
    """A text with labels of fields in place of the command line's options."""
    if "--" not in text:
        return text
    labels = {option: QCoreApplication.translate(*label) for option, label in OPTION_FIELDS.items()}
    return in_window_words(text, labels, QCoreApplication.translate("Words", "“{0}”"))


def translated_finding(finding: Finding, units: UnitSystem) -> Finding:
    """A finding whose message and place are in the user's language and units; value and limit stay metric."""
    return replace(finding, message=translated(finding.message, units), place=translated(finding.place, units))


def _in_language(template: str) -> str:
    return QCoreApplication.translate("Sentences", IN_WINDOW.get(template, template))
