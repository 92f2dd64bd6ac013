"""The window says what planning, missions and services say in the user's language and units."""

import json
import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from PySide6.QtCore import QTranslator

from groundstation.gui.application.languages import FOLDER
from groundstation.gui.application.translate import field_labels, own_words, phrasebook
from groundstation.gui.sentences import sentence_tables
from groundstation.gui.sentences.window import IN_WINDOW
from groundstation.services.sentences import Template
from groundstation.services.site.findings import site_findings
from groundstation.services.site.import_wording import in_window_words
from groundstation.services.site.sources import preview_import
from groundstation.services.units import UnitSystem
from missions.formats.registry import read_missions
from missions.simulator.conditions import Conditions
from planning.base.errors import GroundStationError
from planning.base.parameters import declared
from planning.checks import check_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site
from planning.site.importing.options import ImportOptions
from planning.site.records import Airspace
from reconstruction.training.method_registry import METHODS
from tests.gui.source_sentences import collect, files_of_the_window
from tests.planning.plan_cases import kiosk

METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL

COMMAND_FOLDER = Path(__file__).resolve().parents[3] / "groundstation" / "cli" / "commands"

OTHER_TABLES = {"parts", "window"}
"""Words and what Python says, and what the window says instead; all others are of whole sentences."""

NOT_SHOWN = {
    "planning/base/parameters.py": "ranges in words, which are sentences with each parameter: see `refusals`",
    "reconstruction/dataset/effects.py": "the decision about each effect, for the command line",
    "reconstruction/dataset/records.py": "file content",
    "reconstruction/training/method_registry.py": "but for what each method is: where it is from, what changed",
    "reconstruction/training/layers.py": "the window has names of its own for layers",
    "planning/base/effects.py": "the decision as one line, for the command line; the window has a card",
    "planning/geo/enu.py": "descriptions of transformations for PROJ",
    "planning/viewpoints/pso.py": "names of parameter settings, for benchmarks",
    "groundstation/services/mission/brief_html.py": "has its own translations, in gui/brief_printer.py",
    "groundstation/services/mission/brief_pictures.py": "drawings; their words come from brief_html.py",
    "groundstation/services/site/import_wording.py": "patterns, and English for what the import says otherwise",
    "missions/dji/xml_text.py": "file content",
    **{
        f"reconstruction/colmap/{name}.py": "the window reads no COLMAP models but those that it has written"
        for name in ("binary", "camera_models", "folder", "text")
    },
    "reconstruction/panels/rectify/curvature.py": "the decision about each facade, for the command line",
    "reconstruction/panels/rectify/vanishing_view.py": "facades in the window are rectified by their poses",
    "reconstruction/panels/search/fuse.py": "the views of one search are of one size",
    "reconstruction/panels/solving/fusing.py": "the decision about each facade, for the command line",
    "reconstruction/panels/solving/known_grids.py": "panels files are read on the command line",
    "groundstation/services/model/facility_records.py": "records are made, read and written on the command line",
    **{
        f"reconstruction/records/{name}.py": "records are taken from tables and building models on the command line"
        for name in ("csv/cells", "csv/reading", "csv/tables", "ifc/importing", "ifc/process")
    },
    "reconstruction/records/ifc/sets.py": "file content",
    "reconstruction/exports/sog/images.py": "the window writes SOG and reads none",
    "reconstruction/training/config.py": "settings are read from files on the command line",
    "reconstruction/splats/ply.py": "the window writes PLY files and reads none",
    "reconstruction/splats/ply_file.py": "the window writes PLY files and reads none",
    "reconstruction/splats/rasterising/views.py": "cameras of pictures are straight",
    "reconstruction/panels/panels_file.py": "panels files are read on the command line",
    "reconstruction/panels/rectify/polynomial.py": "the polynomial is asked for on the command line",
    "reconstruction/scenes/photos/camera_model.py": "how photos are taken is read from files on the command line",
    "reconstruction/panels/search/parameters.py": "settings are read from files on the command line",
    "reconstruction/panels/search/views.py": "the window decodes its photos itself",
    "missions/simulator/autopilot/ardupilot_scheduler.py": "texts of an autopilot, which no vehicle translates",
    "missions/simulator/autopilot/px4_scheduler.py": "texts of an autopilot",
    "missions/simulator/autopilot/commands.py": "texts of an autopilot",
    "missions/simulator/autopilot/failsafe.py": "texts of an autopilot",
    "missions/simulator/autopilot/mission_store.py": "texts of an autopilot",
    "missions/simulator/autopilot/modes.py": "texts of an autopilot",
    "missions/simulator/server.py": "the window closes the link itself",
    "missions/simulator/autopilot/stored_item.py": "names of MAVLink",
    "missions/flight/flight_file.py": "the window writes flight files and reads none",
    "missions/flight/logs/flights.py": "the window reads no logs; its own records have no such faults",
    "missions/flight/logs/ardupilot.py": "the window reads no logs",
    "missions/flight/logs/dataflash.py": "the window reads no logs",
    "missions/flight/logs/raw.py": "notes in the record of a flight, which the window keeps and does not show",
    "missions/flight/logs/read.py": "the window reads no logs",
    "missions/flight/logs/tlog.py": "the window reads no logs",
    "missions/flight/logs/ulog.py": "the window reads no logs",
    "missions/mavlink/areas.py": "the window makes fences of no-fly volumes, which are right",
    "missions/mavlink/transfer/wire_items.py": "plans have no such items",
}
"""Files that the window imports, but whose sentences nobody reads there, and why."""

FROM_MODEL_PROCESS = {
    *(f"groundstation/services/reconstruct/{name}.py" for name in ("training", "render_queue", "shown_models")),
    *(f"reconstruction/training/{name}.py" for name in ("checkpoints", "start", "train", "trainer", "training_state")),
    *(f"reconstruction/training/{name}.py" for name in ("photos/photo_stream", "model/saved")),
    *(f"reconstruction/light/{name}.py" for name in ("choose_light", "glass_rays", "light_training")),
    *(f"reconstruction/splats/{name}.py" for name in ("rasterising/gsplat_backend", "initialise", "start_data")),
    "reconstruction/base/out_of_memory.py",
}
"""Files that the process of models imports and the window does not, and whose sentences it tells the window."""

NO_SENTENCE = {
    "labels of rows, which the comparison window has its own words for": (
        *("time in the air", "way flown", "views found after", "sections covered", "of all sections"),
        *("of what can be covered", "facade {0}, of what can be covered", "sections no other plan covers"),
        *("covered at least {0} times", "finest pixel", "coarsest pixel", "finest pixel on the worst panel"),
        *("smallest clearance", "findings: {0}"),
    ),
    "splats to start from are named on the command line": (
        "has splats on panel {0}, and {1} has {2} panels; name a file of the same site",
        "has no splat within {0} m of the panels of {1}; are both in one frame?",
    ),
    "what the history of records says": ("objects of the model", "{0} put", "{0} removed", "undone: {0}"),
    "names that GlobalIds follow from": ("component {0}", "panel {0}"),
    "keys and comments of files of models": (
        *("site: {0}", "site origin, WGS 84 lat lon ellipsoid height: {0}", "empty places"),
    ),
    "what errors of libraries are searched for": (
        *("out of memory", "can't allocate memory", "cannot allocate memory", "not enough memory"),
    ),
    "stands in `parts` with the words of each constraint": ("{0} {1} instead of {2}",),
    "stands in `parts` without its colon": ("focal lengths are from: ",),
    "patterns that other messages are searched for": (
        *(" - at `$", "^Object missing", "\\bsortie (\\d+), leg (\\d+)\\b", "sortie (\\d+)", "QGC WPL (\\d+)"),
        *(" to WGS 84", "^Invalid enum value (.+)$"),
    ),
    "content of files": (
        *("QGC WPL 110", '<?xml version="1.0" encoding="UTF-8"?>', '"use strict";\n(() => {\n'),
        *("local east, north, up, metres", "above sea level by EGM96", "IFC GlobalId", "Number in the model"),
        *("Area, m2", "Width, m", "Height, m", "no data", "Glass panel", "panels {0}", "Facade or background"),
        *("axes: {0}", "origin of the places in the site's east, north, up, metres: ", "{0} (facade)"),
        "root node: x east, y north, z up, metres, counted from origin_enu_m in the site's frame",
        "tiles: x east, y north, z up, metres, in the site's frame",
        *("site origin, WGS 84 lat lon ellipsoid height: ", "+proj=cart +ellps=WGS84"),
    ),
    "names of things, the same in every language": ("EPSG:{0} ({1})", "template.kml, imageFormat", "{0} min"),
    "notes in the record of a flight, which the window keeps and does not show": (
        *("{0} was {1} and is {2} now", "{0} is {1}; the plan was made for {2}", "{0} items, read back and equal"),
        *("{0} photos were reported", "had that value already", "the vehicle does not know it"),
        *("the vehicle keeps another value", "the ground station disconnected; the aircraft went on by itself"),
        *("simulated {0}", "simulation, {0} times as fast", "the time since boot began again"),
    ),
    "names of states, for which the window has its own words or none": (
        *("on the ground", "in the air", "taking off", "to come", "RTK float", "RTK fixed", "Exchange | None"),
        "cut off",
    ),
    "said on the command line only": (
        *("a minute; shows that everything works, and nothing else", "which views count"),
        "how much (one of the first three)",
        *("expected a folder of pictures, found a file", "expected a folder of pictures, found nothing"),
        *("{0} and {1} have one name; keep one of them", "expected pictures ({0}) in this folder, found none"),
        *("{0}; what was flown before is in {1}", "sortie {0}: ", ", asked for"),
        "{0}nothing was recorded: the vehicle sent no positions in flight",
        "effects are decided by the photos of a flight; expected at least one, got none",
        *("there is no effect '{0}'; expected one of {1}", "tolerance: expected a factor above 0, got {0}"),
        *("samples: expected 1 to 32 along a pixel's side, or auto, got {0}", "expected 2 to {0}, got {1}"),
        "rays: expected 1 to {0} through each pixel, got {1}",
        "the site has no building mesh, and panels are found on one; name a mesh instead",
        "the site would be written over the file it is imported from; name another file",
        *(
            "no building in this file has windows; {0}",
            "there is neither a window nor a glazed plate with geometry; {0}",
        ),
        "a mesh does not tell windows from walls; state where the panels are, for example --panel-grid '0,0,0 36,0,0 "
        "0,0,42' --rows 14 --columns 20 (lower left, lower right and upper left corner of a facade, seen from "
        "outside), or import the building alone with --without-panels and find them in photos with 'panels'",
        "panels come from the windows of a city model (level of detail 3), from IfcWindow and glazed IfcPlate of a BIM "
        "model, or from you: --panel-grid 'E,N,U E,N,U E,N,U' (lower left, lower right and upper left corner of a "
        "facade seen from outside, in the file's coordinates) --rows N --columns N; or import the building alone with "
        "--without-panels, and find them in photos with 'panels'",
    ),
    "options, for which `import_words` puts the label of a field": (
        *("--rows {0} --columns {1}", "--panel-grid {0}", "--gap {0}"),
    ),
}
"""Texts that are none, and why."""

CODE = re.compile(r"<\w+[ />]|\bSELECT\b|\bPRAGMA\b|tile_column|^# Settings")
"""Markup, queries and files with comments."""


@cache
def sentences_of_sources():
    """What has to be known, by where it stands."""
    none = {text for texts in NO_SENTENCE.values() for text in texts}
    shown = (files_of_the_window() | FROM_MODEL_PROCESS) - set(NOT_SHOWN)
    return {method.what: f"what {name} is" for name, method in METHODS.items()} | {
        text: f"{path}, line {line}"
        for (path, line), texts in collect().items()
        for text in texts
        if path in shown and text not in none and not CODE.search(text)
    }


def unmarked(template):
    """A template as the sources have it: without marks of metres and numbers."""
    return re.sub(r"\{(\d+):[mn]\}", r"{\1}", template)


@pytest.fixture
def german(application):
    translator = QTranslator()
    assert translator.load(str(FOLDER / "reflight_de.qm"))
    application.installTranslator(translator)
    yield
    application.removeTranslator(translator)


def test_every_sentence_of_the_sources_is_known_to_the_window():
    known = {unmarked(template) for table in sentence_tables().values() for template in table}
    missing = {place: text for text, place in sentences_of_sources().items() if text not in known}
    assert not missing, "add them to groundstation/gui/sentences, run `make translations` and translate them"


@cache
def refusals():
    """What is said of values out of the ranges of parameters, without the names that stand before it."""
    found = set()
    for name, each in {**declared(PlanRequest), **declared(Conditions)}.items():
        wrong = next((value for value in ("?", -1, math.nan) if not each.parameter.holds(value)), None)
        if wrong is not None:
            with pytest.raises(ValueError, match=r"expected .*, got ") as caught:
                each.parameter.check(name.rpartition(".")[2], wrong)
            told = str(caught.value)
            found.add(told if " " in told.partition(":")[0] else told.partition(": ")[2])
    return found


def test_every_range_of_a_parameter_is_known_to_the_window():
    assert len(refusals()) > 6
    assert [text for text in refusals() if phrasebook().find(text) is None] == []


def test_every_sentence_of_the_window_is_still_made_somewhere():
    made = {*sentences_of_sources(), *(unmarked(phrasebook().find(text)[0].source) for text in refusals())}
    for name, table in sentence_tables().items():
        if name not in OTHER_TABLES:
            assert not [text for text in table if unmarked(text) not in made], name


def test_nothing_is_left_out_that_is_not_there():
    made = {text for texts in collect().values() for text in texts}
    assert {text for texts in NO_SENTENCE.values() for text in texts} <= made
    assert set(NOT_SHOWN) <= files_of_the_window()


def test_no_sentence_stands_in_two_tables():
    everything = [text for table in sentence_tables().values() for text in table]
    assert len(everything) == len(set(everything))


@pytest.mark.parametrize("name", sentence_tables())
def test_every_sentence_is_recognised_with_any_values_and_stays_as_it_is_in_english(application, name):
    for template in sentence_tables()[name]:
        values = ["12.5" if mark == "n" else "3.5, -2" if mark == "m" else "Xy" for mark in Template.of(template).kinds]
        text = filled(template, values)
        found = phrasebook().find(text)
        assert found is not None
        assert filled(found[0].source, found[1]) == text
        assert sum(map(len, found[0].literals)) >= len(re.sub(r"\{[^}]*\}", "", template)), found[0].source
        assert own_words(text, METRIC) == as_in_the_window(template, text, values)


def as_in_the_window(template, text, values):
    """A sentence with the window's own buttons and fields in place of commands and options."""
    if template in IN_WINDOW:
        return filled(IN_WINDOW[template], values)
    return in_window_words(text, {option: label for option, (_, label) in field_labels().items()})


COMMANDS = {path.stem.rstrip("_") for path in COMMAND_FOLDER.glob("[a-z]*.py")} | {"reflight", "app.py"}


@pytest.mark.parametrize("name", sentence_tables())
@pytest.mark.parametrize("language", ["en", "de"])
def test_the_window_speaks_no_command_line(application, name, language):
    """No option without its field, no command: whoever reads it has buttons."""
    translator = QTranslator()
    if language == "de":
        assert translator.load("reflight_de", str(FOLDER))
        application.installTranslator(translator)
    try:
        found = []
        for template in sentence_tables()[name]:
            text = filled(template, ["12.5" if mark else "Xy" for mark in Template.of(template).kinds])
            told = own_words(text, METRIC)
            quoted = {words.split()[0] for words in re.findall(r"['`]([a-z][\w. -]*)['`]", told)}
            if re.search(r"(?<![\w-])--[a-z]", told) or quoted & COMMANDS:
                found.append(told)
        assert found == []
    finally:
        application.removeTranslator(translator)


def filled(template, values):
    return re.sub(r"\{(\d+)(?::[mn])?\}", lambda field: values[int(field[1])], template)


ENGLISH = re.compile(r"\b(the|is|are|of|and|with|from|least|most|it|its|not|there|expected|which|has)\b")


def in_german(text, units=METRIC):
    """A text as the German window has it; nothing but names, paths and options may be left in English."""
    told = own_words(text, units)
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
            assert own_words(finding.place, METRIC).startswith("Einsatz")


def test_lengths_in_findings_are_in_feet_in_the_imperial_window(application, planned):
    metric = [finding for finding in check_plan(planned[1], planned[0]) if finding.unit == "m"]
    assert len(metric) >= 5
    n_compared = 0
    for finding in metric:
        told = own_words(finding.message, IMPERIAL)
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
        assert not re.search(r"\d k?m\b", own_words(note, IMPERIAL))


@pytest.mark.parametrize(
    "text",
    [
        "Umbau 5 m hoch.json",
        "/home/the 5 m tower/it is 3 m.json",
        "ValueError: nobody knows this sentence",
        "5 m",
        "",
        ": ; , and  (",
        "a, " * 3000,
        "the path (" * 40 + ")" * 40,
    ],
)
def test_what_is_not_known_stays_as_it_is(german, text):
    for units in UnitSystem:
        assert own_words(text, units) == text


def test_paths_and_names_in_known_sentences_stay(german):
    for name in ("the 5 m tower: all of it", "panel", "home and away", "a; b, c (d)"):
        assert f"'{name}'" in own_words(
            f"the plan was made for site '{name}', this is 'x'; take its own site file", IMPERIAL
        )
        assert own_words(f"/data/{name}.json: cannot be read (Permission denied)", IMPERIAL) == (
            f"/data/{name}.json: nicht lesbar (Zugriff verweigert)"
        )
