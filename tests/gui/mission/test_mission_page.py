"""The Mission tab as a pilot uses it: check, jump, export, import, compare, brief."""

import time
from dataclasses import replace

import pytest

from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.session import Session
from groundstation.services.units import UnitSystem
from missions.formats.registry import read_missions
from missions.mission.export_choices import FileFormat
from planning.base.findings import Severity
from planning.planner import plan_flight
from planning.request import PlanRequest
from tests.gui.driving import choose, clicked, turn_until
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK


@pytest.fixture(scope="module")
def planned():
    model = kiosk()
    return model, plan_flight(model, PlanRequest(n_views=10, greedy=QUICK)).plan


@pytest.fixture
def context(application):
    from groundstation.gui.application.context import ApplicationContext

    runner = JobRunner()
    context = ApplicationContext(Session(), runner)
    yield context
    context.close()
    runner.shutdown()


@pytest.fixture
def page(application, context):
    from PySide6.QtWidgets import QHBoxLayout, QWidget

    from groundstation.gui.mission.mission_page import MissionPage
    from groundstation.gui.shared_view import SharedView

    window = QWidget()
    shared_view = SharedView(context, window)
    page = MissionPage(context, shared_view)
    layout = QHBoxLayout(window)
    for widget in (page.left, shared_view, page.right, page.bottom):
        layout.addWidget(widget)
    window.resize(1280, 600)
    window.show()
    page.shown()
    yield page
    shared_view.close_views()
    window.close()


@pytest.fixture
def idle(application, context):
    """Wait until no job runs and a condition holds; without one, until none is about to start either."""

    def wait(condition=None):
        end, calm = time.monotonic() + 240.0, 0
        while context.jobs() or (calm < 40 if condition is None else not condition()):
            assert time.monotonic() < end
            application.processEvents()
            time.sleep(0.01)
            calm = 0 if context.jobs() else calm + 1

    return wait


@pytest.fixture
def said(context):
    heard = []
    context.messageShown.connect(heard.append)
    return heard


def opened(planned, **changes):
    model, plan = planned
    entry = PlanEntry("plan-1", "First plan", replace(plan, **changes))
    return Document(site=model, plans=(entry,), current_plan_id="plan-1")


@pytest.mark.slow
def test_empty_page_says_what_to_do_first(page, context, planned):
    assert "Open or import a site first" in page._summary.text()
    assert [action.text() for action in page.actions() if action.isEnabled()] == ["Import mission files ..."]
    context.session.open(Document(site=planned[0]), None)
    assert "Plan a flight on the Plan tab" in page._summary.text()
    assert [action.text() for action in page.actions() if action.isEnabled()] == ["Import mission files ..."]


def test_a_plan_is_checked_by_itself_and_its_panels_are_counted(page, context, planned, idle):
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    assert page.findings.state_text() == ""
    model = page.lists.waypoints.model()
    row = model.row_of(Item(ItemKind.VIEWPOINT, planned[1].sorties[0].viewpoint_ids[0]))
    assert int(model.index(row, 11).data()) >= 1
    assert all(action.isEnabled() for action in page.actions())


@pytest.mark.long
def test_the_check_button_has_the_plan_proved_and_an_edit_takes_the_verdict_away(page, context, planned, idle):
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    assert page.findings.proof_text() == ""
    page.findings._check.click()
    idle(lambda: page.findings.proof_text().startswith("Proved by an independent check"))
    plan = replace(planned[1], method="orbit")
    context.change("Edit", context.document.with_plan(PlanEntry("plan-1", "First plan", plan)))
    idle(lambda: page.findings.proof_text() == "")


@pytest.mark.slow
def test_the_plan_tab_counts_the_warnings_that_the_mission_tab_counts(page, context, planned, idle):
    """One verdict: a place that is often just the city, and coverage far under what flights can cover."""
    from groundstation.gui.plan.plan_page import PlanPage

    plan_page = PlanPage(context, page._shared_view)
    model, plan = planned
    doubtful = replace(model, site=replace(model.site, place_from="ifc-site"))
    entry = PlanEntry("plan-1", "First plan", plan)
    context.session.open(Document(site=doubtful, plans=(entry,), current_plan_id="plan-1"), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly") and plan_page.verdict().startswith("Ready to fly"))
    n = sum(finding.severity is Severity.WARNING for finding in page._preflight.findings)
    assert n >= 1
    assert plan_page.verdict().splitlines()[0] == f"Ready to fly; warnings: {n}"


def test_only_the_list_in_sight_is_filled_and_none_while_the_tab_is_hidden(page, context, planned, idle, application):
    model = page.lists.waypoints.model()
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    n_rows = model.rowCount()
    assert n_rows > 10
    assert not page.lists.profile.plots()[0].listDataItems()
    page.lists.setCurrentWidget(page.lists.profile)
    assert page.lists.profile.plots()[0].listDataItems()
    page.hidden()
    context.amend(replace(context.document, plans=(), current_plan_id=""))
    assert page.sorties.model().rowCount() == 1
    page.shown()
    assert page.sorties.model().rowCount() == 0
    application.processEvents()
    assert not page.lists.profile.plots()[0].listDataItems()
    assert model.rowCount() == n_rows
    page.lists.setCurrentWidget(page.lists.waypoints)
    assert model.rowCount() == 0


def test_a_list_that_is_shown_later_knows_the_selection_and_the_panels(page, context, planned, idle):
    page.lists.setCurrentWidget(page.lists.comparison)
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    wanted = Item(ItemKind.VIEWPOINT, planned[1].sorties[0].viewpoint_ids[3])
    context.select(wanted)
    page.lists.setCurrentWidget(page.lists.waypoints)
    model = page.lists.waypoints.model()
    assert page.lists.waypoints.view().selectionModel().currentIndex().row() == model.row_of(wanted)
    assert int(model.index(model.row_of(wanted), 11).data()) >= 1
    page.lists.setCurrentWidget(page.lists.profile)
    assert [mark.isVisible() for mark in page.lists.profile._marks] == [True, True]


def test_files_are_taken_in_the_order_of_their_sorties(page, context, planned, monkeypatch, tmp_path):
    context.session.open(opened(planned), None)
    names = [tmp_path / name for name in ("roof-2.plan", "roof-3.plan", "roof.plan")]
    for path in names:
        path.touch()
    heard = []
    monkeypatch.setattr(page.controller, "import_files", heard.extend)
    with clicked(choose(*names)):
        page._import.trigger()
    assert [path.name for path in heard] == ["roof.plan", "roof-2.plan", "roof-3.plan"]


@pytest.mark.slow
def test_findings_are_old_as_soon_as_the_plan_changes_and_then_renewed(page, context, planned, idle):
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    far = replace(planned[1].constraints, min_distance_m=30.0)
    context.change("Farther", opened(planned, constraints=far))
    assert page.findings.verdict() == "Readiness not known"
    assert "Older than the plan" in page.findings.state_text()
    idle(lambda: page.findings.verdict() == "NOT ready to fly")
    context.session.undo()
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))


@pytest.mark.long
def test_hidden_tabs_do_not_check(page, context, planned, idle):
    page.hidden()
    context.session.open(opened(planned), None)
    idle()
    assert page.findings.verdict() == "Readiness not known"
    page.shown()
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))


@pytest.mark.long
def test_cancelling_the_check_leaves_the_page_usable(page, context, planned, idle, application):
    context.session.open(opened(planned), None)
    turn_until(application, context.jobs)
    context.cancel(context.jobs()[0])
    idle()
    if not page.findings.verdict().startswith("Ready to fly"):
        page.controller.check()
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))


def test_places_of_findings_lead_to_their_things(page, context, planned, said):
    context.session.open(opened(planned), None)
    looked = []
    context.lookAtRequested.connect(looked.append)
    page.findings.placePicked.emit("sortie 1, leg 2")
    page.findings.placePicked.emit(planned[1].viewpoints[3].id)
    assert looked == [Item(ItemKind.LEG, "1/2"), Item(ItemKind.VIEWPOINT, planned[1].viewpoints[3].id)]
    page.findings.placePicked.emit("template.kml")
    assert "template.kml is not shown" in said[-1].text


def test_headings_that_are_filled_again_leave_nothing_that_pyside_takes_for_something_else(planned, application):
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QStandardItem
    from shiboken6 import getAllValidWrappers

    from groundstation.gui.mission.mission_lists import SortieTable

    def n_items():
        return sum(type(each) is QStandardItem for each in getAllValidWrappers())

    table = SortieTable()
    table.set_plan(planned[1])
    before = n_items()
    for _ in range(20):
        table.set_plan(planned[1])
    tips = [
        table.model().headerData(column, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole) for column in range(5)
    ]
    assert [bool(tip) for tip in tips] == [False, False, True, True, True]
    assert n_items() == before
    table.set_plan(None)
    table.deleteLater()


def test_selection_goes_through_table_and_chart_and_back(page, context, planned, application):
    context.session.open(opened(planned), None)
    application.processEvents()
    heard = []
    context.selectionChanged.connect(heard.append)
    wanted = Item(ItemKind.VIEWPOINT, planned[1].sorties[0].viewpoint_ids[4])
    page.lists.waypoints.view().selectRow(page.lists.waypoints.model().row_of(wanted))
    assert heard == [wanted]
    other = Item(ItemKind.VIEWPOINT, planned[1].sorties[0].viewpoint_ids[1])
    context.select(other)
    assert heard == [wanted, other]
    table = page.lists.waypoints
    assert table.view().selectionModel().currentIndex().row() == table.model().row_of(other)
    page.lists.setCurrentWidget(page.lists.profile)
    assert [mark.isVisible() for mark in page.lists.profile._marks] == [True, True]


@pytest.mark.slow
def test_export_shows_findings_first_then_writes_and_remembers_the_folder(page, context, planned, idle, said, tmp_path):
    context.session.open(opened(planned), None)
    dialog = page.export()
    idle(lambda: dialog.prepared() is not None)
    assert dialog.prepared().can_be_written
    assert not list(tmp_path.iterdir())
    dialog.write(tmp_path / "kiosk.kmz")
    idle(lambda: (tmp_path / "kiosk.kmz").exists())
    assert read_missions(tmp_path / "kiosk.kmz")[0].n_photos == 10
    assert said[-1].severity is Severity.OK
    again = page.export()
    assert again.folder() == tmp_path
    idle()
    again.close()


@pytest.mark.slow
def test_closed_dialogs_leave_the_window_also_while_their_jobs_run(page, context, planned, idle):
    from PySide6.QtCore import QCoreApplication, QEvent

    from groundstation.gui.mission.brief_printer import BriefDialog
    from groundstation.gui.mission.export_dialog import ExportDialog

    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    page.export().reject()
    page.print_brief()
    window = page._shared_view.window()
    window.findChildren(BriefDialog)[-1].reject()
    idle()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    assert window.findChildren(ExportDialog) == []
    assert window.findChildren(BriefDialog) == []


def test_export_says_why_files_cannot_be_made_and_offers_no_writing(page, context, planned, idle):
    sortie = planned[1].sorties[0]
    lost = next(view for view in planned[1].viewpoints if view.id == sortie.viewpoint_ids[3])
    path = tuple(point for point in sortie.path_enu_m if point != lost.position_enu_m)
    context.session.open(opened(planned, sorties=(replace(sortie, path_enu_m=path),)), None)
    dialog = page.export()
    idle(lambda: dialog.prepared() is not None)
    assert f"Cannot be exported: sortie 1: viewpoint '{lost.id}' is not on the path" in dialog.state_text()
    assert not dialog._action.isEnabled()
    dialog.close()


@pytest.mark.slow
def test_only_the_last_wish_of_the_export_form_is_made(page, context, planned, idle):
    context.session.open(opened(planned), None)
    dialog = page.export()
    for index in (1, 2, 3, 4):
        dialog.form()._format.setCurrentIndex(index)
        assert dialog.prepared() is None
        assert not dialog._action.isEnabled()
    idle(lambda: dialog.prepared() is not None)
    assert dialog.prepared().encoded.contents[0].startswith(b"sortie,sequence")
    dialog.close()


@pytest.mark.long
def test_a_folder_that_cannot_be_written_is_told_in_the_dialog(page, context, planned, idle, tmp_path):
    context.session.open(opened(planned), None)
    dialog = page.export()
    idle(lambda: dialog.prepared() is not None)
    dialog.write(tmp_path / "none" / "kiosk.kmz")
    idle(lambda: "Not written" in dialog.state_text())
    assert "there is no folder" in dialog.state_text()
    dialog.close()


def test_every_choice_of_the_export_form_comes_back(application):
    from groundstation.gui.mission.export_dialog import ExportForm
    from missions.formats.options import ExportOptions
    from missions.mavlink.autopilots import Autopilot
    from missions.mission.export_choices import HeightReference, LinkLoss

    form = ExportForm(UnitSystem.METRIC)
    heard = []
    form.valueChanged.connect(lambda: heard.append(form.value()))
    for value in (
        (FileFormat.DJI_KMZ, ExportOptions(HeightReference.ELLIPSOID, None, LinkLoss.GO_HOME, 75.0)),
        (FileFormat.MAVLINK_PLAN, ExportOptions(HeightReference.AMSL, Autopilot.PX4)),
        (FileFormat.MAVLINK_WPL, ExportOptions(HeightReference.ABOVE_TAKEOFF, Autopilot.ARDUPILOT)),
        (FileFormat.KML, ExportOptions()),
        (FileFormat.CSV, ExportOptions()),
    ):
        form.setValue(*value)
        assert form.value() == value
    assert heard == []
    form._format.setCurrentIndex(1)
    assert heard[-1][0] == FileFormat.MAVLINK_PLAN


@pytest.mark.slow
def test_import_makes_a_plan_that_undo_takes_away(page, context, planned, idle, said, tmp_path):
    from groundstation.services.mission.files import prepare_export, write_export

    model, plan = planned
    path = tmp_path / "flown.kmz"
    write_export(prepare_export(plan, model, FileFormat.DJI_KMZ), path)
    context.session.open(Document(site=model), None)
    page.controller.import_files([path])
    idle(lambda: context.document.current is not None)
    entry = context.document.current
    assert (entry.title, entry.plan.method, len(entry.plan.viewpoints)) == ("flown", "imported", 10)
    assert any("flown imported, photos: 10" in message.text for message in said)
    idle()
    context.session.undo()
    assert context.document.plans == ()


@pytest.mark.long
def test_a_mission_without_a_site_brings_a_bare_one_of_its_own(page, context, idle, said, shared_data):
    context.session.open(Document(), None)
    page.controller.import_files([shared_data / "missions" / "geoyee_m3d_curtainwall_slope_mapping2d.kmz"])
    idle(lambda: context.document.current is not None)
    idle()
    site, plan = context.document.site.site, context.document.current.plan
    assert (site.n_panels, site.building_mesh) == (0, None)
    assert plan.site_sha256 == context.document.site.sha256
    assert len(plan.viewpoints) == 46
    assert len(plan.sorties[0].in_passing_ids) == 46
    assert not [message.text for message in said if message.severity is Severity.ERROR]
    page.controller.check()
    idle()
    context.session.undo()
    assert context.document.site is None


@pytest.mark.long
def test_files_that_are_no_missions_are_refused_by_name(page, context, planned, idle, said, tmp_path):
    bad = tmp_path / "holiday.kmz"
    bad.write_bytes(b"PK not a zip")
    context.session.open(opened(planned), None)
    idle()
    page.controller.import_files([bad])
    page.controller.compare_files([bad])
    idle()
    errors = [message.text for message in said if message.severity is Severity.ERROR]
    assert len(errors) == 2
    assert all("holiday.kmz" in text for text in errors)
    assert len(context.document.plans) == 1


def test_compare_answers_and_leads_to_the_photos_that_differ(page, context, planned, idle, tmp_path):
    from groundstation.services.mission.files import prepare_export, write_export

    model, plan = planned
    path = tmp_path / "kiosk.plan"
    write_export(prepare_export(plan, model, FileFormat.MAVLINK_PLAN), path)
    context.session.open(opened(planned), None)
    page.controller.compare_files([path])
    idle(lambda: "kiosk.plan is the plan: all 10 photos" in page.lists.comparison.answer())
    assert page.lists.currentWidget() is page.lists.comparison
    assert page.lists.comparison.table().model().rowCount() == 0
    first = plan.sorties[0].viewpoint_ids[0]
    turned = tuple(replace(v, heading_deg=v.heading_deg - 3.0) if v.id == first else v for v in plan.viewpoints)
    context.change("Turn", opened(planned, viewpoints=turned))
    assert "Compare with file" in page.lists.comparison.answer()
    page.controller.compare_files([path])
    idle(lambda: "NOT the plan: 9 photos the same, 1 changed" in page.lists.comparison.answer())
    rows = page.lists.comparison.table().model()
    assert [rows.index(0, c).data() for c in (0, 1, 5)] == ["changed", first, "3.0"]
    heard = []
    page.lists.comparison.picked.connect(heard.append)
    page.lists.comparison.table().clicked.emit(rows.index(0, 3))
    assert heard == [Item(ItemKind.VIEWPOINT, first)]


def test_all_photos_in_another_order_are_neither_the_plan_nor_strangers(page, context, planned, idle, tmp_path):
    from groundstation.services.mission.files import prepare_export, write_export

    model, plan = planned
    path = tmp_path / "kiosk.plan"
    write_export(prepare_export(plan, model, FileFormat.MAVLINK_PLAN), path)
    backwards = tuple(
        replace(sortie, viewpoint_ids=sortie.viewpoint_ids[::-1], path_enu_m=sortie.path_enu_m[::-1])
        for sortie in plan.sorties
    )
    context.session.open(opened(planned, sorties=backwards), None)
    page.controller.compare_files([path])
    idle(lambda: "takes all 10 photos of the plan, but flies otherwise" in page.lists.comparison.answer())
    assert "NOT the plan" not in page.lists.comparison.answer()


@pytest.mark.slow
def test_brief_is_shown_and_saved(page, context, planned, idle, tmp_path):
    from groundstation.gui.mission.brief_printer import BriefDialog

    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    page.print_brief()
    (dialog,) = page._shared_view.window().findChildren(BriefDialog)
    idle(dialog.is_ready)
    assert "Flight brief: kiosk" in dialog.page_text()
    assert "First plan" in dialog.page_text()
    assert dialog.save_pdf(tmp_path / "brief.pdf")
    assert (tmp_path / "brief.pdf").read_bytes().startswith(b"%PDF")
    assert not dialog.save_pdf(tmp_path / "none" / "brief.pdf")
    dialog.close()


def test_units_reach_every_part(page, context, planned, idle):
    context.session.open(opened(planned), None)
    idle(lambda: page.findings.verdict().startswith("Ready to fly"))
    page.findings.show_severity(Severity.OK, True)
    context.set_units(UnitSystem.IMPERIAL)
    assert "[ft]" in page.lists.waypoints.model().headerData(5, _horizontal())
    assert page.sorties.model().headerData(3, _horizontal()) == "mi"
    assert any(" ft" in text for text in page.findings.list_view().texts())
    assert "[ft]" in page.lists.profile.plots()[0].getAxis("left").labelText


def _horizontal():
    from PySide6.QtCore import Qt

    return Qt.Orientation.Horizontal


def test_chart_draws_each_sortie_and_picks_the_nearest_photo(application):
    from PySide6.QtCore import QPointF

    from groundstation.gui.charts.profile_chart import ProfileChart
    from groundstation.services.mission.waypoints import height_limits, plan_profiles

    plan = example_plan()
    chart = ProfileChart()
    chart.resize(900, 250)
    chart.show()
    application.processEvents()
    chart.set_curves(plan_profiles(plan), height_limits(kiosk()))
    application.processEvents()
    extra = f"take-off and landing add {plan.rules.takeoff_landing_s:.0f} s"
    assert extra in chart.plots()[0].getAxis("bottom").labelText
    heard = []
    chart.picked.connect(heard.append)
    for viewpoint_id in ("v0008", "v0002"):
        chart.set_selection(Item(ItemKind.VIEWPOINT, viewpoint_id))
        application.processEvents()
        mark = chart._marks[0].value()
        scene = chart.plots()[0].vb.mapViewToScene(QPointF(mark, 10.0))
        chart._pointed(scene)
        assert f"nearest photo {viewpoint_id}" in chart.hover_text()
        chart._clicked(scene)
        assert heard.pop() == Item(ItemKind.VIEWPOINT, viewpoint_id)
    chart._over.setCurrentIndex(1)
    application.processEvents()
    assert "take-off" not in chart.plots()[0].getAxis("bottom").labelText
    end = chart.plots()[0].vb.viewRange()[0][1]
    assert end == pytest.approx(plan.sorties[0].length_m, rel=0.02)
    chart.set_curves((), None)
    assert "plan a flight first" in chart.hover_text()
    chart.close()


def test_times_of_sorties_say_that_take_off_and_landing_are_in_them(application):
    from groundstation.gui.mission.mission_lists import SortieTable

    table = SortieTable()
    plan = example_plan()
    table.set_plan(replace(plan, rules=replace(plan.rules, takeoff_landing_s=45.0)))
    assert "With 45 s for take-off and landing" in table.model().headerData(2, _horizontal(), _tool_tip())
    table.set_plan(None)
    assert table.model().headerData(2, _horizontal(), _tool_tip()) is None


def _tool_tip():
    from PySide6.QtCore import Qt

    return Qt.ItemDataRole.ToolTipRole
