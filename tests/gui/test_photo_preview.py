"""The camera preview as photographed: in step with plan, selection and light, one picture at a time, never unseen."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from PySide6.QtCore import QDateTime, Qt
from PySide6.QtTest import QTest

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.camera_preview.photo_box import LightBox
from groundstation.gui.camera_preview.preview import panel_lines
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.view3d.orbit import pinhole_at
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.session import Session
from groundstation.services.scenes import preview as photo_preview
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.sun import sun_place_deg
from planning.plan import Coverage, Plan
from planning.site.bundled import office
from planning.site.records import SiteModel
from reconstruction.scenes.world.look import Look
from tests.gui.application.test_context import Gate
from tests.gui.driving import TurnGaps, turn_until
from tests.gui.test_camera_preview import POSES, made_plan
from tests.gui.window.test_main_window import QUICK, controller, opened, planned

__all__ = ["controller"]

ALONE = Look(near=False)


class Hands:
    """A stage with a plan in the camera preview, small enough for quick pictures."""

    def __init__(self, application, runner):
        self.application = application
        self.context = ApplicationContext(
            Session(Document(site=office()).with_plan(PlanEntry("p", "P", plan()))), runner
        )
        self.shared_view = SharedView(self.context)
        self.shared_view.resize(420, 240)
        self.shared_view.show()
        QTest.qWaitForWindowExposed(self.shared_view)
        self.shared_view.show_page(SharedViewPage.CAMERA)
        self.preview, self.controller = self.shared_view.camera_page(), self.shared_view.photo_controller
        self.preview.box.light.setValue(ALONE)
        self.asked, self.names = [], []
        self.context.jobsChanged.connect(lambda: self.names.extend(job.name for job in self.context.jobs()))

    def select(self, viewpoint_id):
        self.context.select(Item(ItemKind.VIEWPOINT, viewpoint_id))

    def change(self, found):
        document = self.context.document
        self.context.change("edit", document.with_plan(replace(document.current, plan=found)))

    def until_photo(self, is_fine=True):
        turn_until(self.application, lambda: self.is_shown(is_fine))
        return self.controller.shown()

    def until_rest(self):
        turn_until(self.application, lambda: self.controller.is_at_rest() and not self.context.jobs())

    def is_shown(self, is_fine):
        shown = self.controller.shown()
        assert "could not" not in self.preview.note()
        if shown is None or not is_fine:
            return shown is not None
        return not shown.request.is_quick and self.controller.is_at_rest()

    def close(self):
        self.context.close()
        self.shared_view.close_views()
        self.shared_view.deleteLater()
        self.application.processEvents()


def plan() -> Plan:
    return replace(made_plan(POSES[:3]), coverage=Coverage(0, 0, 0))


@pytest.fixture
def hands(application, monkeypatch):
    photo_preview._LAST.clear()
    # Small pictures, and still a coarse one before each fine one.
    monkeypatch.setattr(photo_preview, "QUICK_WIDTHS_PX", (32, 64))
    runner = JobRunner()
    hands = Hands(application, runner)
    yield hands
    hands.close()
    runner.shutdown()
    photo_preview._LAST.clear()


def east_of(photo):
    return photo.request.view.position_enu_m[0]


@pytest.mark.slow
def test_a_coarse_picture_comes_first_then_a_fine_one_with_its_effects(hands):
    assert hands.controller.shown() is None
    hands.preview.box.photo.click()
    assert hands.until_photo(is_fine=False).request.is_quick
    fine = hands.until_photo()
    assert fine.request.width_px > 100
    assert hands.preview.note() == ""
    effects = hands.controller.effects_window()
    assert "near-field reflection" in effects.text()
    assert f"{fine.request.width_px} x" in effects._words.text()
    hands.preview.box.lines.click()
    assert hands.controller.shown() is None
    assert effects.text() == ""
    # Seen again, it is not rendered again.
    n_jobs = len(hands.names)
    hands.preview.box.photo.click()
    assert hands.controller.shown() is fine
    hands.until_rest()
    assert len(hands.names) == n_jobs


@pytest.mark.long
def test_a_newer_viewpoint_takes_the_place_of_an_older_one(hands):
    hands.preview.box.photo.click()
    turn_until(hands.application, lambda: bool(hands.context.jobs()))
    hands.select("v0001")
    assert hands.controller.shown() is None
    hands.select("v0002")
    assert east_of(hands.until_photo(is_fine=False)) == POSES[2][0][0]


@pytest.mark.slow
def test_edits_undo_and_the_light_are_followed(hands):
    hands.preview.box.photo.click()
    hands.select("v0001")
    before = hands.until_photo()
    found = plan()
    moved = replace(found.viewpoints[1], position_enu_m=(11.0, -18.0, 30.0))
    hands.change(replace(found, viewpoints=(found.viewpoints[0], moved, found.viewpoints[2])))
    assert hands.controller.shown() is None
    assert east_of(hands.until_photo(is_fine=False)) == 11.0
    hands.context.session.undo()
    assert hands.controller.shown() is before
    hands.preview.box.light._heading.setValue(100.0)
    turned = hands.until_photo()
    assert turned.request.look == replace(ALONE, sun_heading_deg=100.0)
    # What changes nothing in the picture renders nothing.
    hands.until_rest()
    n_jobs = len(hands.names)
    hands.change(replace(plan(), seed=7))
    hands.context.set_units(UnitSystem.IMPERIAL)
    hands.until_rest()
    assert hands.controller.shown() is turned
    assert len(hands.names) == n_jobs


@pytest.mark.slow
def test_nothing_is_rendered_while_nobody_looks_or_a_flight_plays(hands):
    hands.preview.box.photo.click()
    hands.shared_view.show_page(SharedViewPage.MAP)
    hands.select("v0001")
    hands.until_rest()
    assert hands.names == []
    hands.shared_view.show_page(SharedViewPage.CAMERA)
    hands.until_photo(is_fine=False)
    hands.preview.play(20)
    assert hands.controller.shown() is None
    hands.until_rest()
    n_jobs = len(hands.names)
    turn_until(hands.application, lambda: hands.preview.time_s() > 1.0)
    assert len(hands.names) == n_jobs
    hands.preview.pause()
    at = hands.until_photo(is_fine=False).request.view.position_enu_m
    assert at == pytest.approx(tuple(hands.preview.pinhole().eye_enu_m))
    hands.shared_view.hide()
    hands.until_rest()
    assert hands.controller.shown() is None


@pytest.mark.slow
def test_other_work_comes_first(hands):
    gate = Gate()
    hands.context.start("Something else", gate)
    hands.preview.box.photo.click()
    turn_until(hands.application, lambda: "Something else" in hands.preview.note())
    assert [job.name for job in hands.context.jobs()] == ["Something else"]
    gate.open.set()
    hands.until_photo(is_fine=False)
    # What the user starts meanwhile need not wait for the fine picture.
    order = []
    hands.context.start("An edit", lambda _context: None, lambda _result: order.append(hands.is_shown(True)))
    hands.until_photo()
    assert order == [False]


@pytest.mark.slow
def test_what_fails_is_told_in_its_place_once_and_tried_again_when_asked(hands, monkeypatch):
    def fails(*_given, **_reporting):
        raise InputError("the site has no panels yet: find them")

    with monkeypatch.context() as patched:
        patched.setattr("groundstation.gui.camera_preview.photo_controller.cached_photo", fails)
        hands.preview.box.photo.click()
        turn_until(hands.application, lambda: "could not be rendered" in hands.preview.note())
        hands.until_rest()
        assert hands.names.count("Render the photo") == 1
    hands.preview.box.photo.click()
    hands.until_photo(is_fine=False)


@pytest.mark.slow
def test_a_photo_that_was_cancelled_stays_away_until_it_is_asked_for(hands, monkeypatch):
    gate = Gate()
    with monkeypatch.context() as patched:
        patched.setattr(
            "groundstation.gui.camera_preview.photo_controller.cached_photo",
            lambda _request, **reporting: gate(reporting["monitor"]),
        )
        hands.preview.box.photo.click()
        turn_until(hands.application, gate.begun.is_set)
        hands.context.cancel(hands.context.jobs()[0])
        turn_until(hands.application, lambda: "cancelled" in hands.preview.note())
        hands.until_rest()
    assert hands.controller.shown() is None
    hands.preview.box.photo.click()
    hands.until_photo(is_fine=False)


def test_a_site_that_has_lost_its_panels_says_so_and_renders_nothing(hands):
    hands.preview.box.photo.click()
    model = hands.context.document.site
    bare = SiteModel(replace(model.site, facades=()), model.building, model.obstacles)
    hands.context.change("edit", replace(hands.context.document, site=bare))
    turn_until(hands.application, lambda: "no panels yet" in hands.preview.note())
    hands.until_rest()
    assert hands.controller.shown() is None
    assert hands.names == []


@pytest.mark.slow
def test_outlines_lie_over_the_photo_where_they_are_wanted(hands):
    hands.preview.box.photo.click()
    hands.until_photo()
    plain = hands.preview.screenshot().astype(int)
    hands.preview.box.outlines.click()
    outlined = hands.preview.screenshot().astype(int)
    assert (plain != outlined).any(axis=2).mean() > 0.02
    # The colour of what a view covers.
    assert ((outlined[:, :, 0] > 170) & (outlined[:, :, 2] < 90)).sum() > 200
    hands.preview.box.outlines.click()
    assert (hands.preview.screenshot() == plain).all()


@pytest.mark.slow
def test_the_space_bar_presses_the_button_that_has_the_keyboard(hands):
    hands.preview.box.photo.setFocus()
    QTest.keyClick(hands.preview.box.photo, Qt.Key.Key_Space)
    assert hands.preview.box.value()
    assert not hands.preview.is_playing()
    hands.until_photo(is_fine=False)


# The light


def test_the_light_is_said_by_direction_or_by_time(application):
    box, heard = LightBox(), []
    box.valueChanged.connect(heard.append)
    assert box.value() == Look()
    look = replace(Look(street_m=40.0), sun_heading_deg=-90.0, sun_elevation_deg=10.0)
    box.setValue(look)
    box.set_origin(Origin(48.0, 11.0, 500.0))
    assert heard == []
    assert box.value() == look
    box.set_time(QDateTime.fromString("2026-06-21T12:15:00", Qt.DateFormat.ISODate))
    assert heard == []
    wanted = sun_place_deg(48.0, 11.0, datetime(2026, 6, 21, 12, 15).astimezone())
    found = box.value()
    assert found.street_m == 40.0
    assert np.array([found.sun_heading_deg, found.sun_elevation_deg]) == pytest.approx([wanted[0] % 360.0, wanted[1]])
    box.set_origin(Origin(-40.0, 11.0, 0.0))
    assert heard[-1].sun_elevation_deg < found.sun_elevation_deg
    box._by.setCurrentIndex(0)
    box._elevation.setValue(-5.0)
    assert "below the horizon" in box._words.text()
    box._near.click()
    assert heard[-1] == replace(box.value(), near=False)


# Outlines


def test_lines_join_the_projected_corners_and_end_before_the_camera():
    rng = np.random.default_rng(5)
    view = pinhole_at(np.array([1.0, 2.0, 3.0]), 0.3, -0.1, (0.7, 0.5), (400.0, 300.0))
    corners = rng.uniform(-20.0, 20.0, (200, 4, 3))
    lines = panel_lines(corners, view)
    assert np.isfinite(lines).all()
    pixels, depths = view.project(corners)
    is_before = (depths > 0.1).all(axis=1)
    wanted = np.concatenate([pixels[is_before], np.roll(pixels[is_before], -1, axis=1)], axis=2).reshape(-1, 4)
    shown = {tuple(line) for line in lines.round(6).tolist()}
    assert {tuple(line) for line in wanted.round(6).tolist()} <= shown
    behind = corners[(depths < 0.0).all(axis=1)]
    assert len(behind) > 2
    assert len(panel_lines(behind, view)) == 0
    # A line that runs past the camera points where its visible part points.
    crossing = panel_lines(corners[~is_before & (depths > 0.1).any(axis=1)], view)
    assert len(crossing) > 50


@pytest.mark.alone
def test_the_window_answers_within_50_ms_while_photos_are_rendered(application, controller):
    """What a job's thread does now and then counts, so the best of a few photos is taken."""
    opened(application, controller, "office")
    planned(application, controller, QUICK)
    views = controller.context.document.current.plan.viewpoints
    shared_view = controller.window.shared_view
    shared_view.show_page(SharedViewPage.CAMERA)
    gaps, longest_ms = TurnGaps(), []
    shared_view.camera_page().box.photo.click()
    for view in views[:6]:
        controller.context.select(Item(ItemKind.VIEWPOINT, view.id))
        application.processEvents()
        gaps.start()
        turn_until(
            application,
            lambda: shared_view.photo_controller.shown() is not None and shared_view.photo_controller.is_at_rest(),
        )
        longest_ms.append(gaps.longest_ms())
        if longest_ms[-1] < 50.0:
            return
    pytest.fail(f"longest gaps of {len(longest_ms)} photos: {longest_ms} ms")
