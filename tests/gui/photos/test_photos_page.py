"""The Photos tab in the real window: reading, looking, correcting by hand, taking over."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QDialogButtonBox, QLineEdit

from groundstation.services.photos.coarse import UnsizedCoarse
from groundstation.services.photos.intake import PhotoMark
from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.steps import Act
from groundstation.services.site.edits import HeightReference, set_origin
from planning.aircraft.catalogue import profile
from planning.base.findings import Severity
from planning.parameters import Constraints
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.viewpoints.prepare import prepare
from reconstruction.scenes.photos.flight_views import planned_shots
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.flight_worth import photograph
from tests.gui.driving import choose, click_on, clicked, escape, press, turn_until, turn_until_idle, type_into
from tests.gui.photos.photos_tab import PhotosTab
from tests.services.photo_cases import site_model


def middle(grid, row, column):
    from groundstation.services.photos.grid_edits import cell_middle

    return cell_middle(grid, row, column)


def test_a_folder_is_read_and_each_photo_has_its_marks(page):
    cards = page.tab.controller.cards
    assert len(cards) == 3
    assert PhotoMark.CUT_OFF in cards[2].marks
    assert not cards[0].marks
    assert page.tab.strip.model().rowCount() == 3
    assert "2 of them usable" in page.tab.coverage.text()
    assert page.tab.find.isEnabled()
    assert not page.tab.use.isEnabled()


def test_the_first_photo_is_shown_and_a_finding_leads_to_its_own(page):
    assert page.tab.pane.card() is page.tab.controller.cards[0]
    assert page.view.picture().levels[0].width() == 800
    page.tab.findings.placePicked.emit(str(page.tab.controller.cards[1].path))
    page.idle()
    assert page.tab.pane.card() is page.tab.controller.cards[1]
    assert page.view.picture().path == page.tab.controller.cards[1].path


def test_a_damaged_photo_says_why_it_is_not_shown(page):
    page.tab.strip.choose(2)
    page.idle()
    assert page.view.picture() is None
    assert any("cut off" in message.text for message in page.messages if message.severity is Severity.ERROR)


def test_a_folder_without_photos_is_refused_in_words(page, tmp_path):
    for no in ("Cancel", escape):
        with clicked(no):
            page.tab.choose.click()
        assert len(page.tab.controller.cards) == 3
    with clicked(choose(tmp_path)):
        page.tab.choose.click()
    page.idle()
    assert any("holds no .jpg photo" in message.text for message in page.messages)
    assert len(page.tab.controller.cards) == 3


def test_a_place_on_the_map_chooses_its_photo(page):
    found = []
    page.tab.map.chosen.connect(found.append)
    spot = page.tab.map._at(page.tab.map._places[1]).toPoint()
    QTest.mouseClick(page.tab.map, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, spot)
    assert found == [1]
    assert page.tab.pane.card() is page.tab.controller.cards[1]


@pytest.mark.few(1)
@pytest.mark.parametrize("is_rectified", [False, True])
def test_a_line_is_dragged_in_both_views_and_the_facade_solved_again(found, is_rectified):
    if is_rectified:
        found.tab.pane.rectified.click()
        found.idle()
    before = [line.position_m for line in found.draft.facade("A").columns]
    line, y = found.grid.columns[4].position_px, middle(found.grid, 1, 4)[1]
    to = 0.7 * line + 0.3 * found.grid.columns[5].position_px
    found.drag(found.at((line, y)), found.at((to, y)))
    after = [line.position_m for line in found.draft.facade("A").columns]
    assert not found.draft.unsolved
    assert after[4] - before[4] == pytest.approx(0.3 * (before[5] - before[4]), abs=0.06)
    assert found.tab.controller.undo_label == "Move line"
    found.tab.tools.undo.click()
    found.idle()
    assert [line.position_m for line in found.draft.facade("A").columns] == before
    assert found.tab.tools.redo.isEnabled()


@pytest.mark.slow
def test_panels_and_lines_come_and_go_by_a_press(found):
    found.use_tool("PANEL")
    found.press(middle(found.grid, 2, 3))
    assert len(found.draft.facade("A").panels) == 29
    assert "no panel" in found.view.words_at(found.view.place_of(middle(found.grid, 2, 3)))
    found.press(middle(found.grid, 2, 3))
    assert len(found.draft.facade("A").panels) == 30
    found.use_tool("ADD_ROW")
    found.press(middle(found.grid, 1, 3))
    assert len(found.draft.facade("A").panels) == 40
    found.use_tool("REMOVE_LINE")
    found.press((middle(found.grid, 1, 0)[0], found.grid.rows[2].position_px))
    assert len(found.draft.facade("A").panels) == 30
    found.use_tool("MOVE")


@pytest.mark.slow
def test_a_press_beside_everything_moves_the_picture_and_changes_nothing(found):
    draft, corner = found.draft, found.view.to_picture(found.view.rect().center().toPointF())
    found.view.zoom_by(2.0)
    start = QPoint(3, 3)
    found.drag(start, start + QPoint(40, 20))
    assert found.draft is draft
    assert (found.view.to_picture(found.view.rect().center().toPointF()) - corner).x() < 0
    found.view.show_whole()


@pytest.mark.slow
def test_used_panels_replace_those_of_the_site_and_undo_brings_them_back(found):
    found.tab.use.click()
    found.idle()
    context = found.controller.context
    assert [len(facade.panels) for facade in context.document.site.site.facades] == [30]
    assert found.controller.window.shown_tab() == "site"
    assert context.selection.id == "A"
    assert "of 1080 sections" in found.tab.coverage.text()
    context.session.undo()
    assert [facade.id for facade in context.document.site.site.facades] == ["X"]
    assert found.draft is not None


@pytest.mark.slow
def test_another_site_clears_the_photos(found):
    found.controller.context.session.open(Document(), None)
    assert found.tab.controller.cards == ()
    assert found.draft is None
    assert not found.tab.read.isEnabled()


@pytest.mark.slow
def test_photos_stay_when_the_site_is_saved_and_go_when_it_moves(found):
    context = found.controller.context
    model = context.document.site
    anew = replace(model, building=site_model().building)
    context.session.amend(replace(context.document, site=anew))
    assert len(found.tab.controller.cards) == 3
    moved = set_origin(anew, 22.34, 114.2636, 62.0, HeightReference.ELLIPSOID)
    context.change("Move", replace(context.document, site=moved))
    assert found.tab.controller.cards == ()


@pytest.mark.slow
def test_photos_that_were_read_for_another_site_are_not_shown(page):
    folder = page.tab.controller.folder
    page.controller.context.session.open(Document(), None)
    page.controller.context.session.open(Document(site_model()), None)
    page.tab.controller.read(folder)
    page.controller.context.session.open(Document(), None)
    page.idle()
    assert page.tab.controller.cards == ()


@pytest.mark.slow
def test_a_new_window_shows_the_same_photos(application, found):
    from groundstation.services.settings import Language

    before = found.draft
    found.controller.choose(language=Language.GERMAN)
    turn_until(application, lambda: found.controller.window.shared_view.scene() is not None)
    found.controller.window.show_tab("photos")
    found.tab = found.controller.window.tab("photos")
    found.idle()
    assert found.draft is before
    assert found.tab.strip.model().rowCount() == 3
    found.controller.choose(language=Language.ENGLISH)
    turn_until(application, lambda: found.controller.window.shared_view.scene() is not None)


@pytest.mark.slow
def test_a_data_set_is_made_of_the_photos_and_what_was_left_out_is_said(application, page, controller, tmp_path):
    assert page.tab.data_set.isEnabled()
    with clicked(choose(tmp_path / "new")):
        click_on(controller.window, page.tab.data_set)
    page.idle()
    assert (tmp_path / "new" / "dataset.json").is_file()
    said = [message.text for message in page.messages]
    assert any("The data set is written" in text for text in said), said
    assert any("cannot be decoded; it was left out" in text for text in said), said


@pytest.mark.slow
def test_a_coarse_model_is_asked_for_by_its_button_and_what_is_wrong_is_said(page, controller, folder, tmp_path):
    few = tmp_path / "few"
    few.mkdir()
    for path in sorted(folder.iterdir())[:2]:
        shutil.copy(path, few)
    with clicked(choose(few), choose(tmp_path / "coarse")):
        click_on(controller.window, page.tab.coarse)
    page.idle()
    assert any("at least 3 photos, got 2" in message.text for message in page.messages)
    assert page.tab.coarse.isEnabled()


@pytest.mark.long
def test_a_coarse_model_that_was_begun_goes_on_in_its_folder(page, controller, folder, tmp_path):
    few, begun = tmp_path / "few", tmp_path / "tower" / ".coarse"
    few.mkdir()
    for path in sorted(folder.iterdir())[:2]:
        shutil.copy(path, few)
    begun.mkdir(parents=True)
    (begun / "settings.json").write_text(json.dumps({"sha256": "", "photos": str(few.resolve())}))
    with clicked(choose(few), "Begin anew ...", escape) as words:
        click_on(controller.window, page.tab.coarse)
    assert "and not finished" in words[1]
    assert str(tmp_path / "tower") in words[1]
    with clicked(choose(few), escape):
        click_on(controller.window, page.tab.coarse)
    assert not any("at least 3 photos" in message.text for message in page.messages)
    with clicked(choose(few), "Go on"):
        click_on(controller.window, page.tab.coarse)
    page.tab.take_step(Act.FROM_PHOTOS)  # while it runs: no second dialog
    page.idle()
    assert any("are being worked on" in message.text for message in page.messages)
    assert any("at least 3 photos, got 2" in message.text for message in page.messages)
    (begun / "settings.json").write_text(json.dumps({"sha256": "", "photos": str(folder)}))
    with clicked(choose(few), escape) as words:
        click_on(controller.window, page.tab.coarse)
    assert "Folder for the coarse model" in words[1]


def stated(one, other, metres):
    """A step: say how far apart two photos were taken."""

    def step(dialog):
        for box, number in ((dialog.one, one), (dialog.other, one)):
            box.setFocus()
            QTest.keyClick(box, Qt.Key.Key_Home)
            for _ in range(number):
                QTest.keyClick(box, Qt.Key.Key_Down)
        assert (dialog.one.currentIndex(), dialog.other.currentIndex()) == (one, one)
        assert not dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Ok).isEnabled()
        for _ in range(other - one):
            QTest.keyClick(dialog.other, Qt.Key.Key_Down)
        type_into(dialog.length.findChild(QLineEdit), str(metres))
        press("OK")(dialog)

    return step


@pytest.mark.long
def test_a_distance_is_asked_for_where_the_size_is_not_known(page, controller, folder, tmp_path):
    few = tmp_path / "few"
    few.mkdir()
    for path in sorted(folder.iterdir())[:2]:
        shutil.copy(path, few)
    assert page.tab.distance.isHidden()
    page.tab.controller.unsized = UnsizedCoarse(few, tmp_path / "tower")
    page.tab.controller.stateChanged.emit()
    with clicked(escape):
        click_on(controller.window, page.tab.distance)
    assert not (tmp_path / "tower").exists()
    with clicked(stated(0, 1, 7.5)):
        click_on(controller.window, page.tab.distance)
    page.idle()
    assert any("at least 3 photos, got 2" in message.text for message in page.messages)
    assert page.tab.distance.isHidden()  # that is another fault


@pytest.mark.slow
def test_photos_alone_become_a_site_by_one_button(page, controller, shared_data, tmp_path):
    pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    photos = tmp_path / "door"
    photos.mkdir()
    for number in range(1, 7):
        shutil.copy(shared_data / "multiview" / "lund_door" / f"DSC_{number:04d}.JPG", photos)
    with clicked(choose(photos), choose(tmp_path / "coarse")):
        click_on(controller.window, page.tab.coarse)
    turn_until_idle(page.application, controller, 400.0)
    page.idle()
    assert any("6 of 6 photos found their place" in message.text for message in page.messages)
    assert controller.context.document.site.site.name == "coarse"
    assert len(page.tab.controller.intake.photos) == 6
    assert page.tab.data_set.isEnabled()
    assert any("the size is a guess" in message.text for message in page.messages)
    with clicked(stated(0, 5, 7.0)):
        click_on(controller.window, page.tab.distance)
    turn_until_idle(page.application, controller, 400.0)
    page.idle()
    first, last = (page.tab.controller.intake.photos[number].pose.position_enu_m for number in (0, 5))
    assert np.linalg.norm(last - first) == pytest.approx(7.0, abs=0.05)
    assert page.tab.distance.isHidden()


@pytest.mark.slow
def test_the_next_battery_is_planned_from_photos_by_a_click(application, controller, tmp_path):
    scene = bundled_scene("planar")
    ready = prepare(scene.site, profile("m3e").camera, Constraints())
    plan = plan_flight(scene.site, PlanRequest(n_views=16, time_budget_s=4.0), prepared=ready).plan
    photograph(scene, planned_shots(plan), ready, 128, tmp_path / "set")
    tab = PhotosTab(application, controller, tmp_path / "set" / "images", scene.site)
    assert not tab.tab.next_battery.isEnabled(), "nothing says what was flown"
    context = controller.context
    context.change("Plan", context.document.with_plan(PlanEntry("p1", "First", plan)))
    tab.idle()
    turn_until(application, tab.tab.next_battery.isEnabled)
    tab.tab.next_battery.click()
    turn_until_idle(application, controller, 300.0)
    entry = context.document.current
    assert entry.title == "Next battery"
    assert entry.plan.method == "top-up"
    assert any("Next battery planned, photos:" in str(message) for message in tab.messages)
    controller.context.messageShown.disconnect(tab.messages.append)
