"""Where findings, errors, stages and effects stand in the window, they stand in the user's language and units."""

import re
import threading
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PySide6.QtCore import QTranslator

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import FOLDER, IN_WINDOW, OPTION_FIELDS, translated_finding
from groundstation.gui.plan.plan_controller import method_name
from groundstation.gui.site.site_panels import FindingsList as SiteFindingsList
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.job_bar import JobBar
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.project.document import Document
from groundstation.services.project.session import Session
from groundstation.services.units import UnitSystem
from planning.base.effects import Decision
from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.checks.case import judge
from planning.viewpoints.methods import METHODS
from tests.gui.driving import turn_until

ROOT = Path(__file__).parents[3]

TOO_CLOSE = judge(
    False,
    "leg-distance",
    "smallest distance along the path",
    *(3.048, 10.0, "m"),
    say("{}, leg {}", say("sortie {}", 2), 3),
    "plan the route again",
    least=True,
)


@pytest.fixture
def german(application):
    translator = QTranslator()
    assert translator.load(str(FOLDER / "reflight_de.qm"))
    application.installTranslator(translator)
    yield
    application.removeTranslator(translator)


@pytest.fixture
def context(application):
    context = ApplicationContext(Session(Document()), JobRunner())
    yield context
    context.close()


def test_pre_flight_findings_are_german_and_still_lead_to_their_place(german):
    shown, picked = FindingsList(), []
    shown.placePicked.connect(picked.append)
    shown.set_findings([TOO_CLOSE])
    assert shown.texts() == (
        "Fehler (Mindestabstand)\n"
        "kleinster Abstand entlang des Flugwegs: 3.048 m, mindestens 10 m; die Route neu planen\n"
        "gemessen 3.0 m · Grenze 10.0 m · bei Einsatz 2, Strecke 3",
    )
    shown.clicked.emit(shown.model().index(0, 0))
    assert picked == [TOO_CLOSE.place]


def test_pre_flight_findings_follow_the_units(application):
    shown = FindingsList()
    shown.set_findings([TOO_CLOSE])
    shown.set_units(UnitSystem.IMPERIAL)
    assert "smallest distance along the path: 10.0 ft, at least 32.8 ft" in shown.texts()[0]
    shown.set_units(UnitSystem.METRIC)
    assert TOO_CLOSE.message in shown.texts()[0]


def test_findings_on_the_site_are_german_and_follow_the_units(german):
    message = say("home lies at {} m, below the ground at {} m; put it on the ground", -3.048, 0)
    shown = SiteFindingsList()
    shown.set_findings((Finding(Severity.WARNING, "home-below-ground", message, "home"),))
    shown.set_units(UnitSystem.IMPERIAL)
    assert shown._list.item(0).text() == (
        "Warnung: der Startplatz liegt bei -10.0 ft, unter dem Boden bei 0.0 ft; ihn auf den Boden setzen"
    )


def test_an_effect_says_in_german_what_it_is_and_why(german):
    reason = say("something stands in front of {:.0f} % of the panels", 40)
    found = Decision("occlusion", True, "scene", reason, 12.0, 0.5, "% of the lines of sight", 0.1)
    panel = EffectsPanel()
    panel.set_effects((EffectChoice(found, "auto"),))
    assert panel.card("occlusion").text() == (
        "Verdeckung\nist an\nvor 40 % der Scheiben steht etwas\n"
        "Größe 12 % der Sichtlinien, Toleranz 0.5; kostet etwa 0.1 s"
    )


def test_the_stage_and_the_failure_of_a_job_are_german(german, application, context):
    bar, stages, messages = JobBar(context), [], []
    context.messageShown.connect(messages.append)

    seen = threading.Event()

    def work(job):
        job.report("finding ways around", 0, 1)
        seen.wait(10.0)
        raise InfeasibleError(
            say("home {:m} lies inside a no-fly volume; move it outside", "(0, 0, 3)", place="home_enu_m")
        )

    context.start("Planen", work)
    turn_until(application, lambda: bar._label.text().startswith("Planen:"))
    stages.append(bar._label.text())
    seen.set()
    turn_until(application, lambda: bool(messages))
    assert stages[-1:] == ["Planen: Umwege werden gesucht"]
    assert messages[0].text == (
        "Planen: home_enu_m: der Startplatz (0, 0, 3) liegt in einer Flugverbotszone; ihn hinausschieben"
    )


def test_every_method_has_a_german_name(german):
    names = {method_name(method) for method in METHODS}
    assert len(names) == len(METHODS)
    assert not names & set(METHODS)


def test_a_finding_keeps_what_it_measured(german):
    told = translated_finding(TOO_CLOSE, UnitSystem.IMPERIAL)
    assert (told.value, told.limit, told.unit, told.severity, told.code) == (
        *(3.048, 10.0, "m"),
        *(TOO_CLOSE.severity, TOO_CLOSE.code),
    )
    assert told.place == "Einsatz 2, Strecke 3"


COMMANDS = sorted(path.stem.rstrip("_") for path in (ROOT / "groundstation" / "cli" / "commands").glob("[a-z]*.py"))

COMMAND_LINE = re.compile(
    # An option, a command in quotes with what goes behind it, or the program's file.
    rf"(?<![\w-])--[a-z]|['`“„](?:{'|'.join(COMMANDS)})(?: [\w./-]+)*['`”“]|\bapp\.py\b|command line|Befehlszeile"
)


def test_no_text_of_the_window_itself_speaks_command_line():
    texts = ElementTree.parse(FOLDER / "reflight_de.ts").getroot().iter("context")
    spoken = [
        text
        for context in texts
        if context.findtext("name") != "Sentences"
        for message in context.iter("message")
        for text in (message.findtext("source"), message.findtext("translation"))
        if text and COMMAND_LINE.search(text)
    ]
    assert spoken == []


def test_every_option_that_the_import_may_name_has_a_field():
    sources = [*(ROOT / "planning" / "site" / "importing").glob("*.py"), *(ROOT / "planning" / "geo").glob("*.py")]
    named = {found for source in sources for found in re.findall(r"--[a-z][a-z-]+", source.read_text("utf-8"))}
    instead = {option for template in IN_WINDOW for option in re.findall(r"--[a-z][a-z-]+", template)}
    assert len(named) > 10
    # The window imports without panels, too: nobody is told that it can be asked for.
    assert named - instead - {"--without-panels"} <= set(OPTION_FIELDS)


def test_an_error_of_a_job_names_fields_and_buttons(application, context):
    heard = []
    context.messageShown.connect(heard.append)

    def work(_context):
        raise InfeasibleError(say("method 'pso' needs a number of views (--views N); it cannot look for the fewest"))

    context.start("Plan", work)
    turn_until(application, lambda: heard)
    assert heard[-1].text == (
        "Plan: the particle swarm needs a number of views (“Plan for”: number of views); it cannot look for the fewest"
    )
