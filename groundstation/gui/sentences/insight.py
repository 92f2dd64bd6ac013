"""Sentences about what a plan covers, why not more, and how plans compare."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "minimum distance (m)"),
    QT_TRANSLATE_NOOP("Sentences", "section step (degrees)"),
    QT_TRANSLATE_NOOP("Sentences", "whole panels only"),
    QT_TRANSLATE_NOOP("Sentences", "largest distance (m)"),
    QT_TRANSLATE_NOOP("Sentences", "{0} was made for other constraints ({1}); what it states may differ"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the cameras differ: each plan is seen with its own, what can be covered is that of the first",
    ),
    QT_TRANSLATE_NOOP("Sentences", "inside {0}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m too close to {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} degrees above what the camera sees with the gimbal at its limit"),
    QT_TRANSLATE_NOOP("Sentences", "{0} degrees below what the camera sees with the gimbal at its limit"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m below the lowest flight allowed"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m above the ceiling of the airspace"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m beyond the sides of the airspace"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m too far away for the largest distance or pixel size allowed"),
    QT_TRANSLATE_NOOP("Sentences", "below the ground"),
    QT_TRANSLATE_NOOP("Sentences", "hidden by {0}"),
    QT_TRANSLATE_NOOP("Sentences", "no way to it was found from home"),
    QT_TRANSLATE_NOOP("Sentences", "the building"),
    QT_TRANSLATE_NOOP("Sentences", "no-fly volume"),
    QT_TRANSLATE_NOOP("Sentences", "expected two plans or more to compare, got {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this plan was made for site '{0}', the site here is '{1}'; compare plans of one site",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this plan was made for site '{0}', the site here is '{1}' at another origin; compare plans of one site",
    ),
    QT_TRANSLATE_NOOP("Sentences", "this plan is named twice; name each plan once"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected a plan file, found a mission file, and the first plan does not name an aircraft of the catalogue "
        "to read it for; make a plan of it first ('import' with --profile)",
    ),
)
