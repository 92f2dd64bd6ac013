"""`camera`: the camera settings of a plan shown and changed, and kept through check, export and import."""

import json

import pytest


def test_the_settings_of_a_plan_are_shown_with_who_makes_them_and_what_comes_of_them(reflight, pane):
    out = reflight("camera", pane / "plan.json", "--site", pane / "site.json").out
    assert out.startswith("exposure measured once, then locked, f/")
    assert "set by the mission: automatic focus before the first photo, then locked" in out
    assert "set by hand: white balance manual, 5500 K" in out
    assert "motion-blur: all photos are taken at a hover, so none is blurred by motion" in out
    assert "motion blur: off - all photos are taken at a hover, so none is blurred by motion (0 px" in out
    assert "depth of field: o" in out


def test_settings_are_changed_and_nothing_else_of_the_plan(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    typed = ("--exposure", "manual", "--shutter", "1/500", "--iso", 200, "--focus-distance", 12.5, "--aperture", 5.6)
    found = reflight("camera", pane / "plan.json", *typed, "-o", out, "--json").json
    assert found["settings"]["shutter_s"] == 1 / 500
    assert found["settings"]["focus"] == "distance", "who names a distance wants the focus there"
    before, after = (json.loads(path.read_text()) for path in (pane / "plan.json", out))
    assert {key for key in after if after[key] != before.get(key)} == {"camera_settings"}
    again = reflight("camera", out, "--focus", "infinity", "--json").json
    assert again["settings"]["focus_distance_m"] is None
    assert again["settings"]["iso"] == 200


def test_a_definition_file_says_what_would_be_set_on_that_camera(reflight, pane, tmp_path):
    shutter = '<parameter name="SHUT" type="uint8"><options><option name="1/500" value="2"/></options></parameter>'
    shutter = shutter.replace("<options>", "<description>Shutter speed</description><options>")
    (tmp_path / "q7.xml").write_text(f"<mavlinkcamera><parameters>{shutter}</parameters></mavlinkcamera>")
    typed = ("--exposure", "manual", "--shutter", "1/500", "--iso", 200, "--definition", tmp_path / "q7.xml")
    out = reflight("camera", pane / "plan.json", *typed).out
    assert "set on the camera: 'SHUT' to 2, 1/500 s" in out
    assert "the camera's definition has no parameter for this, set it by hand: ISO 200" in out
    found = reflight("camera", pane / "plan.json", *typed, "--json").json["parameters"]
    assert {"name": "SHUT", "text": "1/500 s", "value": 2.0} in found


def test_a_mission_brings_the_focus_back_into_a_plan(reflight, pane, tmp_path):
    plan, kmz, back = tmp_path / "plan.json", tmp_path / "m.kmz", tmp_path / "back.json"
    reflight("camera", pane / "plan.json", "--focus", "infinity", "-o", plan)
    reflight("export", plan, "--format", "dji-kmz", "-o", kmz, "--site", pane / "site.json")
    reflight("import", kmz, "--site", pane / "site.json", "-o", back)
    assert json.loads(back.read_text())["camera_settings"]["focus"] == "infinity"


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        (("--exposure", "manual"), "--exposure: manual exposure needs a shutter time and an ISO"),
        (("--focus", "distance"), "--focus: a focus at a distance needs that distance, and no other has one"),
        (("--aperture", "0"), "--aperture: expected 0.5 to 64, got 0.0"),
        (("--shutter", "0"), "--shutter: expected more than 0 s and at most 60 s, got 0.0"),
    ],
)
def test_what_makes_no_sense_is_refused_by_the_option_typed(reflight, pane, typed, message):
    assert message in reflight("camera", pane / "plan.json", *typed).error


@pytest.mark.parametrize("typed", ["1/0", "a/5", "nan", "1/500/2", "inf/inf"])
def test_shutter_times_that_are_none_are_wrong_usage(reflight, pane, typed):
    done = reflight("camera", pane / "plan.json", "--shutter", typed)
    assert done.status == 2
    assert "argument --shutter: expected a " in done.err
