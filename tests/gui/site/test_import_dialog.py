"""The import dialog: real files looked at before they are taken over, a grid picked in the preview, bad files told."""

import numpy as np
import pytest
import trimesh
from PySide6.QtCore import Qt, QTranslator
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit

from groundstation.gui.application.translate import FOLDER
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.document import Document
from groundstation.services.project.session import Session
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh, join
from tests.gui.driving import press_in, turn_until

FRAME_PX = 8
"""Between a box and its words, on either side."""


class Dialog:
    """One import dialog on an empty document."""

    def __init__(self, application, path):
        from groundstation.gui.application.context import ApplicationContext
        from groundstation.gui.site.site_opener import ImportDialog

        self.application, self.runner = application, JobRunner()
        self.context = ApplicationContext(Session(Document()), self.runner)
        self.messages, self.taken = [], []
        self.context.messageShown.connect(self.messages.append)
        self.dialog = ImportDialog(self.context, path)
        self.dialog.imported.connect(self.taken.append)
        self.dialog.show()
        self.idle()

    def idle(self):
        turn_until(self.application, lambda: not self.context.jobs())
        self.application.processEvents()

    def choose(self, box, value):
        """Choose in a box as the user does."""
        index = box.findData(value)
        assert index >= 0
        box.setCurrentIndex(index)
        box.activated.emit(index)

    def again(self):
        self.dialog._again.click()
        self.idle()

    def close(self):
        self.dialog.reject()
        self.context.close()
        self.runner.shutdown()
        self.dialog.deleteLater()


@pytest.fixture
def opened(application):
    dialogs = []

    def make(path):
        dialogs.append(Dialog(application, path))
        return dialogs[-1]

    yield make
    for dialog in dialogs:
        dialog.close()


@pytest.fixture
def tower_mm(tmp_path):
    """A tower of 36 x 20 x 42 m, in millimetres and nowhere on earth."""
    box = box_mesh(np.array([-18.0, 0.0, 0.0]), np.array([18.0, 20.0, 42.0]))
    path = tmp_path / "tower.obj"
    trimesh.Trimesh(box.vertices_enu_m * 1000.0, box.triangles, process=False).export(path)
    return path


@pytest.mark.slow
def test_building_with_windows_is_shown_and_taken_over_in_one_step(opened, shared_data):
    hands = opened(shared_data / "buildings" / "ingolstadt_lod3" / "4018270.xml")
    dialog = hands.dialog
    assert dialog.can_import()
    assert dialog.error() == ""
    summary = dialog._summary.text()
    assert "Panels: 57" in summary
    assert "by facade: A 55, B 2" in summary
    assert "460.7 m above the ellipsoid, 414.3 m above sea level (EGM96)" in summary
    notes = dialog._notes.toPlainText()
    assert "EPSG:32632" in notes
    assert "--" not in notes
    assert len(dialog.scene._site.frames) == 57
    hands.choose(dialog.form._heights, "ellipsoid")
    dialog.accept()
    assert hands.taken == [], "options that were not looked at are not taken over"
    hands.again()
    assert "414.3 m above the ellipsoid" in dialog._summary.text()
    press_in(dialog, "Import")
    assert [model.site.n_panels for model in hands.taken] == [57]
    assert len(hands.taken[0].sha256) == 64


@pytest.mark.slow
def test_mesh_becomes_a_site_field_by_field(opened, tower_mm):
    from PySide6.QtCore import QPoint, Qt
    from PySide6.QtTest import QTest

    hands = opened(tower_mm)
    dialog, form, grid = hands.dialog, hands.dialog.form, hands.dialog.grid
    assert "give “Site origin”" in dialog.error()
    lat, lon, _, sea = form.origin_box().boxes()
    lat.setValue(47.3769)
    lon.setValue(8.5417)
    sea.box().setValue(410.0)
    assert "Preview again" in dialog.error()
    hands.again()
    assert "36000 x 20000 x 42000 m" in dialog.error()
    assert "“Unit of lengths”" in dialog.error()
    hands.choose(form._unit, "mm")
    hands.again()
    assert dialog.error() == ""
    assert "No panels yet" in dialog._summary.text()
    assert "draw them on the building (Site tab)" in dialog._notes.toPlainText()
    assert len(dialog.shown().source.building.triangles) == 12
    grid._rows.setValue(14)
    grid._columns.setValue(20)
    grid._pick.click()
    canvas = dialog.scene.canvas()
    view = dialog.scene.orbit().pinhole(canvas.width(), canvas.height())
    pixels = view.project(np.array([(-17.9, 0.0, 0.1), (17.9, 0.0, 0.1), (-17.9, 0.0, 41.9)]))[0]
    for x, y in pixels:
        QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(round(x), round(y)))
    hands.idle()
    assert grid.can_accept(), grid._error.text()
    grid._accept.click()
    hands.idle()
    assert dialog.error() == ""
    assert "Panels: 280" in dialog._summary.text()
    press_in(dialog, "Import")
    (model,) = hands.taken
    assert model.site.origin.lat_deg == 47.3769
    np.testing.assert_allclose(np.ptp(model.building.vertices_enu_m, axis=0), [36.0, 20.0, 42.0], atol=1e-3)


@pytest.mark.slow
def test_grid_beside_the_building_is_told_and_cannot_be_used(opened, tower_mm):
    hands = opened(tower_mm)
    hands.dialog.form.origin_box().setValue(Origin(47.0, 8.0, 400.0))
    hands.dialog.form._origin_edited(None)
    hands.choose(hands.dialog.form._unit, "mm")
    hands.again()
    grid = hands.dialog.grid
    grid.set_rectangle(((-10.0, -30.0, 0.0), (10.0, -30.0, 0.0), (-10.0, -30.0, 20.0)))
    hands.idle()
    assert grid._error.text().startswith("Rectangle: its panels lie 30.0 m from the building")
    assert not grid.can_accept()
    assert hands.messages == [], "an answer for the form is no message of the window"


@pytest.mark.slow
def test_buildings_of_a_city_model_are_listed_and_one_is_chosen(opened, shared_data):
    hands = opened(shared_data / "buildings" / "cityjson" / "zurich_subset_lod2.json")
    box = hands.dialog.form._building
    assert box.count() == 50
    assert box.itemText(1).endswith("windows 0, 17 × 14 × 31 m")
    before = len(hands.dialog.shown().source.building.triangles)
    hands.choose(box, box.itemData(1))
    hands.again()
    building = hands.dialog.shown().source.building
    assert len(building.triangles) != before
    assert np.ptp(building.vertices_enu_m[:, 2]) == pytest.approx(31.0, abs=0.5)
    assert box.currentIndex() == 1, "the choice stays"


@pytest.mark.slow
def test_wrong_coordinate_system_is_told_by_the_fields_name(opened, shared_data):
    hands = opened(shared_data / "buildings" / "cityjson" / "delft_1b.json")
    form = hands.dialog.form
    hands.choose(form._place, "system")
    for code, message in (("EPSG:99999", "not a coordinate reference system"), ("EPSG:2056", "“Coordinate system”")):
        form._crs.setText(code)
        form._crs.editingFinished.emit()
        hands.again()
        assert message in hands.dialog.error()
        assert not hands.dialog.can_import()
    hands.choose(form._place, "file")
    hands.again()
    assert hands.dialog.error() == ""
    assert "there are no windows" in hands.dialog._notes.toPlainText()


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.ifc", b"", "expected an IFC file"),
        ("cut.ifc", b"ISO-10303-21;\nHEADER;", "the file is cut off"),
        ("x.json", b'{"type": "CityJSON", ', "not valid JSON"),
        ("bad.gml", b"<a><b></a>", "not valid XML"),
        ("bomb.gml", b'<!DOCTYPE x [<!ENTITY a "aaa">]><CityModel>&a;</CityModel>', "entities"),
        ("photo.png", b"\x89PNG", "expected a file ending in .ifc"),
        ("cloud.ply", b"ply\nformat ascii 1.0\n", "cannot be read"),
    ],
)
def test_bad_files_are_told_in_the_dialog_and_nothing_can_be_imported(opened, tmp_path, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    hands = opened(path)
    assert message in hands.dialog.error()
    assert str(tmp_path) not in hands.dialog.error()
    assert not hands.dialog.can_import()
    hands.dialog.accept()
    assert hands.taken == []


def test_dialog_that_is_closed_while_it_reads_takes_nothing_over(application, shared_data):
    hands = Dialog.__new__(Dialog)
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.site.site_opener import ImportDialog

    hands.application, hands.runner = application, JobRunner()
    hands.context = ApplicationContext(Session(Document()), hands.runner)
    dialog = ImportDialog(hands.context, shared_data / "buildings" / "ingolstadt_lod3" / "4018106.xml")
    taken = []
    dialog.imported.connect(taken.append)
    dialog.show()
    assert dialog.is_busy()
    dialog.reject()
    hands.idle()
    assert taken == []
    assert dialog.shown() is None
    hands.context.close()
    hands.runner.shutdown()


@pytest.mark.slow
def test_a_ground_that_is_not_clear_is_asked_for_in_the_form(opened, tmp_path):
    halves = [box_mesh(np.array([x, -6.0, z]), np.array([x + 10.0, 6.0, 15.0])) for x, z in ((-10.0, -3.0), (0.0, 0.0))]
    mesh = join(halves)
    path = tmp_path / "cellar.obj"
    trimesh.Trimesh(mesh.vertices_enu_m, mesh.triangles, process=False).export(path)
    hands = opened(path)
    form = hands.dialog.form
    form.origin_box().setValue(Origin(47.0, 8.0, 400.0))
    form._origin_edited(None)
    hands.again()
    assert "two heights of the file may be the ground: z = -3.00" in hands.dialog.error()
    assert "“Height of the ground in the file”" in hands.dialog.error()
    assert "--ground" not in hands.dialog.error()
    assert hands.dialog.shown() is not None, "the building is shown, so that one can see what is asked"
    assert not hands.dialog.can_import()
    QTest.keyClicks(form._ground, "-3")
    QTest.keyClick(form._ground, Qt.Key.Key_Return)
    hands.again()
    assert hands.dialog.can_import()
    press_in(hands.dialog, "Import")
    (model,) = hands.taken
    assert model.building.vertices_enu_m[:, 2].min() == pytest.approx(model.site.airspace.ground_z_m)


def test_words_in_empty_boxes_are_whole_in_german(application, tmp_path):
    path = tmp_path / "tower.obj"
    trimesh.creation.box((20.0, 10.0, 30.0)).export(path)
    translator = QTranslator()
    assert translator.load(str(FOLDER / "reflight_de.qm"))
    application.installTranslator(translator)
    try:
        hands = Dialog(application, path)
        edits = [edit for edit in hands.dialog.findChildren(QLineEdit) if edit.isVisible() and edit.placeholderText()]
        room_px = {edit.placeholderText(): edit.width() - 2 * FRAME_PX for edit in edits}
        cut = {text: px for text, px in room_px.items() if hands.dialog.fontMetrics().horizontalAdvance(text) > px}
        hands.idle()
        hands.close()
    finally:
        application.removeTranslator(translator)
    assert len(room_px) > 1
    assert not cut
