"""What is said of photos and of the panels found in them: stages, findings and errors."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this site has no building mesh, and panels are found on one; import the coarse model of the building",
    ),
    QT_TRANSLATE_NOOP("Sentences", "none of the photos says where it was taken, so that panels cannot be put into 3-D"),
    QT_TRANSLATE_NOOP("Sentences", "solving facades"),
    QT_TRANSLATE_NOOP("Sentences", "rendering"),
    QT_TRANSLATE_NOOP("Sentences", "trying scales"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a line can be moved as far as its neighbours and the edge of the picture; remove the line that is in"
        " the way first",
    ),
    QT_TRANSLATE_NOOP("Sentences", "there is a line already; point at a place between two lines, or beyond the last"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a facade needs two lines in each direction at least; add another line before this one goes",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no panel is left: put one back before these panels are used"),
    QT_TRANSLATE_NOOP("Sentences", "the site has no panels yet, so nothing is said of what the photos show of them"),
    QT_TRANSLATE_NOOP("Sentences", "reading photos"),
    QT_TRANSLATE_NOOP("Sentences", "none of its {0} photos can be read; the first: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the file has no end, so that a part of the picture is missing"),
    QT_TRANSLATE_NOOP("Sentences", "expected a folder of photos, found a file"),
    QT_TRANSLATE_NOOP("Sentences", "expected a folder of photos, found nothing"),
    QT_TRANSLATE_NOOP("Sentences", "holds no .jpg photo; name the folder that was copied from the camera's card"),
    QT_TRANSLATE_NOOP("Sentences", "is no JPEG file; only .jpg photos as the camera wrote them can be read"),
    QT_TRANSLATE_NOOP("Sentences", "the JPEG file holds no picture; copy it from the card again"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "claims to be a picture of {0} x {1} pixels, so there is none in it; copy it from the card again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the JPEG header has more than {0} parts; refused as hostile"),
    QT_TRANSLATE_NOOP("Sentences", "the header of the JPEG file is damaged; copy it from the card again"),
    QT_TRANSLATE_NOOP("Sentences", "the file ends in its header; copy it from the card again"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the photos were taken {0} km from the site '{1}'; expected at most {2} km; are they the right "
        "photos, and the right site?",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} photos were taken far from the site and are left out"),
    QT_TRANSLATE_NOOP("Sentences", "above take-off"),
    QT_TRANSLATE_NOOP("Sentences", "above sea level or ellipsoid"),
    QT_TRANSLATE_NOOP("Sentences", "no photo says its height {0}; choose the other way of counting heights"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} photos do not say their height {2}; theirs is counted the other way"),
    QT_TRANSLATE_NOOP("Sentences", "absolute heights"),
    QT_TRANSLATE_NOOP("Sentences", "heights above take-off"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "by their {0} the photos would lie {1} m higher: the site's own height, the receiver, or the place of"
        " take-off is off by that",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "by their {0} the photos would lie {1} m lower: the site's own height, the receiver, or the place of "
        "take-off is off by that",
    ),
    QT_TRANSLATE_NOOP("Sentences", "EXIF and XMP of a photo give positions {0} m apart; EXIF's are taken"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "RTK was not fixed in {0} of {1} photos: their positions are good to decimetres or metres",
    ),
    QT_TRANSLATE_NOOP("Sentences", "heights are counted as asked for: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "heights are those above the ellipsoid, because RTK was fixed in all photos"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "heights are absolute ones, good to some metres: the photos do not say those above take-off",
    ),
    QT_TRANSLATE_NOOP("Sentences", "because RTK was fixed in only {0} of {1} photos"),
    QT_TRANSLATE_NOOP("Sentences", "heights are those above take-off, counted from the site's home, {0}"),
    QT_TRANSLATE_NOOP("Sentences", "no line of a grid was found in any photo of this facade"),
    QT_TRANSLATE_NOOP("Sentences", "its pose was moved until the facade fell out of sight"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "none of the {0} photos shows an upright facade of the coarse model; do poses and model belong to the"
        " same origin?",
    ),
    QT_TRANSLATE_NOOP("Sentences", "finding panels"),
    QT_TRANSLATE_NOOP("Sentences", "a facade was left out: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "a wall with {0} panel was left out"),
    QT_TRANSLATE_NOOP("Sentences", "inclined lines"),
    QT_TRANSLATE_NOOP("Sentences", "edge pixels on one line"),
    QT_TRANSLATE_NOOP("Sentences", "no inclined line has edges enough for a profile through three panes"),
    QT_TRANSLATE_NOOP("Sentences", "{0} inclined lines have edges enough for a profile through three panes"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of {1} panels have more than four corners; a site's panels have four, so that the largest "
        "four-cornered part of each is kept",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "panels repeat every {0} m, and a photo may lie {1} m off (one standard deviation), so that the facade may"
        " stand a panel off, or photos were matched a panel apart; refine the poses, or compare with a measured corner",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no grid of panels was found on any facade; choose sharper photos taken from the front",
    ),
    QT_TRANSLATE_NOOP("Sentences", "facade {0}: no photo shows a grid with at least one panel"),
    QT_TRANSLATE_NOOP("Sentences", "coverage of the photos"),
    QT_TRANSLATE_NOOP("Sentences", "no photo shows panel '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of the {1} sections that the plan promised are on no photo"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be read any more ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "the file was cut off, so that part of the picture is missing; copy it again"),
    QT_TRANSLATE_NOOP("Sentences", "the picture cannot be decoded ({0}); copy the file again"),
    QT_TRANSLATE_NOOP("Sentences", "the picture cannot be decoded; copy the file again"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected a picture of {0} x {1} pixels, as the header says, got {2} x {3}; the file is damaged: copy it again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "dewarp data"),
    QT_TRANSLATE_NOOP("Sentences", "calibrated focal length"),
    QT_TRANSLATE_NOOP("Sentences", "focal length and catalogue sensor"),
    QT_TRANSLATE_NOOP("Sentences", "35 mm equivalent"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "photos of other cameras are left out ({0}); choose another camera to use those instead",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no photo can be given a camera pose ({0}); {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "use the files as the camera wrote them: programs that edit, send or share photos often take that out",
    ),
    QT_TRANSLATE_NOOP("Sentences", "a position"),
    QT_TRANSLATE_NOOP("Sentences", "a height"),
    QT_TRANSLATE_NOOP("Sentences", "where the camera looked"),
    QT_TRANSLATE_NOOP("Sentences", "a focal length"),
    QT_TRANSLATE_NOOP("Sentences", "{0} without {1}"),
    QT_TRANSLATE_NOOP("Sentences", "there are none"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} photos do not say {2} and get no pose, the first {3}; {4}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} ({1} photos)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the distortion of the lens is not known for {0} of {1} photos: straight lines may be bent by tens of"
        " pixels near the edges; refine the cameras, or use photos with dewarp data",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the {0} of {1} photos is of another picture size and not used: it gives a focal length far from that"
        " of the 35 mm equivalent; {2}",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} photos are marked to be shown turned; pixels are counted in the pictures as they are stored",
    ),
    QT_TRANSLATE_NOOP("Sentences", "shows the same as {0}: from the same place, in the same direction"),
    QT_TRANSLATE_NOOP("Sentences", "looks like {0}; nothing says where they were taken"),
    QT_TRANSLATE_NOOP("Sentences", "checking photos"),
    QT_TRANSLATE_NOOP("Sentences", "measured on its edges"),
    QT_TRANSLATE_NOOP("Sentences", "by speed, exposure and distance; there are too few edges to measure it"),
    QT_TRANSLATE_NOOP("Sentences", "is blurred by {0} px ({1}), more than {2} px; take it again, slower"),
    QT_TRANSLATE_NOOP("Sentences", "{0} % of the picture are {1}, more than {2} %; expose {3}"),
    QT_TRANSLATE_NOOP("Sentences", "shows too few edges ({0}) to tell whether it is sharp"),
    QT_TRANSLATE_NOOP("Sentences", "a surface needs at least {0} points of the coarse model, found {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the points of the coarse model lie on a line: they do not make a surface"),
    QT_TRANSLATE_NOOP("Sentences", "looking for facades"),
    QT_TRANSLATE_NOOP("Sentences", "casting rays"),
    QT_TRANSLATE_NOOP("Sentences", "the photo does not show this facade from its front"),
    QT_TRANSLATE_NOOP("Sentences", "the photo shows no area of this facade"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photos searched together showed no more than each by itself"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its lines were found in {0} photos together, which were moved onto one another by up to {1} px",
    ),
    QT_TRANSLATE_NOOP("Sentences", "find lines"),
    QT_TRANSLATE_NOOP("Sentences", "compare rows"),
    QT_TRANSLATE_NOOP("Sentences", "refine lines"),
    QT_TRANSLATE_NOOP("Sentences", "find vanishing points"),
    QT_TRANSLATE_NOOP("Sentences", "find facades"),
    QT_TRANSLATE_NOOP("Sentences", "straighten"),
    QT_TRANSLATE_NOOP("Sentences", "fuse views"),
)
