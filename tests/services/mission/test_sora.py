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
from planning.site.records import SiteModel
from tests.planning.insight.ground_risk_cases import ROUND, flown, place

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
    assert "iGRC - M2 medium" in text


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
