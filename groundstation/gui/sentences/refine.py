"""What is said of poses that are refined: stages, findings and errors."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "finding features"),
    QT_TRANSLATE_NOOP("Sentences", "matching photos"),
    QT_TRANSLATE_NOOP("Sentences", "building the model"),
    QT_TRANSLATE_NOOP("Sentences", "adjusting all rays"),
    QT_TRANSLATE_NOOP("Sentences", "estimating accuracy"),
    QT_TRANSLATE_NOOP("Sentences", "inverting normal equations"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of {1} photos have refined poses and lenses, moved by {2} m and turned by {3} degrees in the middle, by"
        " {4} m and {5} degrees at most; image points are off by {6} px",
    ),
    QT_TRANSLATE_NOOP("Sentences", "none of the {0} photos has a refined pose; all keep their own"),
    QT_TRANSLATE_NOOP(
        "Sentences", "{0} of {1} photos found no place in the model, the first {2}; they keep their own poses"
    ),
    QT_TRANSLATE_NOOP("Sentences", "nothing fixes where the refined model lies; the photo keeps its own pose"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its refined position is {0} m from its own, which is {1} standard deviations; the photo keeps its own pose",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its refined angles are {0} degrees from its own, which is {1} standard deviations more than for the others;"
        " the photo keeps its own pose",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "its refined pose is known {0} times worse than its own; the photo keeps its own pose"
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} refined poses were refused, so none is used: all photos keep their own"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the angles of all photos are off by {0} degrees in common, so it is the compass or the gimbal; refined poses"
        " are free of it",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the photos are linked with each other too closely for the accuracy of each pose to be computed; all count as"
        " equally good",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the photos were taken along one line: the turn of the model about it is that of the cameras' angles",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the positions of {0} of {1} photos contradict the model and were not used"),
    QT_TRANSLATE_NOOP("Sentences", "refining cameras needs at least {0} photos with a pose, got {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "refining cameras needs pycolmap, which is not installed; install it with: pip install 'reflight[colmap]', or"
        " go on with the poses that the photos have",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the {0} photos do not fit together: expected features that at least {1} of them share; photos must overlap by"
        " two thirds, and show more than mirroring glass",
    ),
    QT_TRANSLATE_NOOP("Sentences", "COLMAP stopped while {0}: {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "COLMAP model: {0} of its {1} images are among the {2} photos with a pose; expected at least 3; are the names"
        " in the model the paths below the folder of photos?",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "COLMAP model: all photos were taken in one place, so that the model gets no scale from them"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "COLMAP model: the photos' positions contradict the model; are they photos of this model?"
    ),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written ({0}); name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "is a whole drive, and refined poses cannot lie beside it; copy the photos first"),
    QT_TRANSLATE_NOOP("Sentences", "expected a folder to write into, found none"),
    QT_TRANSLATE_NOOP("Sentences", "is write-protected; name another folder for refined poses"),
    QT_TRANSLATE_NOOP("Sentences", "holds something other than refined poses; name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; remove the folder {1} to have the poses refined again"),
    QT_TRANSLATE_NOOP("Sentences", "names other photos than the model beside it"),
    QT_TRANSLATE_NOOP("Sentences", "photo '{0}': expected a covariance of 6 rows of 6 numbers"),
    QT_TRANSLATE_NOOP("Sentences", "photo '{0}': expected a covariance, got a matrix that is none"),
)
