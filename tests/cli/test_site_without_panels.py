"""A coarse model without panels: imported, kept, filled from photos, and refused by all that needs panels."""

import json
from dataclasses import replace

import pytest

from groundstation.services.fly.flying import FlightRequest, fly_files
from groundstation.services.plan.planning import plan_site
from planning.plan import read_plan, write_plan
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site, write_site
from tests.missions.flight.photo_files import write_photos
from tests.planning.revision.cases import QUICK
from tests.reconstruction.synthetic_photos import ORIGIN, made_photos, write_flight, write_model

AT = f"--origin={ORIGIN.lat_deg},{ORIGIN.lon_deg},{ORIGIN.ellipsoid_height_m}"


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """The office without its panels, and what was made of it while it had them; tests must not change it."""
    folder = tmp_path_factory.mktemp("bare")
    site, plan_path = write_scene("office", folder), folder / "office.plan.json"
    plan_site(site, PlanRequest(n_views=6, greedy=QUICK), plan_path)
    # Without the checksum: a plan that knows its site is refused because that has changed, before panels are asked for.
    plan = replace(read_plan(plan_path), site_sha256="")
    write_plan(plan_path, plan)
    write_plan(folder / "other.plan.json", plan)
    fly_files(plan_path, site, folder / "office.flight.json", FlightRequest())
    model = read_site(site)
    write_photos(folder / "photos", model.site, plan.viewpoints)
    site.unlink()
    write_site(folder / "bare.site.json", replace(model.site, facades=()))
    write_site(
        folder / "emptied.site.json",
        replace(model.site, facades=tuple(replace(facade, panels=()) for facade in model.site.facades)),
    )
    return folder


@pytest.fixture
def mission(bare, tmp_path):
    """The plan as a mission file."""
    from missions.formats.registry import encode, write_files
    from missions.mission.export_choices import FileFormat

    plan = read_plan(bare / "office.plan.json")
    write_files(encode(plan, plan.origin, plan.home_enu_m, FileFormat.MAVLINK_PLAN), tmp_path / "m.plan")
    return tmp_path / "m.plan"


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A folder of photos and a coarse model, and what they show."""
    folder = tmp_path_factory.mktemp("flight")
    made = made_photos(0.0, (0.0, 12.0))
    write_flight(folder / "photos", made)
    write_model(folder / "coarse.ply", made[0].case.wall)
    return folder, made


PLAN = "{bare}/office.plan.json"

COMMANDS = {
    "plan": "plan {site} -o {out}/p.json",
    "plan with fixed occlusion": "plan {site} -o {out}/p.json --occlusion off --method noto",
    "check": f"check {PLAN} {{site}}",
    "export for DJI": f"export {PLAN} --site {{site}} --format dji-kmz -o {{out}}/m.kmz",
    "export for MAVLink": f"export {PLAN} --site {{site}} --format mavlink-wpl -o {{out}}/m.waypoints",
    "export as a table": f"export {PLAN} --site {{site}} --format csv -o {{out}}/m.csv",
    "simulate": f"simulate {PLAN} {{site}} -o {{out}}/f.json",
    "report": f"report {PLAN} {{site}} --photos {{bare}}/photos -o {{out}}/f.json",
    "topup": f"topup {{bare}}/office.flight.json {PLAN} {{site}} -o {{out}}/t.json",
    "compare": f"compare {PLAN} {{bare}}/other.plan.json --site {{site}}",
    "compare with a mission": f"compare {PLAN} {{mission}} --site {{site}}",
    "brief": f"brief {PLAN} {{site}} -o {{out}}/b.html",
    "tradeoff plan": "tradeoff plan {site} -o {out}/t --views 4 --time-budget 2 --methods greedy --jobs 1",
    "photos with a plan": f"photos {{bare}}/photos {{site}} --plan {PLAN}",
}
"""Every command that counts what is seen of panels."""


@pytest.mark.long
@pytest.mark.few(4)
@pytest.mark.parametrize("site", ["bare", "emptied"])
@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
def test_what_needs_panels_says_where_they_come_from(reflight, bare, mission, tmp_path, site, command):
    out = tmp_path / "out"
    out.mkdir()
    given = command.format(bare=bare, out=out, mission=mission, site=bare / f"{site}.site.json")
    error = reflight(*given.split()).error
    assert "site 'office' has no panels yet: find them in photos ('panels' or the Photos tab), or draw them" in error
    assert [path for path in out.rglob("*") if path.is_file()] == []


@pytest.mark.long
def test_a_sortie_that_was_interrupted_is_not_resumed_either(reflight, bare, tmp_path):
    flight = json.loads((bare / "office.flight.json").read_text())
    flight["sorties"][0]["photos"] = flight["sorties"][0]["photos"][:2]
    (tmp_path / "cut.flight.json").write_text(json.dumps(flight))
    given = (tmp_path / "cut.flight.json", bare / "office.plan.json", bare / "bare.site.json")
    assert "has no panels yet" in reflight("topup", *given, "--resume", "-o", tmp_path / "rest.json").error


@pytest.mark.long
def test_tours_over_views_need_no_panels(reflight, bare, tmp_path):
    given = (bare / "office.plan.json", bare / "bare.site.json", "-o", tmp_path, "--seconds", 1)
    done = reflight("tradeoff", "route", *given, "--methods", "nearest-neighbour", "--json")
    assert done.status == 0, done
    assert len(done.json["tours"]) == 1


@pytest.mark.long
def test_photos_are_checked_and_nothing_is_said_of_coverage(reflight, bare):
    done = reflight("photos", bare / "photos", bare / "bare.site.json", "--json")
    assert done.status == 0, done
    assert done.json["photos"] == done.json["usable"] == 6
    assert done.json["findings"]["no-panels"] == 1
    assert "covered" not in done.json
    text = reflight("photos", bare / "photos", bare / "bare.site.json")
    assert "6 photos with a pose" in text.out
    assert "sections" not in text.out
    assert "next: app.py panels" in text.err


@pytest.mark.long
def test_a_project_keeps_it(reflight, bare, tmp_path):
    folder = tmp_path / "project"
    assert reflight("project", "new", folder, "--site", bare / "bare.site.json").status == 0
    shown = reflight("project", "show", folder, "--json")
    assert shown.json["site"]["panels"] == 0
    assert len(read_site(folder / "site" / "site.json").building.triangles) == 12


@pytest.mark.long
def test_a_site_with_neither_panels_nor_mesh_is_refused(reflight, bare, changed, tmp_path):
    site = changed(bare / "bare.site.json", "building_mesh", ...)
    error = reflight("plan", site, "-o", tmp_path / "p.json").error
    assert "expected at least one panel, or a building_mesh" in error
    assert "add panels, or name the mesh" in error


@pytest.mark.slow
def test_a_coarse_model_becomes_a_site_where_the_user_says_so_and_photos_fill_it(reflight, flight, tmp_path):
    folder, made = flight
    coarse, site = folder / "coarse.ply", tmp_path / "coarse.site.json"
    given = ("site", "import", coarse, "-o", site, AT)
    assert "--without-panels" in reflight(*given).error
    assert not site.exists()
    done = reflight(*given, "--without-panels")
    assert done.status == 0, done
    assert "the building without panels" in done.out
    assert "the site has no panels yet" in done.err
    assert f"next: app.py panels PHOTOS {site}" in done.err
    model = read_site(site)
    assert (model.site.facades, len(model.building.triangles) > 0) == ((), True)
    found = tmp_path / "found.site.json"
    filled = reflight("panels", folder / "photos", site, "-o", found, "--photos-per-facade", 1, "--json")
    assert filled.status == 0, filled
    assert filled.json["panels"] == len(made[0].panels) == read_site(found).site.n_panels
    assert read_site(found).site.airspace == model.site.airspace
