"""Sentences that name commands and options of the command line, and what the window says instead.

The parts without Qt say what to type. Whoever reads them in the window has buttons and fields: here each such sentence
stands with the one that names those. Options that belong to a field of the window need no entry: they are put into
words one by one (`OPTION_FIELDS`).
"""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

IN_WINDOW = {
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
    "has no dataset.json; name a folder that `prepare` or `scene render` has finished": QT_TRANSLATE_NOOP(
        "Sentences", "has no dataset.json; choose the folder of a data set that is finished"
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

SENTENCES = tuple(IN_WINDOW.values())

OPTION_FIELDS = {
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
    "--origin": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Zero point on earth")),
    "--panel-grid": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Panel grid")),
    "--rows": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Rows")),
    "--units": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Unit of lengths")),
    "--up": ("ImportForm", QT_TRANSLATE_NOOP("ImportForm", "Axis that points up")),
    "--at": ("DayBox", QT_TRANSLATE_NOOP("DayBox", "Planned for")),
    "--temperature": ("DayBox", QT_TRANSLATE_NOOP("DayBox", "Temperature")),
}
"""Fields by the option that says the same, but for declared parameters: context and text of their label."""
