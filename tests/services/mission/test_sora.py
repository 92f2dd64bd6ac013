"""The files of a ground-risk draft hold the assessment, where and as large as it is."""

import csv
import io
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from shapely.geometry import shape

from groundstation.services.mission.sora import (
    rounded_up,
    sora_csv,
    sora_draft,
    sora_geojson,
    sora_html,
    sora_kml,
    sora_markdown,
    sora_summary,
    write_sora,
)
from planning.base.errors import InputError
from planning.geo.enu import enu_from_geodetic
from planning.geo.mesh import empty_mesh
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.site.bundled import ORIGIN
from planning.site.records import Airspace, SiteModel
from tests.planning.insight.ground_risk_cases import ROUND, flown, place
from tests.planning.site.importing.height_files import transform_at, write_heights

KML = "{http://www.opengis.net/kml/2.2}"


def drafted(**stated):
    request = replace(GroundRiskRequest(geography="paths", speed_m_s=5.0, wind_m_s=3.0), **stated)
    loop = ((0.0, 0.0, 20.0), (300.0, 0.0, 20.0), (300.0, 300.0, 20.0), (0.0, 300.0, 20.0), (0.0, 0.0, 20.0))
    return sora_draft(flown(ROUND, loop), SiteModel(place(), empty_mesh()), request, "a & b | c", n_fly_aways=6)


@pytest.fixture(scope="module")
def draft():
    return drafted(population="suburban", impact="medium")


def test_geojson_is_the_areas_on_the_ellipsoid(draft):
    content = sora_geojson(draft)
    by_kind = {each["properties"]["kind"]: each for each in content["features"]}
    assert list(by_kind) == ["ground-risk buffer", "contingency volume", "flight geography"]
    assert by_kind["contingency volume"]["properties"]["top_above_ground_m"] == pytest.approx(
        draft.risk.contingency_top_m, abs=0.01
    )
    for kind, area in (("ground-risk buffer", draft.risk.buffer), ("flight geography", draft.risk.geography)):
        written = shape(by_kind[kind]["geometry"])
        assert written.geoms[0].interiors
        assert shapely.is_ccw(written.geoms[0].exterior)
        assert not shapely.is_ccw(written.geoms[0].interiors[0])
        lon, lat = np.array(written.geoms[0].exterior.coords).T
        back = shapely.polygons(enu_from_geodetic(ORIGIN, lat, lon, np.full(len(lat), 62.0))[:, :2])
        assert shapely.hausdorff_distance(back.exterior, area.exterior) < 0.05


def test_kml_has_the_three_volumes_with_their_heights_and_holes(draft):
    root = ElementTree.fromstring(sora_kml(draft))
    assert root.find(f".//{KML}Document/{KML}name").text == "Ground risk by SORA 2.5: a & b | c"
    tops = {}
    for mark in root.iter(f"{KML}Placemark"):
        polygon = mark.find(f".//{KML}Polygon")
        assert polygon.find(f"{KML}innerBoundaryIs") is not None
        corner = polygon.find(f".//{KML}coordinates").text.split()[0].split(",")
        tops[mark.find(f"{KML}name").text] = (polygon.find(f"{KML}altitudeMode").text, float(corner[2]))
    assert tops["ground-risk buffer"] == ("clampToGround", 0.0)
    assert tops["flight geography"][0] == "relativeToGround"
    assert tops["contingency volume"][1] == pytest.approx(draft.risk.contingency_top_m, abs=0.01)


def test_tables_have_each_number_with_formula_and_source(draft):
    rows = list(csv.DictReader(io.StringIO(sora_csv(draft))))
    assert [row["symbol"] for row in rows] == [*(each.symbol for each in draft.risk.quantities), "iGRC", "GRC"]
    assert all(row["source"] for row in rows)
    assert [row["value"] for row in rows[-2:]] == ["5", "4"]
    assert [row["symbol"] for row in rows if row["assumed"] == "1"] == ["C_D A"]
    page, text = sora_html(draft), sora_markdown(draft)
    for each in draft.risk.quantities:
        assert f"| {each.symbol} | {each.name} |" in text
        assert f"<td>{each.symbol}</td><td>{each.name}</td>" in page
    assert "a &amp; b | c" in page
    assert "It is no permission" in text
    assert "5 - 1 (M2 medium) = 4" in text
    assert [row["formula"] for row in rows[-2:]] == [draft.risk.how_intrinsic, draft.risk.how_final]
    assert "Table 5" in rows[-1]["source"]


def test_the_summary_says_what_is_not_assessed(draft):
    content = sora_summary(draft)
    assert (content["intrinsic_grc"], content["final_grc"], content["fly_aways"]["share_inside"]) == (5, 4, 1.0)
    assert "SAIL" in content["not_assessed"]
    assert content["people"].startswith("fewer than 5000 per square kilometre")


def test_sizes_are_rounded_up():
    assert [rounded_up(value) for value in (31.71, 31.8, 31.80000001, 0.0)] == ["31.8", "31.8", "31.8", "0.0"]


def test_files_are_written_again_but_never_over_what_they_are_made_from(draft, tmp_path):
    paths = write_sora(draft, tmp_path / "out")
    assert sorted(path.name for path in paths) == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert write_sora(draft, tmp_path / "out") == paths
    with pytest.raises(InputError, match="would replace"):
        write_sora(draft, tmp_path / "out", sources=[paths[4]])


def test_without_people_there_is_no_class_and_the_draft_says_so():
    unknown = drafted()
    assert "ground risk class: not known" in sora_markdown(unknown)
    assert "keep everybody out" in sora_markdown(unknown)
    assert "nobody who is not involved" in sora_markdown(drafted(population="controlled"))
    assert "an assembly of people" in sora_markdown(drafted(population="assembly"))


def test_a_plan_of_another_site_is_refused_and_a_changed_site_is_told():
    plan, request = flown(ROUND), GroundRiskRequest(wind_m_s=2.0)
    other = SiteModel(replace(place(), name="elsewhere"), empty_mesh())
    with pytest.raises(InputError, match="made for site 'place', this is 'elsewhere'"):
        sora_draft(plan, other, request, "x", n_fly_aways=3)
    moved = replace(plan, origin=replace(ORIGIN, lat_deg=ORIGIN.lat_deg + 1.0))
    with pytest.raises(InputError, match="another origin than when the plan was made"):
        sora_draft(moved, SiteModel(place(), empty_mesh()), request, "x", n_fly_aways=3)
    changed = sora_draft(
        replace(plan, site_sha256="0" * 64), SiteModel(place(), empty_mesh(), sha256="1" * 64), request, "x", None, 3
    )
    assert "has changed since" in changed.findings[0].message


UTM, EGM96 = "EPSG:32650", "EPSG:32650+5773"


def on_slope(path, **stated):
    """A draft over ground that falls 1 m in 5 m to the east, of which the site itself knows nothing."""
    at = {"origin": ORIGIN, "transform": transform_at(ORIGIN, UTM, 25.0), "horizontal": UTM}
    write_heights(path, lambda x, y: -0.2 * x, crs=EGM96, geoid=True, **at)
    space = Airspace((-200.0, -200.0, 0.0), (200.0, 200.0, 200.0), 0.0)
    model = SiteModel(replace(place(), airspace=space), empty_mesh())
    request = GroundRiskRequest(terrain_raster=str(path), speed_m_s=8.0, wind_m_s=5.0, **stated)
    return sora_draft(flown(ROUND), model, request, "slope", n_fly_aways=60)


@pytest.mark.long
def test_a_raster_of_the_ground_beside_a_site_makes_the_buffer_follow_it(tmp_path):
    draft = on_slope(tmp_path / "dtm.tif")
    risk = draft.risk
    assert risk.value_of("S_GRB-") + 2.0 < risk.value_of("S_GRB")
    assert risk.value_of("H_AGL") < risk.value_of("H_FG")
    assert draft.fly_aways.share_inside == 1.0, draft.fly_aways.margins_m.min()
    assert np.ptp(draft.fly_aways.ends_enu_m[draft.fly_aways.reach_m > 0.0, 2]) > 10.0, "they come down on the slope"
    text = next(str(each.message) for each in draft.findings if each.code == "sora-ground")
    assert text.startswith("the buffer follows the terrain: ")
    # The volume's top is level: higher above the ground where that lies lower.
    root = ElementTree.fromstring(sora_kml(draft))
    marks = {mark.find(f"{KML}name").text: mark for mark in root.iter(f"{KML}Placemark")}
    corners = [c.split(",") for c in marks["flight geography"].find(f".//{KML}coordinates").text.split()]
    east = max(corners, key=lambda each: float(each[0]))
    west = min(corners, key=lambda each: float(each[0]))
    places = enu_from_geodetic(
        ORIGIN, [float(east[1]), float(west[1])], [float(east[0]), float(west[0])], [ORIGIN.ellipsoid_height_m] * 2
    )
    assert float(east[2]) - float(west[2]) == pytest.approx(0.2 * (places[0, 0] - places[1, 0]), abs=0.3)


def test_a_raster_that_leaves_its_heights_open_is_refused_with_a_way_out(tmp_path):
    write_heights(
        tmp_path / "dtm.tif", lambda x, y: 0.0 * x, origin=ORIGIN, crs=UTM, transform=transform_at(ORIGIN, UTM)
    )
    request = GroundRiskRequest(terrain_raster=str(tmp_path / "dtm.tif"), wind_m_s=5.0)
    with pytest.raises(InputError, match="or attach it to the site as its terrain"):
        sora_draft(flown(ROUND), SiteModel(place(), empty_mesh()), request, "x", n_fly_aways=3)
