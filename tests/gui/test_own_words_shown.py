"""Where findings, errors, stages and effects stand in the window, they stand in the user's language and units."""

import pytest
from PySide6.QtCore import QTranslator

from groundstation.gui.job_bar import JobBar
from groundstation.gui.languages import FOLDER
from groundstation.gui.mission.findings_list import FindingsList
from groundstation.gui.own_words import finding_in_own_words
from groundstation.gui.plan.effects_panel import EffectsPanel
from groundstation.gui.plan.method_names import method_name
from groundstation.gui.site.findings_list import FindingsList as SiteFindingsList
from groundstation.gui.workspace import Workspace
from groundstation.services.document import Document
from groundstation.services.effects import EffectChoice
from groundstation.services.jobs import JobRunner
from groundstation.services.session import Session
from groundstation.services.units import UnitSystem
from planning.checks.case import judge
from planning.effects import Decision
from planning.errors import InfeasibleError
from planning.findings import Finding, Severity
from planning.methods import METHODS
from tests.gui.driving import turn_until

TOO_CLOSE = judge(
    False,
    "leg-distance",
    "smallest distance along the path",
    *(3.048, 10.0, "m"),
    "sortie 2, leg 3",
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
def workspace(application):
    workspace = Workspace(Session(Document()), JobRunner())
    yield workspace
    workspace.close()


def test_pre_flight_findings_are_german_and_still_lead_to_their_place(german):
    shown, picked = FindingsList(), []
    shown.placePicked.connect(picked.append)
    shown.set_findings([TOO_CLOSE])
    assert shown.texts() == (
        "Fehler (leg-distance)\n"
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
    message = "home lies at -3.048 m, below the ground at 0 m; put it on the ground"
    shown = SiteFindingsList()
    shown.set_findings((Finding(Severity.WARNING, "home-below-ground", message, "home"),))
    shown.set_units(UnitSystem.IMPERIAL)
    assert shown._list.item(0).text() == (
        "Warnung: der Startplatz liegt bei -10.0 ft, unter dem Boden bei 0.0 ft; ihn auf den Boden setzen"
    )


def test_an_effect_says_in_german_what_it_is_and_why(german):
    reason = "something stands in front of 40 % of the panels"
    found = Decision("occlusion", True, "scene", reason, 12.0, 0.5, "% of the lines of sight", 0.1)
    panel = EffectsPanel()
    panel.set_effects((EffectChoice(found, "auto"),))
    assert panel.card("occlusion").text() == (
        "Verdeckung\nist an\nvor 40 % der Scheiben steht etwas\n"
        "Größe 12 % der Sichtlinien, Toleranz 0.5; kostet etwa 0.1 s"
    )


def test_the_stage_and_the_failure_of_a_job_are_german(german, application, workspace):
    bar, stages, messages = JobBar(workspace), [], []
    workspace.bridge.progressed.connect(lambda _event: stages.append(bar._label.text()))
    workspace.messageShown.connect(messages.append)

    def work(context):
        context.report("finding ways around", 0, 1)
        raise InfeasibleError("home_enu_m: home (0, 0, 3) lies inside a no-fly volume; move it outside")

    workspace.start("Planen", work)
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
    told = finding_in_own_words(TOO_CLOSE, UnitSystem.IMPERIAL)
    assert (told.value, told.limit, told.unit, told.severity, told.code) == (
        *(3.048, 10.0, "m"),
        *(TOO_CLOSE.severity, TOO_CLOSE.code),
    )
    assert told.place == "Einsatz 2, Strecke 3"
