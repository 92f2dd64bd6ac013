"""Sentences about sites, records and the files that they are read from."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "expected one table with an aircraft and its camera, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "there is no aircraft profile '{0}'; known are: {1}; your own can be a .toml file"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be read ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "expected JSON in UTF-8, found other bytes at offset {0}"),
    QT_TRANSLATE_NOOP("Sentences", "not valid JSON, line 1: the file is empty"),
    QT_TRANSLATE_NOOP("Sentences", "not valid JSON, line {0}, column {1}: {2}"),
    QT_TRANSLATE_NOOP("Sentences", "nested too deeply for a file of ours"),
    QT_TRANSLATE_NOOP("Sentences", "holds a number with too many digits ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "expected a finite number, got NaN or Infinity"),
    QT_TRANSLATE_NOOP("Sentences", "format: expected '{0}', got {1}; is it the right file?"),
    QT_TRANSLATE_NOOP("Sentences", "not valid TOML ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "no such setting; known are: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written: there is no folder '{0}'; make it first"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written: this is a folder; name a file in it"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "not written: the name ends in {0}, and what would be in the file is {1}; name it so, or choose another format",
    ),
    QT_TRANSLATE_NOOP("Sentences", "would replace a {0} file by what is {1}; name another file"),
    QT_TRANSLATE_NOOP(
        "Sentences", "not written: the name ends in {0} as files do, and this is written as a folder; name one"
    ),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written: the file is write-protected; name another one"),
    QT_TRANSLATE_NOOP(
        "Sentences", "cannot be written: the folder '{0}' is write-protected; name a file in another one"
    ),
    QT_TRANSLATE_NOOP("Sentences", "would replace {0}, which it is made from; name another file"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "expected a mesh file ({0}), got '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "there is no such mesh file"),
    QT_TRANSLATE_NOOP("Sentences", "this mesh cannot be read ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "the mesh has no triangles (a point cloud cannot serve as a building)"),
    QT_TRANSLATE_NOOP("Sentences", "the mesh has coordinates that are not finite numbers"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mesh has a coordinate of {0} m; local ENU metres near the site's origin are expected. Shift it (site "
        "import does) before using it",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected a positive number, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected [lowest, highest] within -180 to 90, got [{0}, {1}]"),
    QT_TRANSLATE_NOOP("Sentences", "expected auto, on or off, got '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "expected more than the minimum distance {0:m}, got {1:m}"),
    QT_TRANSLATE_NOOP("Sentences", "expected a divisor of 90 from 1 to 90 degrees, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected 0 to below 1, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected 0 or more, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected a positive speed, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected a name, got an empty text"),
    QT_TRANSLATE_NOOP("Sentences", "expected (-180, 180], got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected -180 to 90, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected 0 <= covered <= reachable_upper_bound <= total, got {0}, {1}, {2}"),
    QT_TRANSLATE_NOOP("Sentences", "expected '{0}', got '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "expected unique ids, '{0}' occurs twice"),
    QT_TRANSLATE_NOOP("Sentences", "there is no viewpoint '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "there is no bundled site '{0}'; known are: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected finite metres, {0} is {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected local ENU metres within {0} m of the origin, {1} is {2:m} (projected coordinates such as UTM must "
        "be shifted to the site's origin first)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected -90 to 90, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected -180 to 180, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected -1000 to 10000, got {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "panel '{0}' has an area of {1} m2, so it has no normal; expected four corners in order around the pane",
    ),
    QT_TRANSLATE_NOOP("Sentences", "panel '{0}' is not flat, a corner lies {1} m off its mean plane; split it"),
    QT_TRANSLATE_NOOP("Sentences", "panel '{0}' is not convex or its corners are not in order around the pane"),
    QT_TRANSLATE_NOOP("Sentences", "obstacle '{0}': expected either mesh or box_enu_m, got both or neither"),
    QT_TRANSLATE_NOOP("Sentences", "obstacle '{0}' needs its minimum corner first, got {1:m} and {2:m}"),
    QT_TRANSLATE_NOOP("Sentences", "obstacle '{0}' is a mesh, not a box"),
    QT_TRANSLATE_NOOP("Sentences", "zone '{0}' needs at least 3 corners, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "zone '{0}' needs a ceiling above its floor ({1} m)"),
    QT_TRANSLATE_NOOP("Sentences", "zone '{0}' crosses itself or has no area"),
    QT_TRANSLATE_NOOP("Sentences", "the airspace is empty, {0} runs from {1} to {2} m"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected at least one panel, or a building_mesh on which panels can be found, got neither; add panels, or "
        "name the mesh of the building",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "site '{0}' has no panels yet: find them in photos ('panels' or the Photos tab), or draw them on the building "
        "(the Site tab, or 'site import' with --panel-grid)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there are no panels yet: find them in photos (Photos tab), or draw a panel grid on the building",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected unique panel ids, '{0}' occurs twice"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} obstacle meshes, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; mesh paths start from the folder of the site file"),
    QT_TRANSLATE_NOOP("Sentences", "no-fly zone"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "panels: a site without a building needs at least one panel; add the new ones first, then remove these",
    ),
    QT_TRANSLATE_NOOP("Sentences", "sea level"),
    QT_TRANSLATE_NOOP("Sentences", "expected the first value below the second, got {0} m and {1} m"),
    QT_TRANSLATE_NOOP("Sentences", "name: expected a name for the {0}, got an empty text"),
    QT_TRANSLATE_NOOP("Sentences", "name: there is a {0} '{1}' already; choose another name"),
    QT_TRANSLATE_NOOP("Sentences", "the airspace begins at {0} m, below the ground at {1} m; raise its floor"),
    QT_TRANSLATE_NOOP("Sentences", "home lies at {0} m, below the ground at {1} m; put it on the ground"),
    QT_TRANSLATE_NOOP("Sentences", "no-fly zone '{0}' lies outside the airspace, so it changes nothing"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "facade '{0}': there is no free airspace {1} to {2} m in front of its panels ({3}) from which they are seen; "
        "turn it to the other side, widen the airspace, or remove it",
    ),
    QT_TRANSLATE_NOOP("Sentences", "rally point"),
    QT_TRANSLATE_NOOP("Sentences", "aircraft can land at the rally points ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "rally point '{0}' {1}"),
    QT_TRANSLATE_NOOP("Sentences", "is not below or inside the airspace; move it, or widen the airspace"),
    QT_TRANSLATE_NOOP("Sentences", "lies inside a building or obstacle; move it outside"),
    QT_TRANSLATE_NOOP("Sentences", "lies in a no-fly volume, or below one; move it outside"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "has a landing column that comes within {0} m of the building or an obstacle, {1} m are required; move it away",
    ),
    QT_TRANSLATE_NOOP("Sentences", "rally point '{0}' lies at {1} m, below the ground at {2} m; put it on the ground"),
)
