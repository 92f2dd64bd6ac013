"""The Model tab: panels are chosen, coloured, searched and measured, and their records are kept."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Qt
from PySide6.QtGui import QAction, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox

from groundstation.gui.model.record_side import KIND_TITLES
from groundstation.gui.reconstruct.model_view import Mark
from groundstation.services.jobs.channel import ProcessEnded
from groundstation.services.model.panel_colours import Computed
from groundstation.services.reconstruct.messages import (
    Organise,
    Probe,
    Probed,
    SceneMade,
    Section,
    ViewAnswer,
    ViewRequest,
)
from groundstation.services.units import UnitSystem
from reconstruction.objects.store import write_scene
from reconstruction.records.book import FILE
from reconstruction.records.entries import Attribute, Defect, Document, Inspection, Maintenance
from tests.gui.driving import choose, click_on, clicked, escape, press, shut, turn_until, type_into
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

PNG = b"\x89PNG\r\n\x1a\n" + bytes(40)
"""What says it is a picture."""


def looks(page):
    return page.told.of(ViewRequest)


def answer(page, look, value=90):
    """The process's answer to a look."""
    lens = look.camera.intrinsics
    picture = np.full((lens.height_px, lens.width_px, 3), value, np.uint8)
    page.controller._take(ViewAnswer(look, picture, depth_m=12.0))


def probe(page, x=0.5, y=0.5):
    page.pane.view.clicked.emit(x, y)
    return page.told.of(Probe)[-1]


def names(page):
    return [panel.name for panel in page.side.rows.panels]


def adds(page, kind):
    """The entry of the menu that adds a record of a kind."""
    return next(action for action in page.records.kinds.actions() if action.data() is kind)


def group_of(page, kind):
    """Where the records of a kind are listed."""
    return page.records.tree.topLevelItem(list(KIND_TITLES).index(kind))


def fill(dialog, texts):
    """Type into the fields of a record's form, or choose where there is a list."""
    for name, text in texts.items():
        box = dialog.boxes[name]
        if isinstance(box, QComboBox) and not box.isEditable():
            QTest.keyClicks(box, text)
        else:
            type_into(box.lineEdit() if isinstance(box, QComboBox) else box, text)


def filled(texts, button="OK"):
    """A step: fill the fields of a record's form and press a button."""

    def step(dialog):
        fill(dialog, texts)
        press(button)(dialog)

    return step


def test_without_a_model_it_says_what_to_open(page):
    assert "training that is finished" in page.pane.view.note()
    assert not page.records.add.isEnabled()
    assert not page.pane.save.isEnabled()
    page.pane.view.clicked.emit(0.5, 0.5)
    assert page.told.messages == []


def test_a_scene_shows_its_panels_and_asks_for_its_picture(opened):
    assert names(opened) == ["A-0000", "A-0001", "B-0000", "B-0001"]
    assert "4 panels, 12 Gaussians" in opened.side.title.text()
    look = looks(opened)[0]
    assert look.subject.folder == opened.controller.card.folder
    answer(opened, look)
    assert opened.pane.view.pictures()[0] is not None


def test_of_a_scene_without_panels_records_of_the_building_are_kept(application, page, tmp_path):
    write_scene(synthetic_scene(()), tmp_path / "plain.gsscene")
    page.controller.open(tmp_path / "plain.gsscene")
    turn_until(application, lambda: page.controller.card is not None and not page._context.jobs())
    assert names(page) == []
    assert page.records.level.currentData() == "building"
    assert page.records.title.text() == page.controller.card.name
    assert page.records.add.isEnabled()


def test_a_trained_model_is_organised_by_the_process_and_then_opened(application, page, scene, tmp_path):
    model = tmp_path / "made.model"
    model.mkdir()
    (model / "model.json").write_text("{}")
    page.controller.open(model)
    asked = page.told.of(Organise)[0]
    assert asked.folder == model
    assert not page.side.open.isEnabled()
    page.controller._take(SceneMade(asked, None, f"{model}: holds no finished model"))
    assert "holds no finished model" in page.messages[-1].text
    assert page.side.open.isEnabled()
    page.controller.open(model)
    page.controller._take(SceneMade(asked, scene))
    turn_until(application, lambda: page.controller.card is not None)
    assert page.controller.card.folder == scene


def test_what_is_no_model_is_refused_in_words(application, page, tmp_path):
    page.controller.open(tmp_path)
    turn_until(application, lambda: bool(page.messages))
    assert "no scene of objects" in page.messages[-1].text
    assert page.controller.card is None
    assert page.side.open.isEnabled()


def test_the_dialog_begins_at_the_projects_models_where_there_are_some(page, tmp_path, monkeypatch):
    project = tmp_path / "house"
    project.mkdir()
    begun = []

    def read(dialog):
        begun.append(Path(dialog.directory().absolutePath()))
        press("Cancel")(dialog)

    monkeypatch.setattr(type(page._context.session), "folder", property(lambda _session: project))
    with clicked(read):
        page.side.open.click()
    (project / "models").mkdir()
    with clicked(read):
        page.side.open.click()
    assert begun == [project, project / "models"]


def test_a_click_chooses_the_panel_that_the_process_finds(opened):
    asked = probe(opened)
    panel = opened.controller.card.panels[2]
    opened.controller._take(Probed(asked, panel.element.panel, (1.0, 0.0, 1.0)))
    assert opened.controller.selected == panel.global_id
    assert opened.records.title.text() == "B-0000"
    assert opened.side.list.currentIndex().row() == 2
    assert any(mark.is_closed for mark in opened.pane.view.marks())
    late = probe(opened)
    probe(opened)
    opened.controller._take(Probed(late, 0, (0.0, 0.0, 0.0)))
    assert opened.controller.selected == panel.global_id
    opened.controller._take(Probed(opened.told.of(Probe)[-1], None, None))
    assert opened.controller.selected == ""


def test_the_list_chooses_too_and_the_camera_turns_to_the_panel(opened):
    opened.side.list.setCurrentIndex(opened.side.rows.index(1))
    panel = opened.controller.card.panels[1]
    assert opened.controller.selected == panel.global_id
    opened.pane.front.click()
    camera = opened.pane.camera()
    middle = np.mean(panel.element.corners_enu_m, axis=0)
    np.testing.assert_allclose(camera.pose.points_cam(middle[None])[0, :2], 0.0, atol=1e-9)
    opened.pane.home.click()
    assert opened.pane.camera() is opened.controller.card.first_view


def test_records_are_kept_found_and_taken_back(opened):
    opened.controller.select(opened.controller.card.panels[0].global_id)
    global_id = opened.controller.selected
    assert not opened.controller.has_records
    other = opened.controller.card.panels[1].global_id
    opened.controller.put(Inspection(other, "2026-05-04", "F. Weiß", "visit"))
    opened.controller.put(Defect(global_id, "crack", 4, "2026-05-04", 0.2, 0.7, note="lower left"))
    opened.controller.put(Inspection(global_id, "2026-05-04", "M. Weber", "drone photos"))
    assert (opened.controller.card.folder / FILE).is_file()
    texts = tree_texts(opened)
    assert "2026-05-04: crack, severity 4, open, lower left" in texts
    assert "Defects (1)" in texts
    opened.side.search.setText("weber")
    opened._search.timeout.emit()
    assert names(opened) == ["A-0000"]
    opened.side.search.setText("weiss")
    opened._search.timeout.emit()
    assert names(opened) == [opened.controller.card.panels[1].name]
    opened.side.search.setText("b-00")
    opened._search.timeout.emit()
    assert names(opened) == ["B-0000", "B-0001"]
    opened.records.undo.click()
    assert "2026-05-04: drone photos, M. Weber" not in tree_texts(opened)
    entry = opened.controller.entries(Defect)[0]
    opened.records.removeRequested.emit(entry)
    assert opened.controller.entries(Defect) == ()


def choose_level(page, level):
    page.records.level.setCurrentIndex(page.records.level.findData(level))


def test_facades_and_the_building_have_records_too(opened):
    card, records = opened.controller.card, opened.records
    choose_level(opened, "building")
    assert records.title.text() == card.name
    assert records.add.isEnabled()
    assert records.report.isEnabled()
    opened.controller.put(Inspection(card.global_id, "2026-02-01", "K. Roth", "all of it"))
    assert "2026-02-01: all of it, K. Roth" in tree_texts(opened)
    choose_level(opened, "facade")
    assert not records.add.isEnabled()
    assert "Inspections" in tree_texts(opened)
    panel = card.panels[2]
    opened.controller.select(panel.global_id)
    assert (records.title.text(), records.global_id.text()) == (panel.facade, panel.facade_id)
    assert not records.extent.isVisibleTo(opened.left)
    opened.controller.put(Document(panel.facade_id, "drawings of the posts", "plan", "posts.pdf"))
    assert any("drawings of the posts" in text for text in tree_texts(opened))
    # Another panel of the facade has the same; the panel itself has none of them.
    opened.controller.select(card.panels[3].global_id)
    assert any("drawings of the posts" in text for text in tree_texts(opened))
    choose_level(opened, "panel")
    assert records.title.text() == card.panels[3].name
    assert records.extent.isVisibleTo(opened.left)
    assert not any("drawings" in text for text in tree_texts(opened))
    opened.side.search.setText("posts")
    opened._search.timeout.emit()
    assert names(opened) == [each.name for each in card.panels if each.facade_id == panel.facade_id]


def tree_texts(page):
    tree = page.records.tree
    groups = [tree.topLevelItem(row) for row in range(tree.topLevelItemCount())]
    return [item.text(0) for group in groups for item in [group, *(group.child(k) for k in range(group.childCount()))]]


def test_panels_are_coloured_by_what_their_records_say(opened):
    first, second, *_ = (panel.global_id for panel in opened.controller.card.panels)
    opened.controller.put(Defect(first, "crack", 5, "2026-05-04"))
    opened.controller.put(Attribute(second, "maker", "Glas Nord"))
    assert opened.side.colour.findData("maker") >= 0
    opened.side.colour.setCurrentIndex(opened.side.colour.findData(str(Computed.DEFECTS)))
    assert dict(opened.controller.tints) == {0: (128, 0, 38)}
    opened.pane.pictures_in_view.forget()
    opened.pane.show_view()
    assert looks(opened)[-1].tints == opened.controller.tints
    assert opened.side.without.text() == "3 without a value"
    opened.side.colour.setCurrentIndex(opened.side.colour.findData("maker"))
    assert dict(opened.controller.tints) == {1: (0, 114, 178)}
    opened.side.colour.setCurrentIndex(0)
    assert opened.controller.tints == ()


def test_a_section_is_asked_for_with_the_picture(opened):
    opened.pane.axis.setCurrentIndex(1)
    opened.pane.cut.setValue(500)
    assert opened.pane.section() == Section(2, pytest.approx(1.9), True)
    opened.pane.pictures_in_view.forget()
    opened.pane.turn_over.click()
    assert looks(opened)[-1].section == Section(2, pytest.approx(1.9), False)
    assert probe(opened).section == opened.pane.section()


def test_two_clicks_measure_and_a_third_begins_anew(opened):
    opened.pane.measure.click()
    for at in ((0.0, 0.0, 1.0), (3.0, 0.0, 5.0)):
        opened.controller._take(Probed(probe(opened), 0, at))
    assert opened.pane.view.note() == "5.0 m; 3.0 m along the ground, 4.0 m in height"
    assert any(mark.text == "5.0 m" for mark in opened.pane.view.marks())
    opened.pane.set_units(UnitSystem.IMPERIAL)
    assert "ft" in opened.pane.view.note()
    opened.pane.set_units(UnitSystem.METRIC)
    opened.controller._take(Probed(probe(opened), 0, (1.0, 0.0, 0.0)))
    assert opened.pane.view.note() == "Click two places."
    assert opened.controller.selected == ""


def test_another_scene_of_the_building_is_shown_beside_it(application, page, scene, tmp_path):
    write_scene(synthetic_scene(((3, 2), (2, 1)), seed=1), tmp_path / "later.gsscene")
    page.controller.open(scene)
    turn_until(application, lambda: page.controller.card is not None)
    assert page.pane.compare.findText("later.gsscene") == 1
    page.pane.compare.setCurrentIndex(1)
    right = [look for look in looks(page) if look.place == "right"]
    assert right[-1].subject.folder.name == "later.gsscene"
    answer(page, right[-1])
    assert page.pane.view.pictures()[1] is not None


def test_panels_have_their_colours_beside_too_where_they_have_other_numbers(application, opened, tmp_path):
    later = synthetic_scene(((3, 2), (2, 1)), seed=1)
    facade = later.components[1]
    moved = tuple(replace(each, panel=5 - each.panel) for each in facade.elements)
    components = (later.components[0], replace(facade, elements=moved), *later.components[2:])
    write_scene(replace(later, components=components), opened.controller.card.folder.parent / "later.gsscene")
    opened.controller.open(opened.controller.card.folder)
    turn_until(application, lambda: not opened._context.jobs())
    opened.controller.put(Defect(opened.controller.card.panels[2].global_id, "crack", 5, "2026-05-04"))
    opened.side.colour.setCurrentIndex(opened.side.colour.findData(str(Computed.DEFECTS)))
    opened.pane.axis.setCurrentIndex(1)
    opened.pane.compare.setCurrentIndex(1)
    turn_until(application, lambda: opened.controller.beside is not None)
    assert dict(opened.controller.tints) == {2: (128, 0, 38)}
    assert dict(opened.controller.comparison_tints) == {3: (128, 0, 38)}
    opened.pane.pictures_in_view.forget()
    opened.pane.show_view()
    left, right = looks(opened)[-2:]
    assert (left.place, right.place) == ("left", "right")
    assert (left.tints, right.tints) == (opened.controller.tints, opened.controller.comparison_tints)
    assert left.section == right.section is not None
    opened.pane.compare.setCurrentIndex(0)
    assert opened.controller.comparison_tints == ()


def test_the_picture_is_saved_with_its_marks(opened, tmp_path):
    answer(opened, looks(opened)[0])
    for no in ("Cancel", escape, shut):
        with clicked(no):
            opened.pane.save.click()
    assert list(tmp_path.glob("*.png")) == []
    with clicked(choose(tmp_path / "seen")):
        opened.pane.save.click()
    assert (tmp_path / "seen.png").read_bytes().startswith(b"\x89PNG")
    opened.save_picture(tmp_path / "nowhere" / "seen.png")
    assert "cannot be written" in opened.messages[-1].text


@pytest.mark.long
def test_records_go_into_tables_and_what_a_spreadsheet_filled_in_comes_back(application, opened, tmp_path):
    write, read = opened.records.tables.menu().actions()
    with clicked("Cancel"):
        write.trigger()
    with clicked(choose(tmp_path / "tables")):
        write.trigger()
    turn_until(application, lambda: not opened._context.jobs())
    assert "5 tables are written" in opened.messages[-1].text
    path = tmp_path / "tables" / "attributes.csv"
    text = path.read_text("utf-8-sig")
    assert "A-0000" in text, "panels that nothing is known of are there to be filled in"
    parted = ";" if ";" in text else ","
    path.write_text(f"name{parted}maker\r\nA-0000{parted}Glas Müller\r\nB-0001{parted}Weiß\r\n", "utf-8")
    with clicked(choose(tmp_path / "tables")):
        read.trigger()
    turn_until(application, lambda: not opened._context.jobs())
    assert "2 records are new or other" in opened.messages[-1].text
    first = next(panel for panel in opened.controller.card.panels if panel.name == "A-0000")
    opened.controller.select(first.global_id)
    assert "maker: Glas Müller" in tree_texts(opened)
    path.write_text(f"name{parted}maker\r\nZ-0000{parted}x\r\n", "utf-8")
    opened.controller.read_tables(tmp_path / "tables")
    turn_until(application, lambda: not opened._context.jobs())
    assert "Z-0000" in opened.messages[-1].text
    opened.records.undo.click()
    assert "maker: Glas Müller" not in tree_texts(opened)


def test_a_report_has_a_page_for_each_panel_and_no_markup_of_records(application, opened, tmp_path):
    panels = opened.controller.card.panels[:2]
    note = "<script>alert(1)</script>"
    opened.controller.put(Defect(panels[0].global_id, "crack", 2, "2026-05-04", 0.5, 0.5, note=note))
    opened.side.list.setCurrentIndex(opened.side.rows.index(0))
    opened.side.list.selectAll()
    for no in ("Cancel", escape, shut):
        with clicked(no):
            opened.records.report.click()
    assert not opened.report.is_busy
    # A name that says something else gets the ending of what it is.
    with clicked(choose(tmp_path / "panels.xlsx")):
        opened.records.report.click()
    pictures_come(application, opened, 4)
    html = opened.report.html()
    assert "&lt;script&gt;" in html
    assert "<script>" not in html
    content = (tmp_path / "panels.xlsx.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert content.count(b"/Type /Page\n") + content.count(b"/Type /Page ") >= 4
    assert "The report is written" in opened.messages[-1].text
    opened.make_report(tmp_path / "nowhere" / "panels.pdf")
    pictures_come(application, opened, 4)
    assert "cannot be written" in opened.messages[-1].text


@pytest.mark.slow
def test_a_report_of_a_facade_shows_it_whole_and_the_panels_that_something_is_known_of(application, opened, tmp_path):
    card, controller = opened.controller.card, opened.controller
    panels = [each for each in card.panels if each.facade == card.panels[0].facade]
    controller.put(Inspection(panels[0].facade_id, "2026-03-30", "Moreau"))
    controller.put(Defect(panels[1].global_id, "crack", 4, "2026-05-04"))
    controller.put(Defect(card.panels[-1].global_id, "leak of another facade", 4, "2026-05-04"))
    controller.select(panels[0].global_id)
    choose_level(opened, "facade")
    with clicked(choose(tmp_path / "facade.pdf")):
        opened.records.report.click()
    asked = looks(opened)[-1]
    pictures_come(application, opened, 2)
    html = opened.report.html()
    assert f"<h2>Facade {panels[0].facade}</h2><p><img src='{panels[0].facade_id}'" in html
    assert html.count("<img") == 2
    assert "Moreau" in html
    assert "crack" in html
    assert "another facade" not in html
    inside = asked.camera.pose.points_cam(np.array([each.element.corners_enu_m for each in panels]).reshape(-1, 3))
    assert (np.abs(inside[:, :2] / inside[:, 2:]) < 0.6).all()
    choose_level(opened, "building")
    opened.make_report(tmp_path / "building.pdf")
    pictures_come(application, opened, 4)
    assert "another facade" in opened.report.html()


def test_another_model_in_the_middle_of_a_report_ends_it(application, opened, tmp_path):
    opened.controller.select(opened.controller.card.panels[0].global_id)
    opened.make_report(tmp_path / "r.pdf")
    look, folder = looks(opened)[-1], tmp_path / "other.gsscene"
    write_scene(synthetic_scene(((1,),), name="other"), folder)
    opened.controller.open(folder)
    turn_until(application, lambda: opened.controller.card.folder == folder)
    answer(opened, look)
    assert not opened.report.is_busy
    assert not (tmp_path / "r.pdf").exists()


def pictures_come(application, page, n):
    """Answer what a report asks for, and wait until it is made."""
    for _ in range(n):
        answer(page, looks(page)[-1])
    assert page.report.is_busy
    turn_until(application, lambda: not page.report.is_busy)


def test_a_report_holds_what_is_attached_and_what_is_known_of_facade_and_building(application, opened, tmp_path):
    """Of a panel: photos of its defects under their numbers, names of documents, and files that are missing."""
    card, controller = opened.controller.card, opened.controller
    panel = card.panels[1]
    photo, contract, lost = tmp_path / "crack.png", tmp_path / "contract.pdf", tmp_path / "lost.png"
    for path, grey in ((photo, 40), (lost, 41)):
        assert cv2.imwrite(str(path), np.full((60, 90, 3), grey, np.uint8))
    contract.write_bytes(b"%PDF-1.7" + bytes(2400))
    long = "It runs from the lower left corner. " * 60 + "x" * 400
    controller.put(Defect(panel.global_id, "scratch", 1, "2026-05-04"))
    controller.put(Defect(panel.global_id, "crack", 4, "2026-05-04", 0.2, 0.7, note=f"below\n{long}"), photo)
    controller.put(Defect(panel.global_id, "leak", 3, "2026-05-04"), lost)
    controller.put(Inspection(panel.facade_id, "2026-03-30", "Moreau", "rope access", "sound"))
    controller.put(Document(panel.facade_id, "Maintenance contract", "contract.pdf", "contract"), contract)
    controller.put(Document(card.global_id, "Entrance", "entrance.png"), photo)
    controller.put(Document(card.global_id, "Rules", "https://example.org/rules.pdf"))
    (missing,) = (each.picture for each in controller.entries_of(Defect, panel.global_id) if each.kind == "leak")
    (card.folder / "records-files" / missing).unlink()
    controller.select(panel.global_id)
    opened.make_report(tmp_path / "panel.pdf")
    pictures_come(application, opened, 1)
    html = opened.report.html()
    # The building first, then the facade, then the panel; a defect's number is that of its mark.
    order = ["The building: made", "Entrance", "https://example.org/rules.pdf", f"Facade {panel.facade}", "Moreau"]
    order += ["Maintenance contract, contract, PDF, 2.4 kB", panel.name, "<ol><li>", "scratch", "crack", "leak"]
    places = [html.index(text) for text in (*order, missing)]
    assert places == sorted(places)
    assert html.count("<img src=") == 3
    assert "<br>It runs" in html
    assert f"The file is missing or not the one that was attached: {missing}" in html
    content = (tmp_path / "panel.pdf").read_bytes()
    # The same photo is twice on the page, and once in the file.
    assert content.count(b"/Subtype /Image") == 2
    assert content.count(b"/Type /Page\n") + content.count(b"/Type /Page ") == 3
    assert "The report is written" in opened.messages[-1].text


def test_a_lost_process_is_told_and_asked_anew(opened):
    opened.make_report(opened.controller.card.folder / "r.pdf")
    opened.controller._take(ProcessEnded(-9))
    assert "has ended" in opened.messages[-1].text
    before = len(looks(opened))
    opened.pane.show_view()
    assert len(looks(opened)) > before


def test_what_draws_is_said_with_its_reason_and_chosen_in_the_menu(opened, controller):
    def answered(**more):
        # One look is on its way, and the next one goes once it is answered.
        opened.pane.show_view()
        opened.controller._take(ViewAnswer(looks(opened)[-1], np.zeros((9, 16, 3), np.uint8), **more))

    def chosen(text):
        actions = controller.window.findChildren(QAction)
        next(action for action in actions if action.text() == text).trigger()

    chosen("Graphics card")
    answered(by_card=False, drawn_by="Arc takes 50 ms, the processor 20 ms")
    assert opened.pane.view.device() == ("Processor", "Arc takes 50 ms, the processor 20 ms")
    assert looks(opened)[-1].drawn_by == "gpu"
    answered(by_card=True, drawn_by="Arc, as you asked")
    assert opened.pane.view.device() == ("Graphics card", "Arc, as you asked")
    answered(by_card=False, drawn_by="the processor goes on", lost="the processor goes on")
    assert "processor goes on" in opened.messages[-1].text
    # A driver may take the process of models along.
    answered(by_card=True)
    opened.controller._take(ProcessEnded(-11))
    assert looks(opened)[-1].drawn_by == "cpu"
    assert "The processor draws models for now" in opened.messages[-1].text
    chosen("What is faster")
    answered(by_card=False, drawn_by="the processor, as you asked")
    assert looks(opened)[-1].drawn_by == "auto"


def test_damaged_records_are_told_and_the_model_is_still_there(opened):
    (opened.controller.card.folder / FILE).write_bytes(b"no records")
    opened.controller.select(opened.controller.card.panels[0].global_id)
    assert "SQLite" in opened.messages[-1].text
    assert opened.records.title.text() == "A-0000"


@pytest.mark.parametrize(
    ("kind", "texts", "problem"),
    [
        (Inspection, {"date": "yesterday"}, "date"),
        (Defect, {"kind": "crack", "u": "0.5"}, "both or neither"),
        (Defect, {"kind": "crack", "u": "a", "v": "0.5"}, "number"),
        (Maintenance, {"work": "sealed", "cost": "12"}, "currency"),
        (Document, {"title": "Data sheet", "place": "../etc/passwd"}, "address"),
        (Attribute, {"value": "x"}, "name"),
    ],
)
def test_a_form_says_what_is_wrong_and_stays(opened, kind, texts, problem):
    global_id = opened.controller.card.panels[0].global_id
    opened.controller.select(global_id)
    said = []

    def wrong(dialog):
        fill(dialog, texts)
        press("OK")(dialog)
        said.append((dialog.isVisible(), dialog.problem.isVisible(), dialog.problem.text()))
        press("Cancel")(dialog)

    with clicked(wrong):
        adds(opened, kind).trigger()
    ((is_open, is_shown, words),) = said
    assert is_open
    assert is_shown
    assert problem in words
    assert opened.controller.entries_of(kind, global_id) == ()


def test_forms_make_records_and_change_them(opened):
    global_id = opened.controller.card.panels[0].global_id
    opened.controller.select(global_id)
    with clicked(filled({"kind": "crack", "u": "0,25", "v": "0.5", "severity": "3"})):
        adds(opened, Defect).trigger()
    (made,) = opened.controller.entries_of(Defect, global_id)
    assert (made.kind, made.severity, made.u, made.v, made.status) == ("crack", 3, 0.25, 0.5, "open")
    opened.records.tree.setCurrentItem(group_of(opened, Defect).child(0))
    with clicked(filled({"note": "grows"})):
        opened.records.change.click()
    assert opened.controller.entries_of(Defect, global_id) == (replace(made, note="grows"),)
    with clicked(filled({"name": "thickness", "value": "8,5"})):
        adds(opened, Attribute).trigger()
    (named,) = opened.controller.entries_of(Attribute, global_id)
    assert named == Attribute(global_id, "thickness", 8.5, "number", "mm", named.key)


def test_records_are_added_and_changed_in_a_form_and_not_when_it_is_left(opened):
    global_id = opened.controller.card.panels[0].global_id
    opened.controller.select(global_id)
    add = adds(opened, Defect)
    for step in (filled({"kind": "crack"}, "Cancel"), escape, shut):
        with clicked(step):
            add.trigger()
    assert opened.controller.entries_of(Defect, global_id) == ()
    with clicked(filled({"kind": "crack"})):
        add.trigger()
    assert [found.kind for found in opened.controller.entries_of(Defect, global_id)] == ["crack"]
    opened.records.tree.setCurrentItem(group_of(opened, Defect).child(0))
    with clicked(filled({"kind": "chip"})):
        opened.records.change.click()
    assert [found.kind for found in opened.controller.entries_of(Defect, global_id)] == ["chip"]


@pytest.mark.long
def test_a_picture_goes_with_a_defect_and_a_file_with_a_document(opened, tmp_path):
    global_id = opened.controller.card.panels[0].global_id
    opened.controller.select(global_id)
    (tmp_path / "crack.png").write_bytes(PNG)
    (tmp_path / "sheet.pdf").write_bytes(b"%PDF-1.7")
    left = []

    def with_file(texts, times=1):
        def step(dialog):
            fill(dialog, texts)
            for _ in range(times):
                left.append(dialog.file)
                click_on(dialog, dialog.choose)
            press("OK")(dialog)

        return step

    with clicked(with_file({"kind": "crack"}), choose(tmp_path / "crack.png")):
        adds(opened, Defect).trigger()
    assert opened.controller.entries_of(Defect, global_id)[0].picture.endswith(".png")
    left.clear()
    with clicked(with_file({"title": "Data sheet"}, 4), "Cancel", escape, shut, choose(tmp_path / "sheet.pdf")):
        adds(opened, Document).trigger()
    assert left == [None] * 4, "a file dialog that was left chose none"
    assert len(opened.controller.entries_of(Document, global_id)[0].sha256) == 64


@pytest.mark.long
def test_a_record_that_cannot_be_kept_is_not_typed_again(opened, tmp_path):
    global_id = opened.controller.card.panels[0].global_id
    opened.controller.select(global_id)
    (tmp_path / "no.png").write_bytes(b"text")
    (tmp_path / "crack.png").write_bytes(PNG)
    said = []

    def twice(dialog):
        fill(dialog, {"kind": "crack", "note": "from the sill upwards"})
        for _ in range(2):
            click_on(dialog, dialog.choose)
            press("OK")(dialog)
            said.append((dialog.isVisible(), dialog.problem.text()))

    with clicked(twice, choose(tmp_path / "no.png"), choose(tmp_path / "crack.png")):
        adds(opened, Defect).trigger()
    (is_open, problem), (is_still_open, last) = said
    assert is_open
    assert "no.png" in problem
    assert "picture" in problem
    assert (is_still_open, last) == (False, "")
    (kept,) = opened.controller.entries_of(Defect, global_id)
    assert (kept.kind, kept.note) == ("crack", "from the sill upwards")


def test_a_click_is_no_drag_and_a_drag_no_click(opened):
    answer(opened, looks(opened)[0])
    view, clicks, drags = opened.pane.view, [], []
    view.clicked.connect(lambda x, y: clicks.append((x, y)))
    view.orbited.connect(lambda x, y: drags.append((x, y)))
    middle = view.room().center()
    for steps in ([QPointF(2.0, 1.0)], [QPointF(30.0, 0.0), QPointF(60.0, 0.0)]):
        mouse(view, QEvent.Type.MouseButtonPress, middle)
        for step in steps:
            mouse(view, QEvent.Type.MouseMove, middle + step)
        mouse(view, QEvent.Type.MouseButtonRelease, middle + steps[-1])
    assert len(clicks) == 1
    assert clicks[0] == pytest.approx((0.5, 0.5), abs=0.02)
    assert len(drags) == 2


def mouse(view, kind, at):
    button = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseMove else Qt.MouseButton.LeftButton
    buttons = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseButtonRelease else Qt.MouseButton.LeftButton
    event = QMouseEvent(kind, at, view.mapToGlobal(at), button, buttons, Qt.KeyboardModifier.NoModifier)
    QCoreApplication.sendEvent(view, event)


def test_the_panel_under_the_mouse_is_named(opened):
    panel = opened.controller.card.panels[0]
    camera = opened.pane.camera()
    middle = camera.pose.points_cam(np.mean(panel.element.corners_enu_m, axis=0)[None])[0]
    lens = camera.intrinsics
    x = (lens.cx_px + lens.fx_px * middle[0] / middle[2]) / lens.width_px
    y = (lens.cy_px + lens.fy_px * middle[1] / middle[2]) / lens.height_px
    opened.pane.view.pointed.emit(x, y)
    marks = opened.pane.view.marks()
    assert [mark.text for mark in marks] == ["A-0000"]
    assert isinstance(marks[0], Mark)
    opened.pane.view.pointed.emit(-1.0, 0.5)
    assert opened.pane.view.marks() == ()
