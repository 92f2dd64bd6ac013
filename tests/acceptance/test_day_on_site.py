"""The day on site: from a building model that others made to a flight with a report, by clicks alone."""

import json
import re

import pytest

from groundstation.services.settings import Language
from tests.acceptance.pilot import stay
from tests.conftest import SHARED_DATA
from tests.gui.driving import choose, clicked
from tests.slow import slow

BUILDING = SHARED_DATA / "buildings/ingolstadt_lod3/4018270.xml"
"""A house in Ingolstadt with 57 windows on its walls."""


@pytest.fixture
def building(tmp_path):
    """A real building; where none is on this machine, a block with as many windows along one wall."""
    if BUILDING.exists():
        return BUILDING
    corners = [(x, y, z) for z in (414.0, 423.0) for x, y in ((0, 0), (60, 0), (60, 12), (0, 12))]
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    kinds = ["GroundSurface", "RoofSurface", *["WallSurface"] * 4]
    for n in range(57):
        left, low = 1.0 + 2.0 * (n % 29), 415.0 + 4.0 * (n // 29)
        faces.append([len(corners) + k for k in range(4)])
        corners += [(left + dx, -0.01, low + dz) for dx, dz in ((0, 0), (1.2, 0), (1.2, 2), (0, 2))]
        kinds.append("Window")
    geometry = {
        "type": "MultiSurface",
        "lod": "3",
        "boundaries": [[face] for face in faces],
        "semantics": {"surfaces": [{"type": kind} for kind in kinds], "values": list(range(len(faces)))},
    }
    content = {
        "type": "CityJSON",
        "version": "2.0",
        "transform": {"scale": [0.001] * 3, "translate": [678000.0, 5403000.0, 0.0]},
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/25832"},
        "vertices": [[round(1000.0 * value) for value in corner] for corner in corners],
        "CityObjects": {"house": {"type": "Building", "geometry": [geometry]}},
    }
    path = tmp_path / "house.city.json"
    path.write_text(json.dumps(content))
    return path


@pytest.mark.long
@pytest.mark.parametrize("pilot", [Language.ENGLISH, slow(Language.GERMAN)], indirect=True)
def test_from_a_real_building_to_a_report_of_the_flight(pilot, building):
    pilot.see("start")
    _import_the_building(pilot, building)
    _plan_twice_and_compare(pilot)
    _export_and_read_back(pilot)
    _upload_and_start(pilot)
    _pause_go_on_and_return(pilot)
    _read_the_report(pilot)
    _save(pilot)


def _import_the_building(pilot, path):
    with clicked(choose(path), stay):
        pilot.press("Building model ...")
    pilot.idle()
    pilot.see("import")
    pilot.press("Import")
    pilot.idle()
    assert pilot.controller.context.document.site.site.n_panels == 57
    pilot.see("site")


def _plan_twice_and_compare(pilot):
    pilot.tab("Plan")
    pilot.choose("Plan for", "number of views")
    pilot.fill("Time to plan", "2")
    for n_views in ("12", "20"):
        pilot.fill("Views", n_views)
        pilot.press("Plan")
        pilot.idle()
        pilot.see("plan")
        assert len(pilot.controller.context.document.current.plan.viewpoints) == int(n_views)
    assert pilot.reads("Ready to fly; warnings: {0}")
    pilot.tab("Plans")
    pilot.see("plans")
    pilot.row("Plans", 0)
    pilot.row("Plans", 1, with_ctrl=True)
    pilot.press("Compare")
    pilot.idle()
    with pilot.in_window("Compare plans"):
        pilot.see("compare")


def _export_and_read_back(pilot):
    pilot.tab("Mission")
    pilot.idle()
    pilot.see("mission")
    pilot.press("Check")
    pilot.idle()
    pilot.see("proved")
    words = pilot.words("proved by an independent check: all {0} claims on this plan")[0]
    assert words.partition("{0}")[0][1:] in pilot.says()
    pilot.press("Export mission files ...")
    pilot.until(lambda: pilot.button("Write ...").isEnabled(), "the files are ready")
    pilot.see("export")
    path = pilot.folder / "house.kmz"
    with clicked(choose(path)):
        pilot.press("Write ...")
    pilot.idle()
    assert path.stat().st_size > 1000
    with clicked(choose(path)):
        pilot.press("Compare with file ...")
    pilot.idle()
    pilot.see("read back")
    assert pilot.reads("{0} is the plan: all {1} photos, in order, along the same path.")


def _upload_and_start(pilot):
    pilot.tab("Fly")
    pilot.see("fly")
    pilot.fill("Speed-up", "20")
    pilot.press("Connect")
    pilot.until(lambda: pilot.button("Upload").isEnabled(), "the mission can be uploaded")
    pilot.see("connected")
    pilot.press("Upload")
    pilot.until(lambda: pilot.button("Start").isEnabled(), "the flight can be started")
    pilot.see("ready")
    yes = pilot.words("Yes")[0]
    with clicked(yes) as asked:
        pilot.press("Start")
    assert re.search(r"\b20 (photos|Fotos)", asked[0]), asked[0]


def _pause_go_on_and_return(pilot):
    page = pilot.controller.window.tab("fly")
    pilot.until(lambda: page.n_photos() >= 2, "two photos are taken")
    pilot.press("Pause")
    pilot.until(lambda: pilot.button("Resume").isEnabled(), "it hovers")
    pilot.see("paused")
    pilot.press("Resume")
    n_photos = page.n_photos()
    pilot.until(lambda: page.n_photos() > n_photos, "another photo is taken")
    pilot.press("Return to home (RTH)")
    pilot.see("return")
    pilot.until_reads("Photos: {0} of {1} views; sections covered: {2} of {3} planned ({4:.1f} %)")


def _read_the_report(pilot):
    pilot.idle()
    pilot.see("report")
    pilot.tab("Findings")
    pilot.see("findings")
    words = pilot.words("{0} not reached because the flight was broken off by Return")[0]
    told = "\n".join(pilot.lines("Findings"))
    assert re.search(re.escape(words).replace(re.escape("{0}"), r"\d+"), told), told
    pilot.press("Disconnect")
    pilot.idle()
    pilot.see("disconnected")


def _save(pilot):
    project = pilot.folder / "house"
    with clicked(choose(project)):
        pilot.press("Save")
    pilot.idle()
    pilot.see("saved")
    assert pilot.controller.context.session.is_saved
    assert (project / "project.json").is_file()
