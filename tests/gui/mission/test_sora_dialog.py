"""Ground risk as a pilot assesses it: open, state, read, save; and what the brief says of it then."""

import json
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QPushButton

from groundstation.gui.map.map_view import MapView
from planning.base.findings import Severity
from planning.insight.ground_risk_request import GroundRiskRequest
from tests.gui.driving import choose, click_on, clicked, press_in
from tests.gui.mission.test_mission_page import context, idle, opened, page, planned, said  # noqa: F401
from tests.planning.insight.test_population import raster
from tests.planning.site.importing.height_files import transform_at, write_heights


def dialog_of(page, idle, context, planned):  # noqa: F811
    from groundstation.gui.mission.sora_dialog import SoraDialog

    context.session.open(opened(planned), None)
    idle()
    press_in(page.left, "SORA ...")
    idle()
    return page._shared_view.window().findChildren(SoraDialog)[-1]


def state(dialog, idle, **values):  # noqa: F811
    for name, value in values.items():
        row = dialog.form.row(name)
        row.setValue(value)
    dialog.form.valueChanged.emit()
    dialog._ask_soon.timeout.emit()
    idle()


@pytest.mark.long
def test_a_pilot_states_people_reads_the_class_and_saves_the_draft(page, context, planned, idle, said, tmp_path):  # noqa: F811
    dialog = dialog_of(page, idle, context, planned)
    assert "Ground risk class: not known" in dialog.state_text()
    assert dialog.form.value() == GroundRiskRequest()
    wide = dialog.draft().risk.value_of("S_GRB")
    state(dialog, idle, population="controlled", speed_m_s=5.0, wind_m_s=4.0)
    assert dialog.form.value() == GroundRiskRequest(population="controlled", speed_m_s=5.0, wind_m_s=4.0)
    assert "Ground risk class: 1 intrinsic, 1 final" in dialog.state_text()
    assert "300 of 300 ended inside" in dialog.state_text()
    assert dialog.draft().risk.value_of("S_GRB") < wide
    assert "LBA guidance 1.7" in next(row for row in dialog.table_texts() if row[0] == "S_CV")
    assert len(dialog.findChild(MapView)._volumes) == 3
    with clicked(choose(tmp_path)):
        click_on(dialog, dialog._action)
    idle()
    assert said[-1].severity is Severity.OK
    assert len(json.loads((tmp_path / "sora.geojson").read_text())["features"]) == 3
    dialog.close()
    # What was stated counts the next time, and for the brief.
    assert page._ground_risk == GroundRiskRequest(population="controlled", speed_m_s=5.0, wind_m_s=4.0)


@pytest.mark.slow
def test_what_cannot_be_is_said_in_the_dialog_and_nothing_can_be_saved(page, context, planned, idle):  # noqa: F811
    dialog = dialog_of(page, idle, context, planned)
    state(dialog, idle, wind_m_s=30.0)
    assert "Not assessed: DJI M3E may fly in wind of up to 12 m/s, but 30 m/s are stated" in dialog.state_text()
    assert not next(
        button for button in dialog.findChildren(QPushButton) if button.text() == "Save draft ..."
    ).isEnabled()
    state(dialog, idle, wind_m_s=3.0, sheltering="medium", restrictions="high")
    assert "count the same people" in dialog.state_text()
    dialog.close()


@pytest.mark.slow
def test_an_aircraft_nobody_described_is_asked_for(page, context, planned, idle):  # noqa: F811
    site_model, plan = planned
    dialog = dialog_of(page, idle, context, (site_model, replace(plan, profile="")))
    assert "state largest dimension, take-off mass, full speed through the air, braking tilt" in dialog.state_text()
    state(dialog, idle, dimension_m=0.8, mass_kg=1.5, speed_m_s=10.0, tilt_deg=30.0)
    assert dialog.draft() is not None
    dialog.close()


@pytest.mark.slow
def test_the_ground_comes_from_a_raster_that_is_chosen_and_one_that_cannot_be_read_is_told(
    page,  # noqa: F811
    context,  # noqa: F811
    planned,  # noqa: F811
    idle,  # noqa: F811
    tmp_path,
):
    dialog = dialog_of(page, idle, context, planned)
    (tmp_path / "broken.tif").write_bytes(b"II*\0 no raster")
    origin = planned[0].site.origin
    at = {"origin": origin, "transform": transform_at(origin, "EPSG:32650", 25.0), "horizontal": "EPSG:32650"}
    write_heights(tmp_path / "dtm.tif", lambda x, y: -0.2 * x, crs="EPSG:32650+5773", geoid=True, **at)

    def chosen(path):
        with clicked(choose(path)):
            click_on(dialog, dialog.form.ground.choose)
        dialog._ask_soon.timeout.emit()
        idle()
        return dialog.state_text()

    text = chosen(tmp_path / "broken.tif")
    assert text.startswith("Not assessed: ")
    assert "broken.tif" in text
    assert not dialog._action.isEnabled()
    assert not chosen(tmp_path / "dtm.tif").startswith("Not assessed")
    assert dialog.form.value() == GroundRiskRequest(terrain_raster=str(tmp_path / "dtm.tif"))
    assert dialog.form.ground.choose.text() == "dtm.tif"
    followed = [each for each in dialog.draft().findings if each.code == "sora-ground"]
    assert [str(each.message)[:31] for each in followed] == ["the buffer follows the terrain:"]
    click_on(dialog, dialog.form.ground.without)
    dialog._ask_soon.timeout.emit()
    idle()
    assert dialog.form.value() == GroundRiskRequest()
    dialog.close()


@pytest.mark.slow
def test_people_come_from_a_raster_that_is_chosen_and_counts_for_the_brief_too(page, context, planned, idle, tmp_path):  # noqa: F811
    path = raster(tmp_path / "hkg_pd_2020_1km.tif", np.full((60, 60), 1200.0))
    dialog = dialog_of(page, idle, context, planned)
    with clicked(choose(path)):
        click_on(dialog, dialog.form.people.choose)
    dialog._ask_soon.timeout.emit()
    idle()
    assert dialog.form.value() == GroundRiskRequest(population_raster=str(path))
    assert "Ground risk class: 5 intrinsic" in dialog.state_text()
    assert dialog.form.people.choose.text().startswith("hkg_pd")
    row = next(row for row in dialog.table_texts() if row[0] == "D_pop")
    assert path.name in row[-1]
    assert page._ground_risk.population_raster == str(path)
    click_on(dialog, dialog.form.people.without)
    dialog._ask_soon.timeout.emit()
    idle()
    assert dialog.form.value() == GroundRiskRequest()
    assert "Ground risk class: not known" in dialog.state_text()
    dialog.close()
