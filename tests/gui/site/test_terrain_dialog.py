"""Terrain attached and taken off in the real window, by clicks: the files, what they do not say, what came of them."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.site.terrain_dialog import TerrainForm
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.units import UnitSystem
from planning.site.bundled import ORIGIN
from planning.site.importing.attach_terrain import TerrainRequest
from planning.site.importing.elevation import HeightOptions
from planning.site.terrain import surfaces
from tests.gui.driving import (
    choose,
    click_on,
    clicked,
    close_controller,
    press_in,
    turn_until,
    turn_until_idle,
    type_into,
)
from tests.planning.site.importing.height_files import transform_at, write_heights


def slope(x, y):
    return 0.12 * (y + 45.0) + 0.5 * np.sin(x / 15.0)


@pytest.fixture(scope="module")
def heights(tmp_path_factory):
    folder = tmp_path_factory.mktemp("heights")
    place = {
        "origin": ORIGIN,
        "crs": "EPSG:32650",
        "transform": transform_at(ORIGIN, "EPSG:32650", 2.0),
        "size": (200, 200),
    }
    write_heights(folder / "dtm.tif", slope, **place)
    write_heights(
        folder / "dsm.tif", lambda x, y: slope(x, y) + 12.0 * ((x - 40.0) ** 2 + (y + 20.0) ** 2 < 40.0), **place
    )
    return folder


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shown_tab() == "start")
    yield controller
    close_controller(controller)


def open_dialog(controller):
    from groundstation.gui.site.terrain_dialog import TerrainDialog

    side = controller.window.tab("site").left
    press_in(side, "Terrain...")
    return side.window().findChild(TerrainDialog)


@pytest.mark.slow
def test_terrain_is_attached_told_and_taken_off_by_clicks(application, controller, heights):
    window, context = controller.window, controller.context
    window.show_tab("site")
    window.tab("site").left.opener.open_bundled("office")
    turn_until_idle(application, controller)
    dialog = open_dialog(controller)
    form = dialog.form
    assert not dialog.attach.isEnabled()
    assert not dialog.remove.isEnabled()
    with clicked(choose(heights / "dtm.tif")):
        click_on(dialog, form.ground.choose)
    with clicked(choose(heights / "dsm.tif")):
        click_on(dialog, form.surface.choose)
    click_on(dialog, dialog.attach)
    turn_until(application, lambda: bool(dialog.error.text()))
    assert "does not say what its heights are above" in dialog.error.text()
    assert "“Heights are above”" in dialog.error.text()
    form.vertical.setCurrentIndex(form.vertical.findData("ellipsoid"))
    click_on(dialog, dialog.attach)
    turn_until(application, lambda: context.document.site.site.terrain is not None)
    turn_until_idle(application, controller)
    site = context.document.site.site
    assert dialog.error.text() == ""
    assert "terrain from -" in dialog.found.text()
    assert "heights above the ground count from the terrain" in dialog.found.text()
    assert [obstacle.id for obstacle in site.obstacles] == ["surface"]
    there = surfaces(site.terrain).ground.heights_m(np.array([site.home_enu_m]))[0]
    assert site.home_enu_m[2] == pytest.approx(there, abs=2e-3)
    assert dialog.remove.isEnabled()
    click_on(dialog, dialog.remove)
    assert context.document.site.site.terrain is None
    assert context.document.site.site.obstacles == ()
    press_in(dialog, "Close")
    context.session.undo()
    assert context.document.site.site.terrain == site.terrain
    turn_until_idle(application, controller)


def test_the_form_says_what_is_chosen_and_hides_what_does_not_matter(application, heights):
    form = TerrainForm(UnitSystem.METRIC)
    form.show()
    assert form.value() == TerrainRequest(())
    assert not form._form.isRowVisible(form.taller)
    assert not form._form.isRowVisible(form.system)
    form.ground.setValue((heights / "dtm.tif",))
    form.surface.setValue((heights / "dsm.tif",))
    form.vertical.setCurrentIndex(form.vertical.findData("other"))
    for box, code in ((form.system, "EPSG:7837"), (form.crs, "EPSG:25832")):
        type_into(box, code)
        QTest.keyClick(box, Qt.Key.Key_Return)
    form.unit.setCurrentIndex(form.unit.findData("ft"))
    form.step.setCurrentIndex(form.step.findData(2.0))
    form.accuracy.setCurrentIndex(form.accuracy.findData(0.5))
    form.to_home.setChecked(True)
    assert form._form.isRowVisible(form.taller)
    assert form._form.isRowVisible(form.system)
    assert form.value() == TerrainRequest(
        (heights / "dtm.tif",),
        (heights / "dsm.tif",),
        HeightOptions("EPSG:25832", "EPSG:7837", "ft"),
        step_m=2.0,
        accuracy_m=0.5,
        shift_m="home",
    )
    form.deleteLater()
