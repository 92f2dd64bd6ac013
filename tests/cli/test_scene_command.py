"""`scene`: what it lists, renders and refuses."""

import json
import sys
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from groundstation.services.scenes.views import BUNDLED_TEXTS
from missions.flight.flight_file import flight_of, write_flight
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.photos.folder import read_photos
from planning.plan import read_plan
from planning.site.file import read_site
from reconstruction.photos.poses import pose_photos
from reconstruction.scenes.effects.registry import EFFECTS
from reconstruction.scenes.world.bundled import SCENES

QUICK = ("--width", 32, "--jobs", 1, "--points", 500)


@pytest.fixture(scope="module")
def look(tmp_path_factory):
    """A look with nothing near, which is built fast."""
    path = tmp_path_factory.mktemp("look") / "far.toml"
    path.write_text("near = false\n")
    return path


@pytest.fixture
def render(reflight, pane, look, tmp_path):
    """Render the pane's site."""

    def run(*arguments, out=tmp_path / "photos"):
        return reflight("scene", "render", pane / "site.json", "-o", out, "--look", look, *QUICK, *arguments)

    return run


@pytest.fixture
def flown(pane, tmp_path):
    """A flight file of the pane's plan; photos are 0.1 m east of their views, and one does not say where it looks."""
    plan, model = read_plan(pane / "plan.json"), read_site(pane / "site.json")
    photos = []
    for number, view in enumerate(plan.viewpoints):
        x, y, z = view.position_enu_m
        photos.append(TakenPhoto(number, 4.0 * number, (x + 0.1, y, z), view.heading_deg, view.gimbal_pitch_deg))
    photos[2] = replace(photos[2], heading_deg=None)
    times, places = np.array([photo.time_s for photo in photos]), np.array([photo.position_enu_m for photo in photos])
    angles = np.full(len(times), np.nan)
    track = Track(times, places, np.zeros_like(places), angles, angles, angles, angles)
    write_flight(tmp_path / "flight.json", flight_of(plan, model, (FlightRecord(1, "test", track, tuple(photos)),)))
    return tmp_path / "flight.json"


def test_the_bundled_scenes_are_listed(reflight):
    assert set(BUNDLED_TEXTS) == set(SCENES)
    done = reflight("scene", "list")
    assert [line.split()[0] for line in done.out.splitlines()] == list(SCENES)
    assert reflight("scene", "list", "--json").json == {"scenes": BUNDLED_TEXTS}


@pytest.mark.long
def test_the_photos_of_a_plan_are_rendered_where_it_has_its_views(render, pane, tmp_path):
    done = render("--plan", pane / "plan.json")
    assert done.status == 0, done.err
    assert "6 photos of 'single-panel'" in done.out
    assert all(effect.name in done.out for effect in EFFECTS)
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    images = tmp_path / "photos" / "images"
    posed = pose_photos(read_photos(images).photos, site, images).photos
    by_id = {view.id: view for view in plan.viewpoints}
    order = [by_id[id_] for sortie in plan.sorties for id_ in sortie.viewpoint_ids]
    for photo, view in zip(posed, order, strict=True):
        assert photo.pose.position_enu_m == pytest.approx(view.position_enu_m, abs=1e-3)
        assert photo.intrinsics.width_px == 32


@pytest.mark.slow
def test_asking_again_keeps_what_is_there_and_asking_for_something_else_is_refused(render, pane, tmp_path):
    first = render("--plan", pane / "plan.json", "--json").json
    assert (first["photos"], first["kept"]) == (6, 0)
    assert [effect["effect"] for effect in first["effects"]] == [effect.name for effect in EFFECTS]
    before = (tmp_path / "photos" / "scene.json").read_bytes()
    assert render("--plan", pane / "plan.json", "--json").json["kept"] == 6
    assert (tmp_path / "photos" / "scene.json").read_bytes() == before
    error = render("--plan", pane / "plan.json", "--effects", "noise=on").error
    assert "holds photos of another run: settings.wishes.noise is null there" in error


@pytest.mark.slow
def test_the_photos_of_a_flight_are_rendered_from_where_they_were_taken(render, pane, flown, tmp_path):
    done = render("--flight", flown, "--plan", pane / "plan.json", "--json")
    assert (done.json["photos"], done.json["findings"]) == (6, [])
    taken = {photo["name"]: photo for photo in json.loads((tmp_path / "photos" / "scene.json").read_text())["photos"]}
    first = read_plan(pane / "plan.json").viewpoints[0].position_enu_m
    assert next(iter(taken.values()))["position_enu_m"] == pytest.approx([first[0] + 0.1, *first[1:]])


@pytest.mark.slow
def test_photos_of_a_flight_that_say_no_direction_are_left_out_with_a_word(render, flown):
    done = render("--flight", flown)
    assert "5 photos" in done.out
    assert "1 of 6 photos do not say where the camera looked" in done.err


@pytest.mark.slow
def test_views_are_planned_where_none_are_named_and_the_plan_is_kept(reflight, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ("scene", "render", "planar-far", "-o", "planar-far", "--views", 2, *QUICK, "--effects", "none")
    done = reflight(*arguments)
    assert "2 photos of 'planar-far'" in done.out
    plan = read_plan(tmp_path / "planar-far" / "plan.json")
    site = read_site(tmp_path / "planar-far" / "site.json")
    assert len(plan.viewpoints) == 2
    assert plan.site_sha256 == site.sha256
    # The folder has the scene's name now; it goes on all the same.
    assert "2 of them kept" in reflight(*arguments).out


@pytest.mark.few(6)
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("nowhere",), "neither a site file nor a bundled scene of that name; bundled are: planar, curved"),
        (("planar", "--width", 4), "--width: expected 16 to 20000"),
        (("planar", "--views", 0), "--views: expected 1 to 20000"),
        (("planar", "--points", -1), "--points: expected 0 or more"),
        (("planar", "--jobs", 0), "--jobs: expected 1 or more"),
        (("planar", "--jobs", 2, "--cluster", "tcp://10.0.0.5:8786"), "--jobs is for this machine"),
        (("planar", "--rays", 8), "--rays is for Mitsuba; add --renderer mitsuba"),
        (("planar", "--renderer", "mitsuba", "--rays", 0), "--rays: expected 1 to 1048576, got 0"),
        (("planar", "--seed", -1), "--seed: expected 0 to"),
        (("planar", "--tolerance", 0), "tolerance: expected"),
        (("planar", "--effects", "rain=on"), "names are near-field-reflection, fresnel"),
        (("planar-far", "--look", "look.toml"), "bundled scenes have a look of their own"),
        (("planar", "--views", 2, "--plan", "plan.json"), "is for scenes without a plan or flight"),
        (("planar-far", "--plan", "plan.json"), "this is a plan of 'single-panel', and not of 'planar-far'"),
        (("planar-far", "--flight", "flight.json"), "this is a flight over 'single-panel', and not over 'planar-far'"),
        (("site.json", "--plan", "site.json"), "expected a plan file"),
        (("plan.json",), "expected a site file"),
    ],
)
def test_what_cannot_be_rendered_is_said_in_one_line_and_nothing_is_written(
    reflight, pane, flown, tmp_path, monkeypatch, arguments, text
):
    (tmp_path / "plan.json").write_bytes((pane / "plan.json").read_bytes())
    (tmp_path / "site.json").write_bytes((pane / "site.json").read_bytes())
    monkeypatch.chdir(tmp_path)
    assert text in reflight("scene", "render", *arguments, "-o", "out").error
    assert not (tmp_path / "out").exists()


def test_mitsuba_is_asked_for_before_anything_else_is_done(reflight, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    failed = reflight("scene", "render", "planar", "-o", tmp_path / "out", "--renderer", "mitsuba")
    assert "Mitsuba is not installed; install it (pip install 'reflight-groundstation[mitsuba]')" in failed.error
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_photos_by_mitsuba_are_no_part_of_a_run_without_it(render, pane):
    pytest.importorskip("mitsuba", reason="the optional extra 'mitsuba' is not installed")
    judged = ("--renderer", "mitsuba", "--rays", 1)
    assert render("--plan", pane / "plan.json", *judged, "--json").json["photos"] == 6
    assert render("--plan", pane / "plan.json", *judged, "--json").json["kept"] == 6
    assert "settings.mitsuba_rays is 1 there" in render("--plan", pane / "plan.json").error


def test_a_folder_of_something_else_is_left_alone_whatever_the_scene(render, reflight, pane, tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "letter.txt").write_text("Dear")
    assert "is not empty, and has no scene.json" in render("--plan", pane / "plan.json").error
    assert "is not empty" in reflight("scene", "render", "nowhere", "-o", tmp_path / "photos").error
    assert [path.name for path in (tmp_path / "photos").iterdir()] == ["letter.txt"]


@pytest.mark.slow
def test_views_inside_buildings_opposite_are_told(reflight, pane, changed, tmp_path):
    render = partial(reflight, "scene", "render", pane / "site.json", *QUICK, "--plan")
    assert render(pane / "plan.json", "-o", tmp_path / "before").err == ""
    built = json.loads((tmp_path / "before" / "site.json").read_text())["obstacles"]
    (west, south, _), (east, north, _) = next(each["box_enu_m"] for each in built if "opposite" in each["id"])
    plan = changed(
        pane / "plan.json", "viewpoints", 0, "position_enu_m", [0.5 * (west + east), 0.5 * (south + north), 6.0]
    )
    done = render(plan, "-o", tmp_path / "out")
    assert done.status == 0, done.err
    assert "stand inside buildings opposite" in done.err


@pytest.mark.slow
def test_a_camera_file_says_how_photos_are_taken(render, flown, tmp_path):
    camera = tmp_path / "camera.toml"
    camera.write_text("speed_m_s = 30.0\nshutter_s = 0.02\ndistortion = [-0.1, 0.02, 0, 0, 0]\n")
    out = tmp_path / "photos"
    done = render("--flight", flown, "--camera", camera, "--effects", "motion-blur=on", "--json", out=out)
    assert done.status == 0, done.err
    assert {effect["effect"]: effect["on"] for effect in done.json["effects"]}["motion blur"]
    record = json.loads((out / "scene.json").read_text())
    assert record["taking"]["speed_m_s"] == 30.0
    for photo in record["photos"]:
        assert np.linalg.norm(photo["velocity_enu_m_s"]) == pytest.approx(30.0)
        assert np.linalg.norm(record["captures"][photo["name"]]["moved_enu_m"]) == pytest.approx(0.6)
    assert {photo.exposure_s for photo in read_photos(out / "images").photos} == {0.02}


@pytest.mark.slow
def test_a_camera_file_with_a_mistake_is_refused_before_anything_is_written(render, tmp_path):
    camera = tmp_path / "camera.toml"
    camera.write_text("shutter = 0.02\n")
    failed = render("--views", 1, "--camera", camera)
    assert failed.status == 1
    assert "shutter: no such setting; known are: shutter_s" in failed.err
    camera.write_text("distortion = [-0.6, 0, 0, 0, 0]\n")
    assert "camera.toml: distortion: [-0.6, 0.0, 0.0, 0.0, 0.0] folds the picture" in render("--camera", camera).err
    assert not (tmp_path / "photos").exists()


@pytest.mark.slow
def test_a_cluster_renders_the_photos_that_one_process_renders(reflight, render, pane, look, tmp_path):
    distributed = pytest.importorskip("distributed")
    render("--plan", pane / "plan.json")
    arguments = (
        "scene",
        "render",
        pane / "site.json",
        "-o",
        tmp_path / "other",
        "--look",
        look,
        *QUICK[:2],
        *QUICK[4:],
    )
    assert "no Dask scheduler answers at nowhere" in reflight(*arguments, "--cluster", "nowhere").error
    assert not (tmp_path / "other").exists()
    workers = {"threads_per_worker": 1, "processes": False, "dashboard_address": ":0"}
    with distributed.LocalCluster(n_workers=1, **workers) as cluster:
        done = reflight(*arguments, "--plan", pane / "plan.json", "--cluster", cluster.scheduler_address)
    assert done.status == 0, done.err
    assert (tmp_path / "other" / "scene.json").read_bytes() == (tmp_path / "photos" / "scene.json").read_bytes()


def test_a_plan_without_views_is_refused(render, changed, pane, tmp_path):
    plan = changed(pane / "plan.json", "viewpoints", [])
    content = json.loads(plan.read_text())
    plan.write_text(json.dumps(content | {"sorties": []}))
    assert "there are no views to photograph" in render("--plan", plan).error
    assert not (tmp_path / "photos").exists()


@pytest.mark.slow
def test_square_views_are_those_of_a_first_flight(render, tmp_path):
    done = render("--square", 3, "--json").json
    assert done["photos"] == 3
    record = json.loads((tmp_path / "photos" / "scene.json").read_text())
    assert record["made_from"]["square"] == {"n_views": 3, "profile": "m3e"}
    assert not (tmp_path / "photos" / "plan.json").exists()


def test_square_views_are_planned_or_flown_by_nobody(render, pane):
    assert "not both" in render("--square", 3, "--views", 2).error
    assert "leave it out" in render("--square", 3, "--plan", pane / "plan.json").error
    assert "--square: expected 1 to" in render("--square", 0).error
