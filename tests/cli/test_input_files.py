"""Every command with a file that is another one than it wants: what was expected, what was found, what to do."""

import json

import pytest

from groundstation.services.plan.planning import plan_site
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from tests.planning.revision.cases import QUICK

INPUT_FILES = {
    "project": ("project", "a project"),
    "index": ("project/project.json", "a project"),
    "folder": ("folder", "a folder"),
    "missing": ("missing.json", "nothing of that name"),
    "empty": ("empty.json", "an empty file"),
    "blank": ("blank.json", "an empty file"),
    "site": ("site.json", "a site"),
    "plan": ("plan.json", "a plan"),
    "kmz": ("m.kmz", "a mission file"),
    "qgc": ("m.plan", "a mission file"),
    "waypoints": ("m.waypoints", "a mission file"),
    "kml": ("m.kml", "a mission file"),
    "csv": ("m.csv", "a mission file"),
    "mesh": ("wall.obj", "a building model"),
    "city": ("city.json", "a building model"),
    "tsp": ("four.tsp", "a TSPLIB instance"),
    "page": ("page.html", "a file of another kind"),
    "list": ("list.json", "a file of another kind"),
    "binary": ("photo.jpg", "a photo"),
}
"""What is given, and what a message calls it."""

MISSIONS = {"kmz", "qgc", "waypoints", "kml", "csv"}

COMMANDS = {
    "check PLAN": (("check", ..., "site.json"), "a plan file", {"plan"}),
    "check SITE": (("check", "plan.json", ...), "a site file", {"site"}),
    "plan SITE": (("plan", ..., "-o", "out"), "a site file", {"site"}),
    "plan --keep": (("plan", "site.json", "-o", "out", "--keep", ...), "a plan file", {"plan"}),
    "export PLAN": (("export", ..., "--format", "csv", "-o", "out"), "a plan file", {"plan"}),
    "export --site": (("export", "plan.json", "--format", "csv", "-o", "out", "--site", ...), "a site file", {"site"}),
    "brief PLAN": (("brief", ..., "site.json", "-o", "out.html"), "a plan file", {"plan"}),
    "brief SITE": (("brief", "plan.json", ..., "-o", "out.html"), "a site file", {"site"}),
    "sun PLAN": (("sun", ..., "site.json"), "a plan file", {"plan"}),
    "sun SITE": (("sun", ...), "a site file", {"site"}),
    "compare first": (("compare", ..., "other.json", "--site", "site.json"), "a plan file", {"plan"}),
    "compare next": (("compare", "other.json", ..., "--site", "site.json"), "a plan file", {"plan", *MISSIONS}),
    "compare --site": (("compare", "plan.json", "other.json", "--site", ...), "a site file", {"site"}),
    "import FILE": (
        ("import", ..., "--site", "site.json", "-o", "out"),
        "a mission file",
        # The reader itself says these better.
        {*MISSIONS, "folder", "page", "list"},
    ),
    "import --site": (("import", "m.kmz", "--site", ..., "-o", "out"), "a site file", {"site"}),
    "project new --site": (("project", "new", "out", "--site", ...), "a site file", {"site"}),
    "project add PLAN": (("project", "add", "project", ...), "a plan file", {"plan"}),
    "project add": (("project", "add", ..., "plan.json"), "the folder of a project", {"project", "index", "folder"}),
    "project show": (("project", "show", ...), "the folder of a project", {"project", "index", "folder"}),
    "project migrate": (("project", "migrate", ...), "the folder of a project", {"project", "index", "folder"}),
    "site import": (("site", "import", ..., "-o", "out"), "a building model", {"mesh", "city", "page", "list"}),
    "route": (("route", ...), "a TSPLIB instance", {"tsp"}),
    "segment IMAGE": (("segment", ..., "-o", "out"), "a photo", {"page", "list", "binary"}),
    "tradeoff plan": (("tradeoff", "plan", ..., "-o", "out"), "a site file", {"site"}),
    "tradeoff route": (("tradeoff", "route", ..., "-o", "out"), "a plan file", {"plan", "site", "tsp"}),
}
"""Arguments with `...` for what is given, what is wanted, and what of `INPUT_FILES` it takes or its reader judges."""

WRONG = [(command, given) for command, (_, _, taken) in COMMANDS.items() for given in INPUT_FILES if given not in taken]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Folder with one file of each kind; tests must not change it."""
    from groundstation.services.mission.export import export_plan
    from groundstation.services.project.document import Document
    from groundstation.services.project.folder import add_plans, create_project, open_project, save_project
    from missions.mission.export_choices import FileFormat
    from planning.site.file import read_site

    folder = tmp_path_factory.mktemp("files")
    site = write_scene("single-panel", folder).rename(folder / "site.json")
    plan_site(site, PlanRequest(n_views=6, greedy=QUICK), folder / "plan.json")
    plan_site(site, PlanRequest(n_views=3, greedy=QUICK), folder / "other.json")
    for file_format, ending in (
        (FileFormat.DJI_KMZ, "kmz"),
        (FileFormat.MAVLINK_PLAN, "plan"),
        (FileFormat.MAVLINK_WPL, "waypoints"),
        (FileFormat.KML, "kml"),
        (FileFormat.CSV, "csv"),
    ):
        export_plan(folder / "plan.json", file_format, folder / f"m.{ending}", site)
    create_project(folder / "project", Document(read_site(site)), site_source=site)
    document, _ = add_plans(open_project(folder / "project").document, [folder / "plan.json"])
    save_project(folder / "project", document)
    (folder / "folder").mkdir()
    (folder / "empty.json").write_bytes(b"")
    (folder / "blank.json").write_bytes(b"\xef\xbb\xbf \n")
    (folder / "city.json").write_text('{"type": "CityJSON", "version": "1.1"}')
    (folder / "wall.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    (folder / "list.json").write_text("[1, 2]")
    (folder / "page.html").write_text("<!DOCTYPE html><html></html>")
    (folder / "photo.jpg").write_bytes(b"\xff\xd8\xff\xe0" + bytes(range(256)))
    (folder / "four.tsp").write_text("NAME : four\nTYPE : TSP\nDIMENSION : four\n")
    return folder


@pytest.fixture
def typed(reflight, files, tmp_path, monkeypatch):
    """Run a command of `COMMANDS` in the folder of `files`; what it writes goes elsewhere."""
    monkeypatch.chdir(files)

    def run(command, given):
        arguments, _, _ = COMMANDS[command]
        placed = [given if part is ... else part for part in arguments]
        return reflight(*(tmp_path / part if str(part).startswith("out") else part for part in placed))

    return run


@pytest.mark.few(105)
@pytest.mark.parametrize(("command", "given"), WRONG)
def test_a_file_of_another_kind_is_refused_with_what_was_expected_and_found(typed, tmp_path, command, given):
    name, found = INPUT_FILES[given]
    error = typed(command, name).error
    assert error.startswith(f"error: {name}: expected {COMMANDS[command][1]}")
    reason, semicolon, advice = error.partition("; ")
    assert f"found {found}" in reason
    assert semicolon
    assert advice
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("command", [name for name, (_, wanted, _) in COMMANDS.items() if wanted == "a plan file"])
def test_a_project_where_a_plan_is_wanted_is_answered_with_its_plans(typed, files, command):
    error = typed(command, "project").error
    name = error.rpartition(" ")[2]
    assert json.loads((files / name).read_text())["format"] == "reflight-plan/1"


@pytest.mark.parametrize("command", [name for name, (_, wanted, _) in COMMANDS.items() if wanted == "a site file"])
def test_a_project_where_a_site_is_wanted_is_answered_with_its_site(typed, files, command):
    error = typed(command, "project").error
    name = error.rpartition(" ")[2]
    assert json.loads((files / name).read_text())["format"] == "reflight-site/1"


def test_a_project_without_plans_is_answered_with_the_command_that_makes_one(reflight, files, tmp_path):
    folder = tmp_path / "new"
    reflight("project", "new", folder, "--site", files / "site.json")
    error = reflight("check", folder, files / "site.json").error
    assert f"it has no plan yet; 'plan {folder / 'site' / 'site.json'} -o PLAN' makes one" in error


def test_what_is_wrong_in_a_file_of_the_right_kind_is_said_as_before(reflight, files, changed):
    broken = changed(files / "plan.json", "viewpoints", 0, "heading_deg", "north")
    assert (
        "viewpoints[0].heading_deg: expected number, got text" in reflight("check", broken, files / "site.json").error
    )


def test_damaged_json_is_not_called_another_kind(reflight, files, tmp_path):
    damaged = tmp_path / "damaged.json"
    damaged.write_text('{"format": "reflight-plan/1", ')
    assert "not valid JSON, line 1" in reflight("check", damaged, files / "site.json").error


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("ending", ["kmz", "plan", "waypoints", "kml", "csv"])
def test_missions_are_compared_as_plans_of_the_first_ones_aircraft(reflight, files, ending):
    done = reflight("compare", files / "plan.json", files / f"m.{ending}", "--site", files / "site.json", "--json")
    assert done.status == 0, done.err
    rows = {row["code"]: row["values"] for row in done.json["rows"] if not row["subject"]}
    assert done.json["plans"] == ["plan", f"m.{ending}"]
    planned, read = rows["views"]
    assert planned == read == 6
    # Files round angles: a section at its border may be lost, never more.
    assert abs(rows["covered"][0] - rows["covered"][1]) <= 1


def test_a_mission_compared_with_a_plan_of_an_unknown_aircraft_is_refused(reflight, files, changed):
    by_hand = changed(files / "plan.json", "profile", ...)
    error = reflight("compare", by_hand, files / "m.kmz", "--site", files / "site.json").error
    assert "does not name an aircraft of the catalogue" in error
    assert "'import' with --profile" in error
