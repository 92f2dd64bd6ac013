"""The frame around all commands: exit statuses, one line for an error, streams that break, Ctrl-C."""

import argparse
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation import __version__
from groundstation.cli.main import WindowOptions, build_parser, main
from groundstation.cli.options import new_folder
from missions.flight.flight_file import flight_of, write_flight
from planning.base.errors import InputError, OperationCancelled
from planning.parameters import LARGEST_SEED
from planning.plan import read_plan
from planning.site.bundled import write_scene
from planning.site.file import read_site
from tests.cli.conftest import ROOT
from tests.reconstruction.training.synthetic_data_set import write_data_set
from tests.slow import slow


def test_version_is_told(reflight):
    done = reflight("--version")
    assert done.status == 0
    assert done.out == f"Reflight {__version__}\n"


def test_without_a_command_the_window_opens():
    wishes = []
    assert main([], lambda request: wishes.append(request) or 7) == 7
    assert main(["--screenshots", "shots", "--site", "a.json"], lambda request: wishes.append(request) or 0) == 0
    assert wishes == [WindowOptions(), WindowOptions(None, Path("shots"), Path("a.json"))]
    assert main(["--site", "a.json"], lambda _wish: 0) == 2
    assert main(["--open", "project", "demo"], lambda _wish: 0) == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["plan"],
        ["plan", "site.json"],
        ["plan", "site.json", "-o"],
        ["plan", "site.json", "-o", "p.json", "--method", "magic"],
        ["plan", "site.json", "-o", "p.json", "--views", "many"],
        ["plan", "site.json", "-o", "p.json", "--min-distance", "nan"],
        ["plan", "site.json", "-o", "p.json", "--speed", "inf"],
        ["plan", "site.json", "-o", "p.json", "--views", "3", "--batteries", "1"],
        ["check", "plan.json"],
        ["export", "plan.json", "-o", "m.kmz"],
        ["export", "plan.json", "-o", "m.kmz", "--format", "zip"],
        ["import", "--site", "site.json", "-o", "plan.json"],
        ["site"],
        ["site", "import", "a.ifc"],
        ["route"],
        ["demo", "--scene", "castle"],
        ["--bogus"],
    ],
)
def test_wrong_usage_ends_with_status_2_and_shows_the_usage(reflight, arguments):
    done = reflight(*arguments)
    assert done.status == 2
    assert done.out == ""
    assert done.err.startswith("usage: app.py")
    assert "Traceback" not in done.err


def test_a_wrong_choice_lists_names_as_they_are_typed(reflight):
    """Not as Python shows members of an enumeration."""
    error = reflight("export", "plan.json", "--format", "doc", "-o", "out").err
    assert "choose from 'dji-kmz', 'mavlink-plan'" in error
    assert "<" not in error.splitlines()[-1]


@pytest.mark.parametrize("command", ["demo", "site", "plan", "check", "export", "import", "route", "tradeoff"])
def test_every_command_explains_itself(reflight, command):
    done = reflight(command, "-h")
    assert done.status == 0
    assert done.out.startswith(f"usage: app.py {command}")
    assert done.err == ""


def failing_with(error, monkeypatch):
    def fail(*_arguments, **_options):
        raise error

    monkeypatch.setattr("groundstation.services.plan.planning.check_files", fail)


def outputs(parser, path=()):
    """Every option of a command that says where something is written."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                yield from outputs(command, (*path, name))
        elif "--out" in action.option_strings:
            yield " ".join(path), action


CHECKED_BY_FORMAT = {"brief", "export", "logbook", "records export", "score weights"}
"""Where what is written depends on more than the command, or has one ending only; they have tests of their own."""


@pytest.mark.parametrize("ending", [".xlsx", ".json", ".kmz"])
def test_weights_are_written_as_weights_only(tmp_path, ending):
    action = dict(outputs(build_parser()))["score weights"]
    with pytest.raises(InputError, match=f"not written: the name ends in {ending}"):
        action.type(str(tmp_path / f"weights{ending}"))
    assert action.type(str(tmp_path / "weights.safetensors")) == tmp_path / "weights.safetensors"


def test_no_output_has_a_name_that_says_something_else_is_in_it(tmp_path):
    found = {name: action for name, action in outputs(build_parser()) if name not in CHECKED_BY_FORMAT}
    assert len(found) > 18
    (tmp_path / "tower.json").mkdir()
    for name, action in found.items():
        for ending in (".xlsx", ".pdf", ".png", ".kmz"):
            with pytest.raises(InputError, match=f"not written: the name ends in {ending}"):
                action.type(str(tmp_path / f"tower{ending}"))
        # What tells nothing wrong is taken as it is; a folder that there is may be called as its owner likes.
        for good in ("tower", "tower.model", "tower.json" if action.type is new_folder else "a.site.json", "No. 12"):
            assert action.type(str(tmp_path / good)) == tmp_path / good, name


@pytest.mark.parametrize("command", ["segment", "train"])
def test_a_contradictory_name_is_one_line_before_anything_is_read(reflight, tmp_path, command):
    error = reflight(command, tmp_path / "missing", "-o", tmp_path / "result.pdf").error
    assert "result.pdf: not written: the name ends in .pdf" in error
    assert list(tmp_path.iterdir()) == []


def test_a_fault_of_the_program_is_one_line_that_says_where_the_traceback_is(reflight, monkeypatch):
    failing_with(ZeroDivisionError("division\nby zero"), monkeypatch)
    done = reflight("check", "p.json", "s.json")
    assert done.status == 1
    line = done.err.rstrip("\n")
    assert "\n" not in line
    assert "ZeroDivisionError: division by zero" in line
    report = Path(line.rpartition(" with ")[2])
    assert "Traceback" in report.read_text()
    report.unlink()


def test_debug_shows_the_traceback(reflight, monkeypatch):
    failing_with(ZeroDivisionError(), monkeypatch)
    with pytest.raises(ZeroDivisionError):
        reflight("--debug", "check", "p.json", "s.json")
    done = reflight("--debug", "plan", "missing.json", "-o", "p.json")
    assert "Traceback" in done.err
    assert done.err.splitlines()[-1].startswith("error: missing.json")


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OperationCancelled("check was cancelled")])
def test_a_cancelled_command_says_so_and_ends_with_status_1(reflight, monkeypatch, error):
    failing_with(error, monkeypatch)
    done = reflight("check", "p.json", "s.json")
    assert (done.status, done.out, done.err) == (1, "", "cancelled\n")


def test_an_error_of_the_system_names_the_file(reflight, monkeypatch):
    failing_with(PermissionError(13, "Permission denied", "/disk/full"), monkeypatch)
    assert reflight("check", "p.json", "s.json").error == "error: /disk/full: Permission denied"


def test_control_characters_from_a_damaged_file_do_not_reach_the_terminal(reflight, tmp_path):
    file = tmp_path / "a.tsp"
    file.write_bytes(b"NAME : x\n\x1b[2J\x07\n")
    error = reflight("route", file).error
    assert error.isprintable()
    assert "[2J" in error


@pytest.mark.slow
def test_a_site_with_characters_the_terminal_lacks_is_no_error(process, pane):
    environment = {**os.environ, "PYTHONIOENCODING": "ascii:strict"}
    done = process("check", pane / "plan.json", pane / "größe.json", env=environment)
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")
    assert "gr\\xf6\\xdfe.json: expected a site file" in done.stderr


@pytest.mark.long
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full exists on Linux only")
def test_output_that_cannot_be_written_is_one_line_and_status_1(pane):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "app.py", "check", pane / "plan.json", pane / "site.json"],
            cwd=ROOT,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")
    assert "No space left on device" in done.stderr.splitlines()[0]
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", slow("1")])
def test_a_reader_that_leaves_early_is_no_error_message(pane, unbuffered):
    read_end, write_end = os.pipe()
    os.close(read_end)
    done = subprocess.run(
        [sys.executable, "app.py", "check", pane / "plan.json", pane / "site.json"],
        cwd=ROOT,
        stdout=write_end,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
    )
    os.close(write_end)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "error" not in done.stderr
    assert "Exception ignored" not in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="closes file descriptors as a POSIX shell does")
def test_closed_streams_do_no_harm(pane):
    line = f'"{sys.executable}" app.py check "{pane / "plan.json"}" "{pane / "site.json"}" >&- 2>&-'
    assert subprocess.run(line, shell=True, cwd=ROOT, check=False).returncode == 0


def processor_s(pid):
    """How long a process has worked; in whole seconds on some systems."""
    told = subprocess.run(["ps", "-o", "cputime=", "-p", str(pid)], capture_output=True, text=True, check=True)
    return sum(60**place * float(part) for place, part in enumerate(reversed(told.stdout.strip().split(":"))))


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT as a POSIX terminal does")
def test_ctrl_c_in_the_middle_of_a_plan_leaves_no_file_and_no_traceback(tmp_path):
    site = write_scene("tower", tmp_path)
    before = set(tmp_path.iterdir())
    command = [sys.executable, "app.py", "plan", str(site), "-o", str(tmp_path / "plan.json"), "--time-budget", "9999"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}

    def as_in_a_terminal():
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # shells start jobs in the background with it ignored

    with subprocess.Popen(command, cwd=ROOT, preexec_fn=as_in_a_terminal, **pipes) as running:
        while processor_s(running.pid) < 2:
            with pytest.raises(subprocess.TimeoutExpired):
                running.wait(0.1)
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=400)
    assert running.returncode == 1
    assert (out, err) == ("", "cancelled\n")
    assert set(tmp_path.iterdir()) == before


NEEDS_COLMAP = {"coarse"}
"""Without that extra they refuse all photos, whatever the seed."""

SEEDED = {
    "plan": ("plan", "{pane}/site.json", "-o", "{out}/p.json", "--views", 4, "--candidates", 300, "--time-budget", 3),
    "route": ("route", "{out}/square.tsp", "--time-budget", 0.3),
    "route pyvrp": ("route", "{out}/square.tsp", "--method", "pyvrp", "--time-budget", 0.3),
    "simulate": ("simulate", "{pane}/plan.json", "{pane}/site.json", "-o", "{out}/f.json"),
    "topup": ("topup", "{pane}/none.json", "{pane}/plan.json", "{pane}/site.json", "-o", "{out}/t.json"),
    "tradeoff plan": (
        *("tradeoff", "plan", "{pane}/site.json", "-o", "{out}/a", "--views", 3, "--candidates", 200, "--jobs", 1),
        *("--time-budget", 2, "--seeds", 2, "--methods", "greedy", "--precisions", "f32", "--steps", "30"),
    ),
    "tradeoff route": ("tradeoff", "route", "{out}/square.tsp", "-o", "{out}/b", "--seconds", 0.3),
    "train": (
        *("train", "{data}", "-o", "{out}/m", "--preset", "smoke", "--iterations", 4, "--method", "2dgs"),
        *("--settings", "{data}/../few.toml"),
    ),
    "tradeoff train": (
        *("tradeoff", "train", "{data}", "-o", "{out}/c", "--preset", "smoke", "--iterations", 4),
        *("--method", "2dgs", "--vary", "raster.tile_px=16"),
    ),
    "scene": ("scene", "render", "planar", "-o", "{out}/s", "--views", 1, "--width", 48),
    "tradeoff scene": (
        *("tradeoff", "scene", "planar-far", "-o", "{out}/d", "--width", 48, "--views", 1, "--truth-rays", 0),
        *("--samples", "1", "--widths", "24", "--turn", "none"),
    ),
}
"""Commands with a seed, on the smallest input they take."""

RENDERS = {"scene", "tradeoff scene", "train", "tradeoff train"}
"""These take some seconds."""


def seeded_commands(parser, words=()):
    """Words of all commands below a parser that take a seed."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                yield from seeded_commands(below, (*words, name))
        elif "--seed" in action.option_strings:
            yield " ".join(words)


def test_every_command_with_a_seed_is_tried_with_the_smallest_and_the_largest():
    tried = {" ".join(str(word) for word in words[:2]) for words in SEEDED.values()}
    for command in set(seeded_commands(build_parser())) - NEEDS_COLMAP:
        assert command in tried or command in {words.split()[0] for words in tried}, command


@pytest.fixture(scope="module")
def seed_data(tmp_path_factory):
    """A data set to train on, and settings that are quick."""
    folder = tmp_path_factory.mktemp("seeds")
    write_data_set(folder / "data", n=8)
    (folder / "few.toml").write_text("n_splats = 150\nmax_splats = 200\n")
    return folder / "data"


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", [slow(0), LARGEST_SEED])
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in RENDERS else name for name in SEEDED]
)
def test_every_seed_of_63_bits_is_taken(reflight, pane, seed_data, tmp_path, name, seed):
    plan = read_plan(pane / "plan.json")
    write_flight(pane / "none.json", flight_of(plan, read_site(pane / "site.json"), ()))
    square = "NAME: s\nTYPE: TSP\nDIMENSION: 4\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n"
    (tmp_path / "square.tsp").write_text(square + "1 0 0\n2 10 10\n3 10 0\n4 0 10\nEOF\n")
    words = [str(word).format(pane=pane, out=tmp_path, data=seed_data) for word in SEEDED[name]]
    done = reflight(*words, "--seed", seed)
    assert done.status == 0, done.err


@pytest.mark.slow
def test_findings_errors_and_the_brief_are_german_where_that_is_asked_for(reflight, tmp_path):
    from planning.site.bundled import write_scene

    done = reflight("--language", "de", "check", tmp_path / "nope.json", tmp_path / "nope.json")
    assert done.err.startswith("Fehler: ")
    assert "erwartet wurde eine Plandatei" in done.err
    site = write_scene("single-panel", tmp_path)
    plan = tmp_path / "p.plan.json"
    done = reflight("--language", "de", "plan", site, "--views", 3, "-o", plan)
    assert done.status == 0
    assert "warning" not in done.err
    done = reflight("--language", "de", "brief", plan, site, "-o", tmp_path / "brief.html")
    assert done.status == 0
    page = (tmp_path / "brief.html").read_text("utf-8")
    assert "Flugblatt" in page or "Flugbriefing" in page or "Start und Landung" in page
    assert "Take-off and landing" not in page
    assert "error: " in reflight("check", tmp_path / "nope.json", tmp_path / "nope.json").err


ENDING = """
import atexit, sys
from groundstation.__main__ import run
from groundstation.cli import main

class Held:
    def __del__(self):
        print("freed")

build_parser = main.build_parser

def build_parser_and_register():
    atexit.register(lambda: print("last words"))
    return build_parser()

main.build_parser = build_parser_and_register
held = Held()
sys.argv = ["reflight", *sys.argv[1:]]
sys.exit(run())
"""


@pytest.mark.parametrize(
    ("arguments", "status"), [(["--version"], 0), (["check", "no-plan", "no-site"], 1), (["-x"], 2)]
)
def test_a_command_ends_behind_all_that_is_still_to_be_done_and_frees_nothing_one_by_one(arguments, status):
    command = [sys.executable, "-c", ENDING, *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[-1:]) == (status, ["last words"])
