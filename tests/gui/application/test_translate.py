"""The window says what planning, missions and services say in the user's language and units."""

import ast
import functools
import json
import math
import pickle
import re
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QTranslator

from groundstation.gui.application.collect_messages import HOUSES, templates, templates_of
from groundstation.gui.application.translate import FOLDER, IN_WINDOW, WORDS, translated
from groundstation.services.messages import FIELD
from groundstation.services.site.findings import site_findings
from groundstation.services.site.sources import preview_import
from groundstation.services.units import UnitSystem
from missions.formats.registry import read_missions
from missions.simulator.conditions import Conditions
from planning.base.errors import GroundStationError
from planning.base.messages import Message, say
from planning.base.parameters import declared
from planning.checks import check_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site
from planning.site.importing.options import ImportOptions
from planning.site.records import Airspace
from tests.planning.plan_cases import kiosk

all_templates = functools.cache(templates)
templates_in = functools.cache(lambda path: tuple(templates_of(path)))

METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL

ROOT = Path(__file__).resolve().parents[3]
COMMANDS = {path.stem.rstrip("_") for path in (ROOT / "groundstation/cli/commands").glob("[a-z]*.py")} | {"reflight"}

ONLY_TYPED = (
    *("groundstation/cli/", "groundstation/services/mission/export.py", "reconstruction/training/model/score.py"),
    *("groundstation/services/photos/segmentation.py", "groundstation/services/model/facility_records.py"),
    *("groundstation/services/model/rendering.py", "groundstation/services/scenes/views.py"),
    *("planning/site/importing/mesh_file.py", "reconstruction/tradeoff/"),
    *("reconstruction/records/csv.py", "reconstruction/scenes/runs/", "reconstruction/training/model/render.py"),
)
"""What only commands use, or say of their options: the window has no such options."""

TYPED = {
    "{0} more like this (--json lists all)",
    "{0}; or let the embedded renderer be the truth (--truth-rays 0, no --rays)",
}
"""Said of what only the command line does."""


@pytest.fixture
def german(application):
    translator = QTranslator()
    assert translator.load(str(FOLDER / "reflight_de.qm"))
    application.installTranslator(translator)
    yield
    application.removeTranslator(translator)


def filled(template, values):
    """A message as `say` makes it of a template as translators see it."""
    return Message(FIELD.sub(lambda field: values[int(field[1])], template), template, tuple(values))


def example(template, value="Xy"):
    fields = {int(field[1]): field[2] for field in FIELD.finditer(template)}
    return filled(template, ["3.5, -2" if fields[number] == "m" else value for number in sorted(fields)])


@pytest.mark.lint
def test_fields_of_every_template_are_counted_from_0_in_order():
    for template in all_templates():
        assert [int(field[1]) for field in FIELD.finditer(template)] == list(range(len(FIELD.findall(template))))


@pytest.mark.lint
def test_what_the_window_says_instead_is_said_somewhere_and_has_the_same_fields():
    assert set(IN_WINDOW) <= all_templates()
    for template, instead in IN_WINDOW.items():
        assert re.findall(r"\{[^}]*\}", template) == re.findall(r"\{[^}]*\}", instead)


@pytest.mark.lint
def test_no_word_is_a_message_as_well():
    assert not set(WORDS) & all_templates()


@pytest.mark.lint
@pytest.mark.parametrize("language", ["en", "de"])
def test_the_window_speaks_no_command_line(application, request, language):
    """No option without its field, no command: whoever reads it has buttons."""
    if language == "de":
        request.getfixturevalue("german")
    only_typed = {template for template in IN_WINDOW if IN_WINDOW[template] == "only the command line works with it"}
    paths = [path for house in HOUSES for path in (ROOT / house).rglob("*.py")]
    is_typed = {path: path.relative_to(ROOT).as_posix().startswith(ONLY_TYPED) for path in paths}
    shown = {template for path in paths if not is_typed[path] for template in templates_in(path)}
    assert shown < all_templates()
    found = []
    for template in sorted({*shown, *WORDS} - only_typed - TYPED):
        told = translated(example(template), METRIC)
        quoted = {words.split()[0] for words in re.findall(r"['`]([a-z][\w. -]*)['`]", told)}
        if re.search(r"(?<![\w-])--[a-z]", told) or quoted & COMMANDS:
            found.append(told)
    assert found == [], "\n".join(found)


PROGRAM_ERRORS = {
    *("ValueError", "TypeError", "RuntimeError", "KeyError", "NotImplementedError", "AttributeError", "TimeoutError")
}


def raised_as_plain_text(path):
    """Lines that raise an error of ours, or make a finding, with a text that is no message."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        call = node.exc if isinstance(node, ast.Raise) else node
        if not isinstance(call, ast.Call):
            continue
        name = getattr(call.func, "id", "")
        is_error = isinstance(node, ast.Raise) and (name.endswith("Error") or name.startswith("Link"))
        if is_error and name not in PROGRAM_ERRORS:
            text = call.args[0] if call.args else None
        elif name == "Finding":
            text = call.args[2] if len(call.args) > 2 else None
        else:
            continue
        words = [part for part in ast.walk(text) if isinstance(part, ast.Constant)] if text is not None else []
        if isinstance(text, ast.JoinedStr | ast.Constant) and any(" " in str(word.value).strip() for word in words):
            yield node.lineno


@pytest.mark.lint
def test_errors_and_findings_are_messages():
    paths = [path for house in HOUSES for path in sorted((ROOT / house).rglob("*.py"))]
    plain = [f"{path.relative_to(ROOT)}:{line}" for path in paths for line in raised_as_plain_text(path)]
    assert plain == [], "say it with planning.base.messages.say, so that it can be translated"


@pytest.mark.lint
def test_stages_of_work_are_messages():
    """What `report` is told first: a message, or a name that all languages share."""
    plain = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for house in HOUSES
        for path in sorted((ROOT / house).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "report" and node.args
        if isinstance(node.args[0], ast.JoinedStr)
        or (isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, str))
        if not (isinstance(node.args[0], ast.Constant) and node.args[0].value in ("PyVRP",))
    ]
    assert plain == [], "say it with planning.base.messages.say, so that it can be translated"


def test_what_is_said_of_wrong_parameters_is_german(german):
    n_said = 0
    for name, each in {**declared(PlanRequest), **declared(Conditions)}.items():
        wrong = next((value for value in ("?", -1, math.nan) if not each.parameter.holds(value)), None)
        if wrong is not None:
            with pytest.raises(ValueError, match=r"expected .*, got ") as caught:
                each.parameter.check(name.rpartition(".")[2], wrong)
            assert "erwartet" in translated(str(caught.value), METRIC)
            n_said += 1
    assert n_said > 6


def test_a_message_goes_to_another_process_and_through_errors_as_it_is(german):
    inner = say("something stands in front of {:.0f} % of the panels", 40.0)
    error = pickle.loads(pickle.dumps(GroundStationError(say("cannot be read ({})", inner, place="a.json"))))
    assert translated(str(error), METRIC) == "a.json: nicht lesbar (vor 40 % der Scheiben steht etwas)"


ENGLISH = re.compile(r"\b(the|is|are|of|and|with|from|least|most|it|its|not|there|expected|which|has)\b")


def in_german(text, units=METRIC):
    """A text as the German window has it; nothing but names, paths and options may be left in English."""
    told = translated(text, units)
    assert not ENGLISH.search(re.sub(r"'[^']*'|/\S+|--\S+", "", told)), f"{text!r} is {told!r}"
    return told


@pytest.fixture(scope="module")
def planned():
    """A site and a plan for it that breaks rules of many kinds."""
    model = kiosk()
    found = plan_flight(model, PlanRequest(n_views=6, method="orbit")).plan
    first, *others = found.viewpoints
    moved = replace(first, position_enu_m=(0.0, -1.0, 500.0), gimbal_pitch_deg=-90.0)
    path = found.sorties[0].path_enu_m
    bent = replace(found.sorties[0], path_enu_m=(*path[:2], (0.0, 0.0, 3.0), *path[2:-1]), length_m=1.0, duration_s=1.0)
    rules = replace(found.rules, settle_s=0.1)
    plan = replace(found, viewpoints=(moved, *others), sorties=(bent, *found.sorties[1:]), rules=rules)
    return model, plan


def test_all_findings_of_a_broken_plan_are_german_in_the_german_window(german, planned):
    findings = check_plan(planned[1], planned[0])
    assert len({finding.code for finding in findings}) >= 12
    for finding in findings:
        assert in_german(finding.message) != finding.message
        if finding.place.startswith("sortie"):
            assert translated(finding.place, METRIC).startswith("Einsatz")


def test_lengths_in_findings_are_in_feet_in_the_imperial_window(application, planned):
    metric = [finding for finding in check_plan(planned[1], planned[0]) if finding.unit == "m"]
    assert len(metric) >= 5
    n_compared = 0
    for finding in metric:
        told = translated(finding.message, IMPERIAL)
        assert not re.search(r"\d m\b", told)
        for found in re.finditer(r"(-?[\d.]+) ft", told):
            shown_m = float(found[1]) * 0.3048
            candidates = [float(number) for number in re.findall(r"(-?\d[\d.e+-]*) m\b", finding.message)]
            assert min(abs(shown_m - number) for number in candidates) <= 0.05 * 0.3048 + 1e-9
            n_compared += 1
    assert n_compared >= 8


def test_findings_on_a_site_are_german(german):
    airspace = Airspace((-30.0, -30.0, -5.0), (30.0, 30.0, 40.0), ground_z_m=0.0)
    model = kiosk(airspace=airspace, home_enu_m=(0.0, -25.0, -2.0))
    found = site_findings(model)
    assert {finding.code for finding in found} >= {"airspace-below-ground", "home-below-ground"}
    for finding in found:
        in_german(finding.message)


def test_what_is_said_of_mission_files_of_others_is_german(german, shared_data):
    n_said = 0
    for path in sorted((shared_data / "missions").iterdir()):
        if path.suffix == ".md":
            continue
        try:
            findings = tuple(finding for mission in read_missions(path) for finding in mission.findings)
        except GroundStationError as error:
            in_german(str(error))
            n_said += 1
        else:
            for finding in findings:
                in_german(finding.message)
                n_said += 1
    assert n_said >= 10


BROKEN_SITES = {
    "number": {"home_enu_m": ["a", 0, 0]},
    "length": {"home_enu_m": [0, 0]},
    "far away": {"home_enu_m": [1e6, 0, 0]},
    "no object": {"origin": "x"},
    "latitude": {"origin": {"lat_deg": 200.0, "lon_deg": 0.0, "ellipsoid_height_m": 0.0}},
    "missing": {"origin": {"lat_deg": 20.0}},
    "no panels": {"facades": []},
    "no mesh": {"building_mesh": "none.ply"},
    "both or neither": {"obstacles": [{"id": "crane"}]},
    "other format": {"format": "reflight-plan/1"},
}


@pytest.mark.parametrize("changes", BROKEN_SITES.values(), ids=BROKEN_SITES)
def test_what_is_wrong_with_a_site_file_is_german(german, tmp_path, changes):
    path = write_scene("single-panel", tmp_path)
    path.write_text(json.dumps(json.loads(path.read_text("utf-8")) | changes), "utf-8")
    with pytest.raises(GroundStationError) as caught:
        read_site(path)
    assert in_german(str(caught.value)) != str(caught.value)


@pytest.mark.slow
def test_the_notes_of_an_import_are_german_and_without_metres_in_the_imperial_window(german, shared_data):
    files = ("buildings/cityjson/zurich_subset_lod2.json", "bim/curtain_wall_small.ifc")
    previews = [preview_import(shared_data / name, ImportOptions()) for name in files]
    notes = [note for preview in previews for note in preview.notes]
    assert len(notes) >= 10
    for note in notes:
        assert in_german(note) != note
        assert not re.search(r"\d k?m\b", translated(note, IMPERIAL))


@pytest.mark.parametrize(
    "text", ["Umbau 5 m hoch.json", "/home/the 5 m tower/it is 3 m.json", "nobody knows this", "5 m", ""]
)
def test_what_is_no_message_stays_as_it_is(german, text):
    for units in UnitSystem:
        assert translated(text, units) == text


def test_paths_and_names_in_messages_stay(german):
    for name in ("the 5 m tower: all of it", "panel", "home and away", "a; b, c (d)"):
        said = say("the plan was made for site '{}', this is '{}'; take its own site file", name, "x")
        assert f"'{name}'" in translated(said, IMPERIAL)
        said = say("cannot be read ({})", "Permission denied", place=f"/data/{name}.json")
        assert translated(said, IMPERIAL) == f"/data/{name}.json: nicht lesbar (Zugriff verweigert)"
