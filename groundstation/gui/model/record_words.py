"""What kinds of records, their fields and choices are called."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

from reconstruction.records.entries import Attribute, Defect, Document, Inspection, Maintenance

KINDS: dict[type[Any], str] = {
    Attribute: QT_TRANSLATE_NOOP("Records", "Property"),
    Inspection: QT_TRANSLATE_NOOP("Records", "Inspection"),
    Defect: QT_TRANSLATE_NOOP("Records", "Defect"),
    Maintenance: QT_TRANSLATE_NOOP("Records", "Maintenance"),
    Document: QT_TRANSLATE_NOOP("Records", "Document"),
}

FIELDS: dict[str, str] = {
    "name": QT_TRANSLATE_NOOP("Records", "name"),
    "value": QT_TRANSLATE_NOOP("Records", "value"),
    "type": QT_TRANSLATE_NOOP("Records", "type"),
    "unit": QT_TRANSLATE_NOOP("Records", "unit"),
    "date": QT_TRANSLATE_NOOP("Records", "date"),
    "inspector": QT_TRANSLATE_NOOP("Records", "inspector"),
    "method": QT_TRANSLATE_NOOP("Records", "method"),
    "result": QT_TRANSLATE_NOOP("Records", "result"),
    "note": QT_TRANSLATE_NOOP("Records", "note"),
    "kind": QT_TRANSLATE_NOOP("Records", "kind"),
    "severity": QT_TRANSLATE_NOOP("Records", "severity"),
    "found_on": QT_TRANSLATE_NOOP("Records", "found on"),
    "u": QT_TRANSLATE_NOOP("Records", "from the left, 0 to 1"),
    "v": QT_TRANSLATE_NOOP("Records", "from below, 0 to 1"),
    "status": QT_TRANSLATE_NOOP("Records", "state"),
    "repaired_on": QT_TRANSLATE_NOOP("Records", "repaired on"),
    "work": QT_TRANSLATE_NOOP("Records", "work"),
    "done_by": QT_TRANSLATE_NOOP("Records", "done by"),
    "cost": QT_TRANSLATE_NOOP("Records", "cost"),
    "currency": QT_TRANSLATE_NOOP("Records", "currency"),
    "next_due": QT_TRANSLATE_NOOP("Records", "next due"),
    "title": QT_TRANSLATE_NOOP("Records", "title"),
    "place": QT_TRANSLATE_NOOP("Records", "address or file"),
    "material": QT_TRANSLATE_NOOP("Records", "material"),
    "maker": QT_TRANSLATE_NOOP("Records", "maker"),
    "product": QT_TRANSLATE_NOOP("Records", "product"),
    "coating": QT_TRANSLATE_NOOP("Records", "coating"),
    "thickness": QT_TRANSLATE_NOOP("Records", "thickness"),
    "installed_on": QT_TRANSLATE_NOOP("Records", "installed on"),
    "warranty_until": QT_TRANSLATE_NOOP("Records", "warranty until"),
    "width": QT_TRANSLATE_NOOP("Records", "width"),
    "height": QT_TRANSLATE_NOOP("Records", "height"),
}

CHOICES: dict[str, str] = {
    "open": QT_TRANSLATE_NOOP("Records", "open"),
    "repaired": QT_TRANSLATE_NOOP("Records", "repaired"),
    "text": QT_TRANSLATE_NOOP("Records", "text"),
    "number": QT_TRANSLATE_NOOP("Records", "number"),
    "yes/no": QT_TRANSLATE_NOOP("Records", "yes or no"),
    "True": QT_TRANSLATE_NOOP("Records", "yes"),
    "False": QT_TRANSLATE_NOOP("Records", "no"),
}


def kind_words(kind: type[Any]) -> str:
    """Of a class of records."""
    return QCoreApplication.translate("Records", KINDS[kind])


def field_words(name: str) -> str:
    """Of a field, or an attribute that every panel may have; others are called as their makers called them."""
    return QCoreApplication.translate("Records", FIELDS[name]) if name in FIELDS else name


def choice_words(name: str) -> str:
    """Of a choice."""
    if name in FIELDS and name not in CHOICES:
        return field_words(name)
    return QCoreApplication.translate("Records", CHOICES[name]) if name in CHOICES else name
