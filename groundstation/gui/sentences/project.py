"""Sentences about projects, settings, maps and files in general."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP(
        "Sentences",
        "unsaved work could not be copied for after a crash: {0}. Nothing is lost while this window is open; make "
        "room or save the project in another folder",
    ),
    QT_TRANSLATE_NOOP("Sentences", "this folder cannot be made ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "a plan"),
    QT_TRANSLATE_NOOP("Sentences", "a site"),
    QT_TRANSLATE_NOOP("Sentences", "a project"),
    QT_TRANSLATE_NOOP("Sentences", "a mission file"),
    QT_TRANSLATE_NOOP("Sentences", "a building model"),
    QT_TRANSLATE_NOOP("Sentences", "a TSPLIB instance"),
    QT_TRANSLATE_NOOP("Sentences", "a photo"),
    QT_TRANSLATE_NOOP("Sentences", "a folder"),
    QT_TRANSLATE_NOOP("Sentences", "an empty file"),
    QT_TRANSLATE_NOOP("Sentences", "nothing of that name"),
    QT_TRANSLATE_NOOP("Sentences", "a file of another kind"),
    QT_TRANSLATE_NOOP("Sentences", "a plan file (such as office.plan.json)"),
    QT_TRANSLATE_NOOP("Sentences", "a site file (such as office.site.json)"),
    QT_TRANSLATE_NOOP("Sentences", "the folder of a project or its {0}"),
    QT_TRANSLATE_NOOP("Sentences", "a mission file (.kmz, .plan, .waypoints, .kml or .csv)"),
    QT_TRANSLATE_NOOP("Sentences", "a TSPLIB instance (.tsp or .atsp)"),
    QT_TRANSLATE_NOOP("Sentences", "a photo (JPEG, PNG, TIFF or BMP)"),
    QT_TRANSLATE_NOOP("Sentences", "'plan' makes a plan of it"),
    QT_TRANSLATE_NOOP("Sentences", "name the site file that it was made for"),
    QT_TRANSLATE_NOOP("Sentences", "it knows no building; name the site file that it is flown at"),
    QT_TRANSLATE_NOOP("Sentences", "'project new' makes a project of it"),
    QT_TRANSLATE_NOOP("Sentences", "'project add' puts it into a project"),
    QT_TRANSLATE_NOOP("Sentences", "it needs no import; 'export' makes a mission of it"),
    QT_TRANSLATE_NOOP("Sentences", "it goes behind --site; name the mission file as well"),
    QT_TRANSLATE_NOOP("Sentences", "it needs no import; 'plan' takes it as it is"),
    QT_TRANSLATE_NOOP("Sentences", "'tradeoff route' takes plans"),
    QT_TRANSLATE_NOOP("Sentences", "name a file in it"),
    QT_TRANSLATE_NOOP("Sentences", "check the path"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0}, found {1}; {2}"),
    QT_TRANSLATE_NOOP("Sentences", "name another file"),
    QT_TRANSLATE_NOOP("Sentences", "its site is {0}"),
    QT_TRANSLATE_NOOP("Sentences", "name one of its plans: "),
    QT_TRANSLATE_NOOP("Sentences", "it has no plan yet; 'plan {0} -o PLAN' makes one"),
    QT_TRANSLATE_NOOP("Sentences", "{0} was cancelled"),
    QT_TRANSLATE_NOOP("Sentences", "there is no such file; choose an MBTiles file"),
    QT_TRANSLATE_NOOP("Sentences", "the map has no tiles; export it again with the area of the site"),
    QT_TRANSLATE_NOOP("Sentences", "expected zoom levels from 0 to {0}, found {1} to {2}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the map holds vector tiles (pbf), which Reflight does not draw; export it with picture tiles (PNG, JPEG or "
        "WebP)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected tiles in PNG, JPEG or WebP, found something else (the file says {0}); export the map again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected tiles in PNG, JPEG or WebP, found something else; export the map again"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "looking a tile up takes more than {0} s; the index on tiles is missing or the file is damaged; export the "
        "map again",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "not a map in MBTiles format, or damaged ({0}); choose another file, or export the map again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "this folder cannot be written; changes can only be saved as another project"),
    QT_TRANSLATE_NOOP("Sentences", "the next plan"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there is no {0} here, so '{1}' and the plans beside it (found: {2}) were taken as a project; saving makes "
        "it one, with copies of its own",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this project is in format '{0}'; saving brings it to '{1}' and keeps the old {2} beside it",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0}; a project cannot be opened without its site: put the file back from a copy, or make a new project with "
        "'project new' and add the plans to it",
    ),
    QT_TRANSLATE_NOOP("Sentences", "there is a project here already; open it, or name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "expected a folder for the project, found a file; name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "a file"),
    QT_TRANSLATE_NOOP("Sentences", "expected the folder of a project or its {0}, found {1}"),
    QT_TRANSLATE_NOOP("Sentences", "would replace what holds a project together; name another file"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a newer Reflight wrote this project (format '{0}', this one knows up to '{1}'); open it with that one",
    ),
    QT_TRANSLATE_NOOP("Sentences", "cannot be saved: a number in it is NaN or infinite ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "process {0} on {1} since {2}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this project is open in another Reflight ({0}); close it there first, or copy the folder",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected the folder of a project, found nothing of that name"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this project cannot be locked for editing ({0}); it can be looked at, and saved as another project",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there is no project in this folder: expected project.json, or a site file with plans beside it; 'project "
        "new' makes a project",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "expected one site file in a folder without project.json, found {0} ({1}); make a project of one with "
        "'project new'",
    ),
    QT_TRANSLATE_NOOP("Sentences", "plans: expected a list of file names"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; the plan '{1}' was left out"),
    QT_TRANSLATE_NOOP("Sentences", "another program has changed the plan '{0}' since the project was saved"),
    QT_TRANSLATE_NOOP("Sentences", "the plan '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; what was asked of {1} was left out"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; how good the panels are was left out"),
    QT_TRANSLATE_NOOP("Sentences", "plan '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "the project holds this plan already, as '{0}'; leave it out"),
    QT_TRANSLATE_NOOP("Sentences", "this plan was made for another state of the site, or for another site ('{0}')"),
    QT_TRANSLATE_NOOP("Sentences", "site '{0}': cannot be saved: a text in it is no valid Unicode ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; this copy of unsaved work is damaged and cannot be taken over"),
    QT_TRANSLATE_NOOP("Sentences", "all of it: no project can be opened in its folder ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "the site"),
    QT_TRANSLATE_NOOP("Sentences", "plan '{0}' is new"),
    QT_TRANSLATE_NOOP("Sentences", "plan '{0}' was changed"),
    QT_TRANSLATE_NOOP("Sentences", "plan '{0}' was removed"),
    QT_TRANSLATE_NOOP("Sentences", "what is asked of the next plan"),
    QT_TRANSLATE_NOOP("Sentences", "; is '{0}' meant?"),
    QT_TRANSLATE_NOOP("Sentences", "its settings are as at first, and the file stays as it is"),
    QT_TRANSLATE_NOOP("Sentences", "its settings are as at first again, and the damaged file is kept as '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "expected one of {0}, found an unknown key{1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0}, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "a building model (.ifc, .gml, .xml, .json, .obj, .ply, .glb or .stl)"),
    QT_TRANSLATE_NOOP("Sentences", "import it first ('import', or Mission > Import mission files)"),
    QT_TRANSLATE_NOOP("Sentences", "import it first ('site import', or Site > Import), and plan a flight over that"),
    QT_TRANSLATE_NOOP("Sentences", "import it first ('site import', or Site > Import)"),
    QT_TRANSLATE_NOOP("Sentences", "copy it again or make it anew"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0}, found a folder; name a file"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0}, found a device or a pipe; name a file"),
    QT_TRANSLATE_NOOP("Sentences", "the file has more than {0}; expected {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} MiB"),
    QT_TRANSLATE_NOOP("Sentences", "{0} KiB"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be read: there is no such file"),
    QT_TRANSLATE_NOOP("Sentences", "has more than {0} lines; cut out the part that is wanted"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its content would take about {0} GiB of memory; expected at most {1} GiB; cut out the part that is wanted",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the list of its files has more than {0}; pack it again with what is needed"),
    QT_TRANSLATE_NOOP("Sentences", "declares a document type or entities"),
    QT_TRANSLATE_NOOP("Sentences", "is nested more than {0} levels deep"),
    QT_TRANSLATE_NOOP("Sentences", "a JSON file"),
    QT_TRANSLATE_NOOP("Sentences", "a TOML file"),
    QT_TRANSLATE_NOOP("Sentences", "expected text, found half of a character (a surrogate by itself)"),
    QT_TRANSLATE_NOOP("Sentences", "a text in it holds half of a character (a surrogate by itself)"),
    QT_TRANSLATE_NOOP("Sentences", "line {0}: a key has more than {1} parts; none of ours has"),
    QT_TRANSLATE_NOOP(
        "Sentences", "a triangle names vertex {0}, which is not there (vertices: 0 to {1}); export the mesh again"
    ),
    QT_TRANSLATE_NOOP("Sentences", "a mesh file"),
    QT_TRANSLATE_NOOP("Sentences", "reduce it, or cut out the building"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this mesh would take about {0} GiB of memory; expected at most {1} GiB; reduce it, or export "
        "the building alone as binary PLY",
    ),
    QT_TRANSLATE_NOOP("Sentences", "is no GLB file, or cut off; export it again"),
    QT_TRANSLATE_NOOP("Sentences", "the GLB file does not begin with its description, or is cut off; export it again"),
    QT_TRANSLATE_NOOP("Sentences", "the description in the GLB file is damaged ({0}); export it again"),
    QT_TRANSLATE_NOOP(
        "Sentences", "its triangles are compressed ({0}), which is not read; export it without compression"
    ),
    QT_TRANSLATE_NOOP("Sentences", "its triangles are in another file; export it as one file, with everything in it"),
    QT_TRANSLATE_NOOP(
        "Sentences", "its triangles are stored as differences from zero (sparse accessors), which is not read"
    ),
    QT_TRANSLATE_NOOP("Sentences", "a CityGML file"),
    QT_TRANSLATE_NOOP("Sentences", "cut out the buildings wanted"),
    QT_TRANSLATE_NOOP("Sentences", "the XML {0}, which a CityGML file has no need of; refused"),
    QT_TRANSLATE_NOOP("Sentences", "an IFC file"),
    QT_TRANSLATE_NOOP("Sentences", "export the facade alone"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, which no mission needs; refused as hostile"),
    QT_TRANSLATE_NOOP("Sentences", "a file of the signing key"),
    QT_TRANSLATE_NOOP("Sentences", "a DJI KMZ"),
    QT_TRANSLATE_NOOP("Sentences", "a web page"),
    QT_TRANSLATE_NOOP("Sentences", "begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "the model cannot be written ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "a picture"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be decoded as a picture; expected JPEG, PNG, WebP, TIFF or BMP, whole"),
    QT_TRANSLATE_NOOP("Sentences", "the picture is cut off or damaged; copy the file again"),
    QT_TRANSLATE_NOOP(
        "Sentences", "claims to be a picture of {0} x {1} pixels; expected 1 to {2} megapixels, so it is not decoded"
    ),
    QT_TRANSLATE_NOOP("Sentences", "a document"),
    QT_TRANSLATE_NOOP("Sentences", "a safetensors file"),
    QT_TRANSLATE_NOOP("Sentences", "get the file again"),
    QT_TRANSLATE_NOOP("Sentences", "is no safetensors file, or damaged (its header has no end); {0}"),
    QT_TRANSLATE_NOOP("Sentences", "is cut off or damaged ({0} of {1} bytes); {2}"),
    QT_TRANSLATE_NOOP("Sentences", "; the method flies a pattern of its own"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "have no place from which they are known to be seen, and no proof that there is none, so that "
        "they count as possible; {0}",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "are only seen from places to which no way from home was found that keeps {0} m from everything; "
        "move home, or lower the minimum distance",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "are only seen from places less than {0} m from other viewpoints, which {1} refuses; more time does not help",
    ),
    QT_TRANSLATE_NOOP("Sentences", "can be covered; allow it more time"),
    QT_TRANSLATE_NOOP("Sentences", "{0} sections (on {1} panels, the first is '{2}') {3}"),
)
