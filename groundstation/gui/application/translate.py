"""What planning, missions and services say, in the window's language and units.

They make English, metric sentences, which the command line prints as they are. The window recognises them by their
templates (`groundstation.gui.sentences`) and says them again, with its own buttons and fields in place of commands and
options.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from PySide6.QtCore import QCoreApplication

from groundstation.gui.sentences import sentence_tables
from groundstation.gui.sentences.window import IN_WINDOW, OPTION_FIELDS
from groundstation.services.sentences import Phrasebook
from groundstation.services.site.import_wording import in_window_words
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding
from planning.base.parameters import declared
from planning.parameters import PlanParameters


@cache
def phrasebook() -> Phrasebook:
    """All templates; read when the first sentence is told."""
    return Phrasebook(template for table in sentence_tables().values() for template in table)


def own_words(text: str, units: UnitSystem) -> str:
    """A message, stage or name from below in the user's language and units; as it is where it is not known."""
    return with_fields(phrasebook().retold(text, _translated, units))


def with_fields(text: str) -> str:
    """A text with labels of fields in place of the command line's options."""
    if "--" not in text:
        return text
    return in_window_words(
        text,
        {option: QCoreApplication.translate(*label) for option, label in field_labels().items()},
        QCoreApplication.translate("Words", "“{0}”"),
    )


@cache
def field_labels() -> dict[str, tuple[str, str]]:
    """Context and text of each field's label, by the option that says the same."""
    own = (each.parameter for each in declared(PlanParameters).values() if each.parameter.row)
    return {**OPTION_FIELDS, **{known.option: ("Parameters", known.label) for known in own}}


def finding_in_own_words(finding: Finding, units: UnitSystem) -> Finding:
    """A finding whose message and place are in the user's language and units; value and limit stay metric."""
    return replace(finding, message=own_words(finding.message, units), place=own_words(finding.place, units))


def _translated(template: str) -> str:
    return QCoreApplication.translate("Sentences", IN_WINDOW.get(template, template))
