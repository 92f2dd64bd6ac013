"""What planning, missions and services say, in the window's language and units, and the language it speaks.

Their messages name commands and options where something is to be typed: the window says its own buttons and fields.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QTranslator
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication

from groundstation.services.messages import localized, on_paper, with_window_labels
from groundstation.services.settings import Language
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding


def QT_TRANSLATE_NOOP(context: str, text: str) -> str:  # noqa: N802
    """Mark a text for `lupdate`, which looks for this name. Qt's own returns the text as an `object`."""
    return text


# Words that stand in messages, and what the window says in place of what is typed.
#
# The parts without Qt say what to type. Whoever reads them in the window has buttons and fields: each such message
# stands here with the one that names those (`IN_WINDOW`), and each option with its field (`OPTION_FIELDS`). `WORDS` are
# values that are no messages themselves, such as names of things, and what the system and libraries say.

IN_WINDOW = {
    (
        "the terrain of the site was made for the place where it is, and would lie wrong elsewhere; take it off first "
        "('site terrain --remove'), and attach it again after the move"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "the terrain of the site was made for the place where it is, and would lie wrong elsewhere; take it off first "
        "(Site > Terrain), and attach it again after the move",
    ),
    (
        "terrain and site differ by {0} m at home: where the ground is level there, one of them is wrong; "
        "'--shift home' brings the terrain to the site"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "terrain and site differ by {0} m at home: where the ground is level there, one of them is wrong; the terrain "
        "can be brought to home",
    ),
    "the picture is distorted, and splats are rendered without distortion; make it straight with `prepare`": (
        QT_TRANSLATE_NOOP(
            "Sentences",
            "the picture is distorted, and splats are rendered without distortion; make a data set of it (Photos tab)",
        )
    ),
    "expected a folder of panels files (*.json), as 'segment' writes them; found none": QT_TRANSLATE_NOOP(
        "Sentences", "expected a folder of panels files (*.json); found none"
    ),
    "--components: there is no component '{0}'; known are {1}": QT_TRANSLATE_NOOP(
        "Sentences", "there is no part '{0}'; known are {1}"
    ),
    "CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone, or write --gaussians spz": (
        QT_TRANSLATE_NOOP(
            "Sentences", "CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone"
        )
    ),
    "holds no objects yet; 'records FOLDER make' takes them from a site": QT_TRANSLATE_NOOP(
        "Sentences", "holds no objects yet: it is no model whose panels are known"
    ),
    "there is no signing key on this computer; set one ('signing set', or Key in the Fly tab)": QT_TRANSLATE_NOOP(
        "Sentences", "there is no signing key on this computer; set one: Key in the Fly tab"
    ),
    (
        "expected a plan file, found a mission file, and the first plan does not name an aircraft of the catalogue to "
        "read it for; make a plan of it first ('import' with --profile)"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "expected a plan file, found a mission file, and the first plan does not name an aircraft of the catalogue to "
        "read it for; make a plan of it first (Mission > Import mission files)",
    ),
    "the plan has no {0}, so nothing can be placed on the globe; add --site SITE": QT_TRANSLATE_NOOP(
        "Sentences", "the plan has no {0}, so nothing can be placed on the globe; open its site first"
    ),
    "method 'pso' needs a number of views (--views N); it cannot look for the fewest": QT_TRANSLATE_NOOP(
        "Sentences",
        "the particle swarm needs a number of views (“Plan for”: number of views); it cannot look for the fewest",
    ),
    "--deflection {0}: expected a positive length in metres": QT_TRANSLATE_NOOP(
        "Sentences", "the accuracy of curved surfaces is {0}: expected a positive length in metres"
    ),
    "its height is above the ellipsoid (--height-reference orthometric for sea level)": QT_TRANSLATE_NOOP(
        "Sentences", "its height is above the ellipsoid"
    ),
    "'plan' makes a plan of it": QT_TRANSLATE_NOOP("Sentences", "open it on the Site tab, and plan on the Plan tab"),
    "it has no plan yet; 'plan {0} -o PLAN' makes one": QT_TRANSLATE_NOOP(
        "Sentences", "{0} has no plan yet; open it and plan on the Plan tab"
    ),
    "'project new' makes a project of it": QT_TRANSLATE_NOOP(
        "Sentences", "open it on the Site tab, and save it as a project (Project > Save as)"
    ),
    "'project add' puts it into a project": QT_TRANSLATE_NOOP(
        "Sentences", "open its site first, then the plan (Plan tab, Plans, Open plan)"
    ),
    "it needs no import; 'export' makes a mission of it": QT_TRANSLATE_NOOP(
        "Sentences", "it needs no import: open it on the Plan tab, and export it on the Mission tab"
    ),
    "it goes behind --site; name the mission file as well": QT_TRANSLATE_NOOP(
        "Sentences", "open it on the Site tab first, then choose the mission file"
    ),
    "it needs no import; 'plan' takes it as it is": QT_TRANSLATE_NOOP(
        "Sentences", "it needs no import: open it as a site (Site tab, Open)"
    ),
    (
        "holds no COLMAP model (such as sparse/0) and no transforms.json; name it with --colmap, name a site if "
        "the photos say where they were taken, or make a model of them with 'coarse'"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "holds no COLMAP model (such as sparse/0) and no transforms.json; open a site first if the photos say where "
        "they were taken, or make a model of them: “From photos alone” on the Photos tab",
    ),
    (
        "the camera model {0} is not supported; expected one of {1}; undistort the pictures first, such as with "
        "COLMAP's image_undistorter, whose model 'prepare --colmap' reads"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "the camera model {0} is not supported; expected one of {1}; undistort the pictures first, such as with "
        "COLMAP's image_undistorter",
    ),
    "is a folder with a model of poses, and no site; name it with --colmap": QT_TRANSLATE_NOOP(
        "Sentences", "only the command line works with it"
    ),
    "poses are refined in the frame of a site; name it, or leave --refine out": QT_TRANSLATE_NOOP(
        "Sentences", "only the command line works with it"
    ),
    "'tradeoff route' takes plans": QT_TRANSLATE_NOOP("Sentences", "only the command line works with it"),
    (
        "{0}; a project cannot be opened without its site: put the file back from a copy, or make a new project with "
        "'project new' and add the plans to it"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "{0}; a project cannot be opened without its site: put the file back from a copy, or open the site on the Site "
        "tab, open the plans on the Plan tab and save them as a new project",
    ),
    (
        "there is no project in this folder: expected project.json, or a site file with plans beside it; 'project new' "
        "makes a project"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "there is no project in this folder: expected project.json, or a site file with plans beside it; Project > "
        "Save as makes a project of what is open",
    ),
    (
        "expected one site file in a folder without project.json, found {0} ({1}); make a project of one with "
        "'project new'"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "expected one site file in a folder without project.json, found {0} ({1}); open one on the Site tab and save "
        "it as a project",
    ),
    "import it first ('import', or Mission > Import mission files)": QT_TRANSLATE_NOOP(
        "Sentences", "import it first: Mission > Import mission files"
    ),
    "import it first ('site import', or Site > Import), and plan a flight over that": QT_TRANSLATE_NOOP(
        "Sentences", "import it first (Site > Import building model), and plan a flight over that"
    ),
    "import it first ('site import', or Site > Import)": QT_TRANSLATE_NOOP(
        "Sentences", "import it first: Site > Import building model"
    ),
    (
        "has no dataset.json, but a COLMAP model in {0}; 'prepare PHOTOS --colmap MODEL' makes one of it, "
        "with a site and its panels or without"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "has no dataset.json, but a COLMAP model in {0}; the Photos tab makes a data set of its photos",
    ),
    "has no dataset.json; name a folder that `prepare` or `scene render` has finished": QT_TRANSLATE_NOOP(
        "Sentences", "has no dataset.json; choose the folder of a data set that is finished"
    ),
    (
        "has no panels, and {0} learns what panels mirror; train plain splats instead (--method 2dgs), or find its "
        "panels first"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "has no panels, and {0} learns what panels mirror; train plain splats instead (“Method”: 2DGS), or find its "
        "panels first",
    ),
    "name one of `train`": QT_TRANSLATE_NOOP("Sentences", "choose one that a training has finished"),
    (
        "none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer, or train splats "
        "alone (--method 2dgs)"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer, or train splats "
        "alone (“Method”: 2DGS)",
    ),
    "holds no scene of objects ({0}); make one with `organise`": QT_TRANSLATE_NOOP(
        "Sentences",
        "holds no scene of objects ({0}); open a finished model on the Model tab, which makes one beside it",
    ),
    (
        "the records have the older version {0}; opening them for writing, as 'records FOLDER make' does, brings them "
        "up to date"
    ): QT_TRANSLATE_NOOP(
        "Sentences", "the records have the older version {0}; the first change that is kept brings them up to date"
    ),
    "there are no records yet; make them with 'records FOLDER make --objects SITE'": QT_TRANSLATE_NOOP(
        "Sentences", "there are no records yet; the first one that is added on the Model tab makes them"
    ),
    (
        "site '{0}' has no panels yet: find them in photos ('panels' or the Photos tab), or draw them on the building "
        "(the Site tab, or 'site import' with --panel-grid)"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "site '{0}' has no panels yet: find them in photos (Photos tab), or draw them on the building (Site tab)",
    ),
    (
        "{0}, so the site has no panels yet: find them in photos ('panels' or the Photos tab), or draw them on the "
        "building (the Site tab, or --panel-grid)"
    ): QT_TRANSLATE_NOOP(
        "Sentences",
        "{0}, so the site has no panels yet: find them in photos (Photos tab), or draw them on the building (Site tab)",
    ),
}
"""What the window says, by the template that it takes the place of; both have the same fields."""


OPTION_FIELDS = {
    "--despite-errors": (
        "SendDialog",
        QT_TRANSLATE_NOOP("SendDialog", "Send it all the same: it may crash, or break the law"),
    ),
    "--population-counts": ("Parameters", QT_TRANSLATE_NOOP("Parameters", "Raster counts people")),
    "--reserve": ("Parameters", QT_TRANSLATE_NOOP("Parameters", "Battery reserve")),
    "--airspace-margin": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Airspace around the building")),
    "--axis-order": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Order of coordinates")),
    "--building": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Building")),
    "--ceiling": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Airspace up to, in the Site tab")),
    "--columns": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Columns")),
    "--crs": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Coordinate system")),
    "--floor": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Airspace up from, in the Site tab")),
    "--gap": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Gap")),
    "--grid-tolerance": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Off the wall by up to")),
    "--ground": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Height of the ground in the file")),
    "--height-reference": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Heights are")),
    "--home": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Home, in the Site tab")),
    "--name": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Name of the site")),
    "--origin": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Site origin")),
    "--panel-grid": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Facade grid")),
    "--rows": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Rows")),
    "--units": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Unit of lengths")),
    "--up": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Axis that points up")),
    "--accuracy": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Accuracy")),
    "--geoid": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Grid of the geoid")),
    "--height-unit": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Unit of heights")),
    "--resolution": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Step of the grid")),
    "--taller-than": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Obstacles taller than")),
    "--vertical": ("TerrainForm", QT_TRANSLATE_NOOP("TerrainForm", "Heights are above")),
    "--at": ("DayBox", QT_TRANSLATE_NOOP("DayBox", "Planned for")),
    "--temperature": ("DayBox", QT_TRANSLATE_NOOP("DayBox", "Temperature")),
    "--permit": ("ZonesForm", QT_TRANSLATE_NOOP("ZonesForm", "Authorisation")),
    "--not-here": ("ZonesForm", QT_TRANSLATE_NOOP("ZonesForm", "Not here, according to")),
}
"""Fields by the option that says the same, but for declared parameters: context and text of their label."""

WORDS = (
    QT_TRANSLATE_NOOP("Sentences", "whole number"),
    QT_TRANSLATE_NOOP("Sentences", "ERROR"),
    QT_TRANSLATE_NOOP("Sentences", "warning"),
    QT_TRANSLATE_NOOP("Sentences", "note"),
    QT_TRANSLATE_NOOP("Sentences", "error"),
    QT_TRANSLATE_NOOP("Sentences", "no answer"),
    QT_TRANSLATE_NOOP("Sentences", "preparing the vehicle"),
    QT_TRANSLATE_NOOP("Sentences", "checking before take-off"),
    QT_TRANSLATE_NOOP("Sentences", "ready for take-off"),
    QT_TRANSLATE_NOOP("Sentences", "resuming the mission"),
    QT_TRANSLATE_NOOP("Sentences", "returning home"),
    QT_TRANSLATE_NOOP("Sentences", "landing here"),
    QT_TRANSLATE_NOOP("Sentences", "starts"),
    QT_TRANSLATE_NOOP("Sentences", "ends"),
    QT_TRANSLATE_NOOP("Sentences", "moved"),
    QT_TRANSLATE_NOOP("Sentences", "deleted"),
    QT_TRANSLATE_NOOP("Sentences", "inside"),
    QT_TRANSLATE_NOOP("Sentences", "occlusion"),
    QT_TRANSLATE_NOOP("Sentences", "terrain"),
    QT_TRANSLATE_NOOP("Sentences", "facade"),
    QT_TRANSLATE_NOOP("Sentences", "obstacle"),
    QT_TRANSLATE_NOOP("Sentences", "panel"),
    QT_TRANSLATE_NOOP("Sentences", "zone"),
    QT_TRANSLATE_NOOP("Sentences", "building"),
    QT_TRANSLATE_NOOP("Sentences", "home"),
    QT_TRANSLATE_NOOP("Sentences", "airspace"),
    QT_TRANSLATE_NOOP("Sentences", "east"),
    QT_TRANSLATE_NOOP("Sentences", "north"),
    QT_TRANSLATE_NOOP("Sentences", "up"),
    QT_TRANSLATE_NOOP("Sentences", "obstacle '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "panel '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "no-fly volume '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "the building '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "{0} deg"),
    QT_TRANSLATE_NOOP("Sentences", "{0} viewpoints"),
    QT_TRANSLATE_NOOP("Sentences", "{0} views"),
    QT_TRANSLATE_NOOP("Sentences", "{0} sections"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photos"),
    QT_TRANSLATE_NOOP("Sentences", "{0} findings"),
    QT_TRANSLATE_NOOP("Sentences", "{0} in sorties that were not flown"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached"),
    QT_TRANSLATE_NOOP("Sentences", "{0} reached, but the camera did not answer"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photographed, but the camera's report was lost"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photographed from too far away"),
    QT_TRANSLATE_NOOP("Sentences", "{0} where the photo looks elsewhere"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached before the flight ended"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off by Return"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off by Land"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off for low battery"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off for the lost link"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off for the lost remote control"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the flight was broken off at the fence"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the pilot took over by hand"),
    QT_TRANSLATE_NOOP("Sentences", "{0} not reached because the motors stopped in the air"),
    QT_TRANSLATE_NOOP("Sentences", "{0} after the end of the record in the air"),
    QT_TRANSLATE_NOOP("Sentences", "{0} where the record does not tell the aircraft's place"),
    QT_TRANSLATE_NOOP("Sentences", "minimum distance (m) {0} instead of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "section step (degrees) {0} instead of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "occlusion {0} instead of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "whole panels only {0} instead of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "largest distance (m) {0} instead of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} of length {1}, got {2}"),
    QT_TRANSLATE_NOOP("Sentences", "missing required field '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "object contains unknown field '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "invalid enum value {0}"),
    QT_TRANSLATE_NOOP("Sentences", "focal lengths are from"),
    QT_TRANSLATE_NOOP("Sentences", "black"),
    QT_TRANSLATE_NOOP("Sentences", "white"),
    QT_TRANSLATE_NOOP("Sentences", "longer"),
    QT_TRANSLATE_NOOP("Sentences", "shorter"),
    QT_TRANSLATE_NOOP("Sentences", "number"),
    QT_TRANSLATE_NOOP("Sentences", "text"),
    QT_TRANSLATE_NOOP("Sentences", "list"),
    QT_TRANSLATE_NOOP("Sentences", "object"),
    QT_TRANSLATE_NOOP("Sentences", "nothing"),
    QT_TRANSLATE_NOOP("Sentences", "true/false"),
    QT_TRANSLATE_NOOP("Sentences", "a .toml file"),
    QT_TRANSLATE_NOOP("Sentences", "No such file or directory"),
    QT_TRANSLATE_NOOP("Sentences", "Permission denied"),
    QT_TRANSLATE_NOOP("Sentences", "Is a directory"),
    QT_TRANSLATE_NOOP("Sentences", "Not a directory"),
    QT_TRANSLATE_NOOP("Sentences", "File exists"),
    QT_TRANSLATE_NOOP("Sentences", "File name too long"),
    QT_TRANSLATE_NOOP("Sentences", "Invalid argument"),
    QT_TRANSLATE_NOOP("Sentences", "No space left on device"),
    QT_TRANSLATE_NOOP("Sentences", "Read-only file system"),
    QT_TRANSLATE_NOOP("Sentences", "Input/output error"),
    QT_TRANSLATE_NOOP("Sentences", "Disk quota exceeded"),
    QT_TRANSLATE_NOOP("Sentences", "[Errno {0}] {1}"),
    QT_TRANSLATE_NOOP("Sentences", "Expecting value"),
    QT_TRANSLATE_NOOP("Sentences", "Expecting property name enclosed in double quotes"),
    QT_TRANSLATE_NOOP("Sentences", "Expecting ',' delimiter"),
    QT_TRANSLATE_NOOP("Sentences", "Expecting ':' delimiter"),
    QT_TRANSLATE_NOOP("Sentences", "Extra data"),
    QT_TRANSLATE_NOOP("Sentences", "template.kml and waylines.wpml"),
    QT_TRANSLATE_NOOP("Sentences", "views"),
    QT_TRANSLATE_NOOP("Sentences", "batteries"),
    QT_TRANSLATE_NOOP("Sentences", "coverage"),
    QT_TRANSLATE_NOOP("Sentences", "seed"),
    QT_TRANSLATE_NOOP("Sentences", " and "),
    QT_TRANSLATE_NOOP("Sentences", "denied"),
    QT_TRANSLATE_NOOP("Sentences", "failed"),
    QT_TRANSLATE_NOOP("Sentences", "cancelled"),
    QT_TRANSLATE_NOOP("Sentences", "pausing"),
    QT_TRANSLATE_NOOP("Sentences", "arming"),
    QT_TRANSLATE_NOOP("Sentences", "mission"),
    QT_TRANSLATE_NOOP("Sentences", "geofence"),
    QT_TRANSLATE_NOOP("Sentences", "{0}: done"),
    QT_TRANSLATE_NOOP("Sentences", "wind"),
    QT_TRANSLATE_NOOP("Sentences", "multipath"),
    QT_TRANSLATE_NOOP("Sentences", "Fresnel"),
    QT_TRANSLATE_NOOP("Sentences", "curvature"),
    QT_TRANSLATE_NOOP("Sentences", "shadow"),
    QT_TRANSLATE_NOOP("Sentences", "vignetting"),
    QT_TRANSLATE_NOOP("Sentences", "noise"),
    QT_TRANSLATE_NOOP("Sentences", "px"),
    QT_TRANSLATE_NOOP("Sentences", "dewarp data"),
    QT_TRANSLATE_NOOP("Sentences", "calibrated focal length"),
    QT_TRANSLATE_NOOP("Sentences", "focal length and catalogue sensor"),
    QT_TRANSLATE_NOOP("Sentences", "focal length and sensor size"),
    QT_TRANSLATE_NOOP("Sentences", "35 mm equivalent"),
    QT_TRANSLATE_NOOP("Sentences", "focal length and focal plane resolution"),
    QT_TRANSLATE_NOOP("Sentences", "a plan"),
    QT_TRANSLATE_NOOP("Sentences", "a site"),
    QT_TRANSLATE_NOOP("Sentences", "a project"),
    QT_TRANSLATE_NOOP("Sentences", "a building model"),
    QT_TRANSLATE_NOOP("Sentences", "a TSPLIB instance"),
    QT_TRANSLATE_NOOP("Sentences", "a folder"),
    QT_TRANSLATE_NOOP("Sentences", "an empty file"),
    QT_TRANSLATE_NOOP("Sentences", "a file of another kind"),
    QT_TRANSLATE_NOOP("Sentences", "starting"),
    QT_TRANSLATE_NOOP("Sentences", "a divisor of 90 from 1 to 90 degrees"),
    QT_TRANSLATE_NOOP("Sentences", "0 m or more"),
    QT_TRANSLATE_NOOP("Sentences", "0 mm or more"),
    QT_TRANSLATE_NOOP("Sentences", "a positive speed"),
    QT_TRANSLATE_NOOP("Sentences", "more than 0 s"),
)


# The window's language: English in the code, others from Qt Linguist files in `gui/translations`.

KEYS_UNNAMED = (QT_TRANSLATE_NOOP("QShortcut", "Return"), QT_TRANSLATE_NOOP("QShortcut", "Enter"))
"""Keys that Qt's own translations leave in English; it looks for their names here first."""

FOLDER = Path(__file__).parents[1] / "translations"


def shown_keys(keys: QKeySequence) -> str:
    """Keys in the user's language, as menus name them."""
    return keys.toString(QKeySequence.SequenceFormat.NativeText)


class Translations:
    """Installs the translators of one language, and takes those of the one before away."""

    def __init__(self, application: QApplication) -> None:
        self._application = application
        self._installed: list[QTranslator] = []
        self._language: Language | None = None

    def use(self, language: Language) -> None:
        """Speak a language from now on; widgets that exist already keep theirs."""
        if language is self._language:
            return
        self.remove()
        self._language = language
        locale = QLocale.system() if language is Language.SYSTEM else QLocale(str(language))
        QLocale.setDefault(locale)
        # Texts of Qt's own dialogs first: the translator installed last is asked first.
        for name, folder in (
            ("qtbase", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)),
            ("reflight", str(FOLDER)),
        ):
            translator = QTranslator()
            if translator.load(locale, name, "_", folder):
                self._application.installTranslator(translator)
                self._installed.append(translator)

    def remove(self) -> None:
        """Speak English again."""
        self._language = None
        for translator in self._installed:
            self._application.removeTranslator(translator)
        self._installed = []


def translated(text: str, units: UnitSystem) -> str:
    """A message, stage or name from below in the user's language and units; as it is where it is not known."""
    return with_fields(localized(text, _in_language, units))


def printed(text: str, units: UnitSystem) -> str:
    """A message as it stands on paper, in the user's language and units."""
    return with_fields(on_paper(localized(text, _in_language, units)))


def with_fields(text: str) -> str:
    """A text with labels of fields in place of the command line's options."""
    if "--" not in text:
        return text
    labels = {option: QCoreApplication.translate(*label) for option, label in OPTION_FIELDS.items()}
    return with_window_labels(text, labels, QCoreApplication.translate("Words", "“{0}”"))


def translated_finding(finding: Finding, units: UnitSystem) -> Finding:
    """A finding whose message and place are in the user's language and units; value and limit stay metric."""
    return replace(finding, message=translated(finding.message, units), place=translated(finding.place, units))


def _in_language(template: str) -> str:
    return QCoreApplication.translate("Sentences", IN_WINDOW.get(template, template))
