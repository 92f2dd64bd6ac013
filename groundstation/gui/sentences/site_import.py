"""Sentences of the import of building models; options of the command line stay for `import_words`."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "which may be off by 1 m, in mountains by 2 m"),
    QT_TRANSLATE_NOOP("Sentences", "the point {0} has no position in {1}; is this the system the file is in?"),
    QT_TRANSLATE_NOOP("Sentences", "(east, north)"),
    QT_TRANSLATE_NOOP("Sentences", "(north, east)"),
    QT_TRANSLATE_NOOP("Sentences", "coordinates are read as {0}, as they fit; {1} itself lists {2}"),
    QT_TRANSLATE_NOOP("Sentences", " and as "),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the coordinates ({0}, {1}), read as {2}, lie far outside the area of use of {3}; name the right system with "
        "--crs",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no transformation to WGS 84 of known accuracy is installed; convert the file to a system on WGS 84 or "
        "ETRS89 first (a UTM zone, say)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "coordinates are in {0}"),
    QT_TRANSLATE_NOOP("Sentences", "; '{0}' is accurate to about {1} m, by which the whole site may be displaced"),
    QT_TRANSLATE_NOOP("Sentences", " (a finer one, {0} m, needs the grid {1})"),
    QT_TRANSLATE_NOOP("Sentences", "EGM96, here {0} m above the ellipsoid"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, stands in for the national geoid, {1}"),
    QT_TRANSLATE_NOOP("Sentences", "heights are taken above the ellipsoid, as you asked, not as {0}"),
    QT_TRANSLATE_NOOP("Sentences", "heights are above the geoid of {0}"),
    QT_TRANSLATE_NOOP("Sentences", "heights are in the system '{0}'; {1}"),
    QT_TRANSLATE_NOOP("Sentences", "heights are above the ellipsoid, as the system says"),
    QT_TRANSLATE_NOOP("Sentences", " in the unit of the other coordinates ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "heights are taken above the ellipsoid{0}, as you asked"),
    QT_TRANSLATE_NOOP("Sentences", "as you asked"),
    QT_TRANSLATE_NOOP("Sentences", "as the system has none of its own (see --height-reference)"),
    QT_TRANSLATE_NOOP("Sentences", "heights are taken above sea level{0}, {1}; {2}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "'{0}' is not a coordinate reference system known here; expected a code such as EPSG:25832, EPSG:7415 or "
        "EPSG:25832+7837",
    ),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' is a {1}; expected a projected or geographic system"),
    QT_TRANSLATE_NOOP("Sentences", "there is no building with surfaces in this file"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "other buildings in the file: {0} within reach of the airspace, kept as obstacles; {1} further away, left out",
    ),
    QT_TRANSLATE_NOOP("Sentences", "windows given as a shared prototype (implicit geometry), not read: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "there is no building '{0}'; there are {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the panel grid is on building '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "no building in the file has windows; '{0}' has the most surfaces"),
    QT_TRANSLATE_NOOP("Sentences", "the site is {0}"),
    QT_TRANSLATE_NOOP("Sentences", "; {0} further away, to be imported with --building ID"),
    QT_TRANSLATE_NOOP("Sentences", " (windows: {0})"),
    QT_TRANSLATE_NOOP("Sentences", "expected a CityGML file (root element CityModel), found '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "building {0}"),
    QT_TRANSLATE_NOOP("Sentences", "not valid XML ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "nested too deeply for a CityGML file"),
    QT_TRANSLATE_NOOP("Sentences", 'expected a CityJSON file (with "type": "CityJSON")'),
    QT_TRANSLATE_NOOP("Sentences", "expected CityJSON version {0}, got '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "this CityJSON file is broken ({0}: {1})"),
    QT_TRANSLATE_NOOP("Sentences", "this IFC file cannot be read ({0}); IFC 2x3, IFC 4 and IFC 4.3 are read"),
    QT_TRANSLATE_NOOP("Sentences", "this IFC file is broken ({0}: {1})"),
    QT_TRANSLATE_NOOP("Sentences", "windows: {0}; plates: {1}, of which glazed: {2}"),
    QT_TRANSLATE_NOOP("Sentences", "windows left out because they have no geometry: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "--deflection {0}: expected a positive length in metres"),
    QT_TRANSLATE_NOOP("Sentences", "no building element in this file has geometry"),
    QT_TRANSLATE_NOOP("Sentences", "expected an IFC file (STEP text that begins with ISO-10303-21)"),
    QT_TRANSLATE_NOOP("Sentences", "the file is cut off (END-ISO-10303-21 is missing); copy or export it again"),
    QT_TRANSLATE_NOOP("Sentences", "the map conversion is left aside ({0})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the map conversion names no coordinate reference system; give it with --crs EPSG:CODE",
    ),
    QT_TRANSLATE_NOOP("Sentences", "place and rotation from IfcMapConversion"),
    QT_TRANSLATE_NOOP("Sentences", "the scale of IfcMapConversion leaves out the change of units, which is put right"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "IfcMapConversion has the scale {0}, which is neither near 1 nor the change of units ({1}); give the place "
        "with --origin",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "place from latitude and longitude of IfcSite, which is often just the city that the BIM program assumes: "
        "check it, or give --origin",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "elevation of IfcSite ({0} m) is above sea level; EGM96, here {1} m above the ellipsoid, makes it "
        "ellipsoidal, to about 1 m",
    ),
    QT_TRANSLATE_NOOP("Sentences", "true north is {0} degrees counter-clockwise from the model's y axis"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "IfcSite lies at latitude {0}, longitude {1}, which is nowhere on earth; give --origin",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the geometry kernel crashed on this IFC file (status {0}), so something in it goes in circles or beyond all "
        "bounds; open and export it again in a BIM program",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no window of {0} is a pane that faces the open"),
    QT_TRANSLATE_NOOP("Sentences", "there are no windows"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0}, so the site has no panels yet: find them in photos ('panels' or the Photos tab), or draw them on the "
        "building (the Site tab, or --panel-grid)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected a file ending in {0}, got '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "there is no such file"),
    QT_TRANSLATE_NOOP("Sentences", "the building would be {0:m} x {1:m} x {2} m, at most {3} km are expected; {4}"),
    QT_TRANSLATE_NOOP("Sentences", "the model is {0:m} x {1:m} x {2} m, implausibly small for a building: {3}"),
    QT_TRANSLATE_NOOP("Sentences", "the model is {0:m} x {1:m} x {2} m, implausibly large for a building: {3}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the unit or the scale that the file states is wrong; put it right in the program that wrote it",
    ),
    QT_TRANSLATE_NOOP("Sentences", "if its unit is not what was read, {0}"),
    QT_TRANSLATE_NOOP("Sentences", "--units {0} makes it {1:m} x {2:m} x {3} m (factor {4})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no unit makes it plausible, so it is no model of true size; scale it in the program that wrote it",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "left out, because they are broken (such as outlines of fewer than three points) or not read: {0} ({1})",
    ),
    QT_TRANSLATE_NOOP("Sentences", "without an identifier"),
    QT_TRANSLATE_NOOP("Sentences", "building '{0}' has no surface with an area"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0}; where the coordinates are local ones, give --origin LAT,LON,HEIGHT (of their zero point)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "left out as strays, below the ground or far from everything else: {0} triangles, from {1} to {2} in "
        "the file's heights",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ground: z = {0} of the file, where the outer walls end, as there is no ground around the building in"
        " the file (--ground names another)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ground: z = {0} of the file, by the open ground along {1} % of the building's outline, which lies "
        "between {2} and {3} (--ground names another)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ground: along the building's outline it lies between z = {0} and {1} of the file; the highest is "
        "taken, so that heights above ground are safe on every side (--ground names another)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "ground: z = {0} of the file, its GroundSurface (--ground names another)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ground: the file holds windows alone, the lowest at z = {0}, which is taken; check it (--ground)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ground: the file's GroundSurface lies between z = {0} and {1}; the highest is taken, so that heights"
        " above ground are safe on every side (--ground names another)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "ground: z = {0} of the model, the zero of IfcSite (--ground names another)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file shows neither open ground around the building nor walls that reach down to it; its lowest "
        "surface is at z = {0}. Name the height of the ground in the file with --ground Z",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "two heights of the file may be the ground: {0}. Say which with --ground {1} or --ground {2}",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "z = {0}, where the building's foot is, and z = {1}, a deck all around its upper part",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "z = {0}, where its lowest outer walls end, and z = {1}, where others do (a cellar, a slope, a torn "
        "edge, or storeys that hang over)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "facades, by plane or smoothly curved surface: {0}, the one with most glass first (A: {1} panels, {2} m2)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "; with one panel only: {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} % of the building's surface does not close (gaps and overlaps in the model): the distance to it is kept "
        "all the same, but the space behind it does not count as solid",
    ),
    QT_TRANSLATE_NOOP("Sentences", "axes: {0} is up"),
    QT_TRANSLATE_NOOP("Sentences", " (glTF's rule)"),
    QT_TRANSLATE_NOOP("Sentences", "lengths are in {0} (--units)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "--units and --crs both say what the coordinates are in; the system of --crs has its own units",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file stores coordinates this far from zero in steps of {0} m (single precision), so the building's "
        "shape is that rough; export it again with a local offset",
    ),
    QT_TRANSLATE_NOOP("Sentences", "; check the corners, --units and --up, or allow more with --grid-tolerance"),
    QT_TRANSLATE_NOOP("Sentences", "expected 1 to {0} panels in all, got {1} rows and {2} columns"),
    QT_TRANSLATE_NOOP("Sentences", "the rectangle is {0} x {1} m, no facade; place its corners apart"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the angle at the lower left corner is {0} degrees; expected a rectangle, given by its lower left, lower "
        "right and upper left corner as seen from outside",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a gap of {0} m leaves no glass between the mullions: the grid's cells measure {1} x {2} m",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its panels lie {0} m from the building (median; nearest {1} m, allowed {2} m). In local metres the grid's "
        "middle is {3} and the building reaches from {4} to {5}",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of {1} panels look into the building, and their backs look out; name the corners as seen from outside "
        "(lower left, lower right, upper left)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of {1} panels of the grid see nothing of the open, as the mesh covers them: move the grid outwards, or "
        "they cannot be photographed with occlusion on",
    ),
    QT_TRANSLATE_NOOP("Sentences", "windows left out as slivers or without area"),
    QT_TRANSLATE_NOOP("Sentences", "windows left out as indoor ones, which see nothing of the open"),
    QT_TRANSLATE_NOOP("Sentences", "windows left out because another one shows the same pane"),
    QT_TRANSLATE_NOOP("Sentences", "windows that lie exactly on others, where both stay"),
    QT_TRANSLATE_NOOP("Sentences", "windows that are no quads, for which a rectangle of the same area stands in"),
    QT_TRANSLATE_NOOP("Sentences", "windows that the file has facing into the building, turned around"),
    QT_TRANSLATE_NOOP("Sentences", "windows open on both sides, taken to face away from the building"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} m in front of the panels the building hides {1} % of the directions (worst panel {2} %); their own "
        "frames and reveals hide {3} % (worst {4} %)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "--origin and --crs both say where the file is; give one of them"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file does not say where on earth it is; give --origin LAT,LON,HEIGHT (of its zero point) or --crs "
        "EPSG:CODE (of its coordinates)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the building lies {0} km from the point whose place the file gives, so its coordinates are projected ones; "
        "name their system with --crs EPSG:CODE",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the building would stand at an impossible place ({0}); check --crs and units"),
    QT_TRANSLATE_NOOP("Sentences", "its height is above the ellipsoid (--height-reference orthometric for sea level)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its height above sea level is {0} m above the ellipsoid (EGM96, good to about 1 m)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the file's zero point is at the origin you named"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file's coordinates lie up to {0} km from zero, so the origin you named is taken as the middle of the "
        "building's footprint, on the ground; if they are projected coordinates, --crs converts them exactly (grid "
        "north is not true north)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there is no place for home inside the airspace that is at least {0} m from every wall; widen it with "
        "--airspace-margin, or name a place with --home E,N,U",
    ),
    QT_TRANSLATE_NOOP("Sentences", "--airspace-margin, --floor and --ceiling leave no airspace: {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "airspace: {0} m around the building, from {1} to {2} m (--airspace-margin, --floor, --ceiling); no-fly "
        "zones and obstacles on site are yours to add",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "home: {0:m}, {1:m}, {2} m, on the ground in front of the largest facade, {3} m from the nearest wall (--home)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "home: {0:m}, {1:m}, {2} m, on the ground beside the building, {3} m from the nearest wall (--home)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no place inside the airspace is {0} m from every wall, so home is tight: choose one with --home, or widen "
        "--airspace-margin",
    ),
    QT_TRANSLATE_NOOP("Sentences", "this mesh cannot be read (its vertices do not have three coordinates each)"),
    QT_TRANSLATE_NOOP("Sentences", "a triangle without one of its corners"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mesh has no triangles that are whole (a point cloud cannot serve as a building)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "line {0}"),
    QT_TRANSLATE_NOOP("Sentences", "facet {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this PLY file cannot be read: it is cut off, or its header announces something else than what is "
        "there; copy or export it again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "mesh '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "node '{0}'"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file is cut off: it announces {0} triangles, and {1} are there; copy or export it again",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file is cut off: it announces {0} rows, and {1} are there; copy or export it again",
    ),
)
