"""What is said while models are written for other programs: stages, notes and errors."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "--components: there is no component '{0}'; known are {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences", "what this method's shading adds is not in the file: its Gaussians have their own colours only"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "mirrored light is in the colours, as harmonics of degree 3: blurred, and it stays on the panes"
    ),
    QT_TRANSLATE_NOOP("Sentences", "panels show their own colour only, and mirror nothing"),
    QT_TRANSLATE_NOOP("Sentences", "{0} records of objects that the model lacks are left out"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} files of records are missing or changed: the page says so; copy them back beside the records",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} pictures of records cannot be read: the page says so; attach them again"),
    QT_TRANSLATE_NOOP(
        "Sentences", "{0} documents are too large for the page, which names them; pass them on by themselves"
    ),
    QT_TRANSLATE_NOOP("Sentences", "reading documents"),
    QT_TRANSLATE_NOOP("Sentences", "reading what is attached"),
    QT_TRANSLATE_NOOP("Sentences", "the place on Earth is not known: tiles stay in the site's own frame"),
    QT_TRANSLATE_NOOP(
        "Sentences", "each panel is a picture of its front: mirror images in it belong to that view alone"
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} Gaussians that nobody sees are left out"),
    QT_TRANSLATE_NOOP(
        "Sentences", "{0} Gaussians are larger or smaller than the format has, and have its nearest size"
    ),
    QT_TRANSLATE_NOOP("Sentences", "CesiumJS: show gaussians.json and panels.json as two layers"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone, or write --gaussians spz",
    ),
    QT_TRANSLATE_NOOP("Sentences", "baking panels"),
    QT_TRANSLATE_NOOP("Sentences", "there is no mission format '{0}'; known are: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "there is no model format '{0}'; known are: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the plug-in '{0}' of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "an unknown package"),
    QT_TRANSLATE_NOOP("Sentences", "{0} is left out: {1}; update it, or remove it"),
    QT_TRANSLATE_NOOP("Sentences", "{0} failed: {1}: {2}; update it, or remove it"),
    QT_TRANSLATE_NOOP("Sentences", "its name has other characters than a-z, 0-9, dot, hyphen and underscore"),
    QT_TRANSLATE_NOOP("Sentences", "there is another one of that name"),
    QT_TRANSLATE_NOOP("Sentences", "expected a {0} from it, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected its entry point to stand for a {0}, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected its entry point to stand for the path of a TOML file, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' has other characters than a-z, 0-9, dot, hyphen and underscore"),
    QT_TRANSLATE_NOOP("Sentences", "there is another aircraft profile '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "writing panels"),
    QT_TRANSLATE_NOOP("Sentences", "not written: its latitude is {0}°, and UTM has {1}° to {2}°"),
    QT_TRANSLATE_NOOP("Sentences", "not written: a panel has corners that are not finite"),
    QT_TRANSLATE_NOOP("Sentences", "the scene's origin is not finite: {0}; organise the model again"),
    QT_TRANSLATE_NOOP("Sentences", "component '{0}': {1}: holds numbers that are not finite or cannot be; train again"),
    QT_TRANSLATE_NOOP("Sentences", "panel '{0}': its corners are not finite; import the site again"),
    QT_TRANSLATE_NOOP("Sentences", "not written: there is no Gaussian that could be seen; choose other components"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "would have {0} GB, and a .glb has less than 4.3; choose a lower degree of harmonics, fewer facades, "
        "or 3D Tiles, which are many files",
    ),
    QT_TRANSLATE_NOOP("Sentences", "several panels have the same GlobalId; organise the model again"),
    QT_TRANSLATE_NOOP("Sentences", "attribute '{0}': expected finite numbers, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "not written: there are no panels; choose other components"),
    QT_TRANSLATE_NOOP("Sentences", "not written: panel '{0}' has no area; import the site again"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "not written: panel '{0}' would have {1} pixels on a side, and textures have {2}; choose {3} pixels "
        "per metre or fewer",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "not written: {0} textures of {1} pixels would be needed, and {2} are the most; choose about {3} "
        "pixels per metre, or single facades",
    ),
    QT_TRANSLATE_NOOP("Sentences", "rendering panels"),
    QT_TRANSLATE_NOOP("Sentences", "counting Gaussians"),
    QT_TRANSLATE_NOOP("Sentences", "not written: {0} Gaussians are more than fit into an image; write single facades"),
    QT_TRANSLATE_NOOP("Sentences", "writing images"),
    QT_TRANSLATE_NOOP("Sentences", "choosing samples"),
    QT_TRANSLATE_NOOP("Sentences", "choosing colours"),
    QT_TRANSLATE_NOOP("Sentences", "finding colours"),
    QT_TRANSLATE_NOOP("Sentences", "packing Gaussians"),
    QT_TRANSLATE_NOOP("Sentences", "reading Gaussians"),
    QT_TRANSLATE_NOOP("Sentences", "not written: a Gaussian lies {0} m from the origin; train again"),
    QT_TRANSLATE_NOOP("Sentences", "compressing"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "3D Tiles lie on Earth, and the site's place is not known; set the site's origin, or ask for tiles "
        "in its local frame",
    ),
    QT_TRANSLATE_NOOP("Sentences", "nothing to write: the scene has neither Gaussians nor panels"),
    QT_TRANSLATE_NOOP(
        "Sentences", "USD needs the package usd-core, which is not installed: pip install 'reflight[usd]'"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "USD: this usd-core knows no Gaussians; install 26.3 or newer: pip install 'reflight[usd]'"
    ),
    QT_TRANSLATE_NOOP("Sentences", "writing Gaussians"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written; is the disk full?"),
    QT_TRANSLATE_NOOP("Sentences", "expected a name that ends in {0}, got '{1}'"),
    QT_TRANSLATE_NOOP("Sentences", "writing the page"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written: this is a file; name a folder"),
    QT_TRANSLATE_NOOP("Sentences", "is a page of somebody else's; name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "has other files and no page of ours; name an empty folder, or a new one"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be read ({0}); name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "not written: the scene has no components; export at least one facade"),
    QT_TRANSLATE_NOOP("Sentences", "not written: {0} panels, a page bears {1}; export one facade"),
    QT_TRANSLATE_NOOP("Sentences", "not written: {0} of the scene's Gaussians holds numbers that are not finite"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "not written: {0} Gaussians, a page bears {1}; keep the most visible ones alone (most), or export one facade",
    ),
    QT_TRANSLATE_NOOP("Sentences", "reading pictures"),
    QT_TRANSLATE_NOOP(
        "Sentences", "pictures of defects: more than {0} MiB after {1} of {2}, even made small; leave some out"
    ),
    QT_TRANSLATE_NOOP("Sentences", "records and panels: more than {0} MiB of text; export one facade"),
    QT_TRANSLATE_NOOP("Sentences", "corners of a panel hold numbers that are not finite"),
    QT_TRANSLATE_NOOP("Sentences", "picture '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "has more than {0} MiB; save it smaller"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written as JPEG"),
    QT_TRANSLATE_NOOP("Sentences", "expected a finite number, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected a text, a number, yes or no, or places on a pane; got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "records: there are more than {0}; leave some out"),
    QT_TRANSLATE_NOOP("Sentences", "expected the GlobalId of an object, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "record: expected one of {0}, got {1}"),
    QT_TRANSLATE_NOOP("Sentences", "has {0} fields; at most {1} are shown"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be written: it is no file; name one"),
    QT_TRANSLATE_NOOP("Sentences", "its Gaussians do not each have a place of their own; it is damaged"),
    QT_TRANSLATE_NOOP("Sentences", "holds no objects yet; 'records FOLDER make' takes them from a site"),
    QT_TRANSLATE_NOOP("Sentences", "the place on earth is not known to the records: IfcSite has none"),
    QT_TRANSLATE_NOOP("Sentences", "the building behind the panes is not in the file"),
    QT_TRANSLATE_NOOP("Sentences", "telling panels of splats"),
    QT_TRANSLATE_NOOP("Sentences", "has no '{0}' of splats; it is damaged, or of another program"),
    QT_TRANSLATE_NOOP("Sentences", "expected shape {0}, found {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected float32 (panels: int32), found {0}"),
    QT_TRANSLATE_NOOP("Sentences", "panels: expected numbers from {0} on, found {1}"),
)
