"""`panels`: photos and a coarse model to a site."""

import io
import json
from contextlib import redirect_stdout

import numpy as np
import pytest

from groundstation.cli.main import main
from planning.site.file import read_site
from tests.reconstruction.synthetic_photos import ORIGIN, made_photos, write_flight, write_model

AT = f"--origin={ORIGIN.lat_deg},{ORIGIN.lon_deg},{ORIGIN.ellipsoid_height_m}"


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A folder of photos and a coarse model, and what they show."""
    folder = tmp_path_factory.mktemp("flight")
    made = made_photos(0.0, (0.0, 12.0))
    write_flight(folder / "photos", made)
    write_model(folder / "coarse.ply", made[0].case.wall)
    return folder, made


@pytest.fixture(scope="module")
def found(flight):
    """The site of the flight, and what was told; tests must not change it."""
    folder, _ = flight
    out, told = folder / "found" / "found.site.json", io.StringIO()
    out.parent.mkdir()
    with redirect_stdout(told):
        arguments = ("panels", folder / "photos", folder / "coarse.ply", "-o", out, AT, "--json")
        assert main([str(argument) for argument in arguments], None) == 0
    return out, json.loads(told.getvalue())


@pytest.mark.long
def test_photos_and_a_mesh_become_a_site_that_can_be_planned(flight, found, reflight, tmp_path):
    _, made = flight
    out, told = found
    assert told["panels"] == len(made[0].panels)
    assert told["facades"][0]["photos"] == 2
    assert 0.0 < told["facades"][0]["corner_sigma_m"] < 2.0
    site = read_site(out).site
    truth = {(panel.row, panel.column): panel.corners_enu_m for panel in made[0].panels}
    panels = site.facades[0].panels
    assert panels[0].id == "A-01-01"
    for panel in panels:
        row, column = (int(part) - 1 for part in panel.id.split("-")[1:])
        assert np.abs(np.array(panel.corners_enu_m) - truth[row, column]).max() < 0.3
    assert out.with_name("found.facades.json").is_file()
    planned = reflight("plan", out, "-o", tmp_path / "p.plan.json", "--views", 4, "--candidates", 500, "--json")
    assert planned.status == 0, planned
    assert planned.json["covered"] > 0


@pytest.mark.slow
def test_a_site_gets_its_panels_anew_and_keeps_the_rest(flight, found, reflight, tmp_path):
    folder, made = flight
    first, second = found[0], tmp_path / "b.site.json"
    done = reflight("panels", folder / "photos", first, "-o", second, "--photos-per-facade", 1)
    assert done.status == 0, done
    assert "1 photo;" in done.out
    one, other = read_site(first), read_site(second)
    assert other.site.airspace == one.site.airspace
    assert len(other.building.triangles) == len(one.building.triangles)
    assert other.site.n_panels == len(made[0].panels)


@pytest.mark.long
def test_wrong_input_is_refused_in_words(flight, reflight, tmp_path):
    folder, _ = flight
    out = tmp_path / "x.site.json"
    photos, mesh = folder / "photos", folder / "coarse.ply"
    assert "at least 1" in reflight("panels", photos, mesh, "-o", out, AT, "--photos-per-facade", 0).error
    assert "no such file" in reflight("panels", photos, tmp_path / "none.ply", "-o", out, AT).error
    assert "expected a folder of photos" in reflight("panels", mesh, mesh, "-o", out, AT).error
    far = reflight("panels", photos, mesh, "-o", out, "--origin=48,11,500", "--ground", 0).error
    assert "km from the site" in far
    assert not out.exists()


@pytest.mark.slow
def test_a_corrected_panels_file_stands_in_for_a_search(flight, reflight, tmp_path):
    folder, made = flight
    grids, out = tmp_path / "grids", tmp_path / "x.site.json"
    grids.mkdir()
    photos, mesh = folder / "photos", folder / "coarse.ply"
    ask = ("panels", photos, mesh, "-o", out, AT, "--photos-per-facade", 1, "--grids", grids)
    assert "expected a folder of panels files" in reflight(*ask).error
    first = sorted(photos.iterdir())[0]
    assert reflight("segment", first, "-o", grids / "a.json").status == 0
    content = json.loads((grids / "a.json").read_text())
    facade = max(content["facades"], key=lambda one: len(one["panels"]))
    gone = next(panel for panel in facade["panels"] if (panel["row"], panel["column"]) == (0, 0))
    facade["panels"].remove(gone)
    facade["missing"].append({"row": 0, "column": 0})
    (grids / "a.json").write_text(json.dumps(content))
    done = reflight(*ask, "--json")
    assert done.status == 0, done
    assert done.json["panels"] == len(made[0].panels) - 1
    assert [effect.split(":")[0] for effect in done.json["effects"]["A"]] == [
        "facade curvature",
        "unrolling by arc length",
    ]
    content["image"] = "other.jpg"
    (grids / "a.json").write_text(json.dumps(content))
    assert "photo 'other.jpg'" in reflight(*ask).error


@pytest.mark.slow
def test_how_photos_are_rectified_and_whether_together_is_told(flight, reflight, tmp_path):
    folder, _ = flight
    out = tmp_path / "x.site.json"
    ask = ("panels", folder / "photos", folder / "coarse.ply", "-o", out, AT, "--photos-per-facade", 2)
    done = reflight(*ask, "--view", "polynomial", "--fuse", "on")
    assert done.status == 0, done
    assert "unrolling by arc length: off, as you asked" in done.out
    assert "photos searched together: on, as you asked" in done.out
    written = json.loads((tmp_path / "x.facades.json").read_text())["facades"][0]["search"]
    assert [decision["effect"] for decision in written] == ["unrolling by arc length", "photos searched together"]
