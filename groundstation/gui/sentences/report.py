"""Sentences of the flight report: what was measured on a flight, against its limits."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "there is no record of any flight"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this flight is none of the plan's sorties: no photo and no view of them is near its track",
    ),
    QT_TRANSLATE_NOOP("Sentences", "recorded as sortie {0}, but it flew sortie {1}; it counts as what it flew"),
    QT_TRANSLATE_NOOP("Sentences", "record {0}"),
    QT_TRANSLATE_NOOP("Sentences", "look through the photos before planning a top-up flight"),
    QT_TRANSLATE_NOOP("Sentences", "plan a top-up flight for them"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} views have no photo that is known of: {2}; {3}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} views has no photo that is known of: {2}; {3}"),
    QT_TRANSLATE_NOOP("Sentences", "all {0} views have a photo"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "1 photo belongs to no view, or to one that has a better photo; it counts for coverage, too",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} photos belong to no view, or to one that has a better photo; they count for coverage, too",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the camera counted {0} photos whose reports did not arrive; {1} of them are of views that are "
        "known; the autopilot's own log (.BIN, .ulg) tells of all",
    ),
    QT_TRANSLATE_NOOP("Sentences", "position error at the shutter"),
    QT_TRANSLATE_NOOP("Sentences", "heading error at the shutter"),
    QT_TRANSLATE_NOOP("Sentences", "gimbal pitch error"),
    QT_TRANSLATE_NOOP("Sentences", "motion blur"),
    QT_TRANSLATE_NOOP("Sentences", "; coverage is counted as if they looked as planned"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} of {1} of {2} photos is not known{3}"),
    QT_TRANSLATE_NOOP("Sentences", "fly with RTK, hover longer, or in less wind"),
    QT_TRANSLATE_NOOP("Sentences", "hover longer, or fly in less wind"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} photos are over it; {2}"),
    QT_TRANSLATE_NOOP("Sentences", "largest {0}"),
    QT_TRANSLATE_NOOP("Sentences", "sections covered, {0} where {1} were planned"),
    QT_TRANSLATE_NOOP("Sentences", "plan a top-up flight"),
    QT_TRANSLATE_NOOP("Sentences", "{0} panels of the plan are on no photo, the first is '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "the panel '{0}' of the plan is on no photo"),
    QT_TRANSLATE_NOOP("Sentences", "the distance kept is not known"),
    QT_TRANSLATE_NOOP("Sentences", "smallest distance flown, {0} s after the start"),
    QT_TRANSLATE_NOOP("Sentences", "see where, and keep further away"),
    QT_TRANSLATE_NOOP("Sentences", "difference between the {0} s flown and the {1} s predicted"),
    QT_TRANSLATE_NOOP("Sentences", "check the speeds and hover times of the aircraft's profile"),
    QT_TRANSLATE_NOOP("Sentences", "battery left at the end, {0} used"),
    QT_TRANSLATE_NOOP("Sentences", " where {0} was predicted"),
    QT_TRANSLATE_NOOP("Sentences", "lower the endurance of the aircraft's profile"),
)
