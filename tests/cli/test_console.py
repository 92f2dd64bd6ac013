"""What all commands print: findings, the next command, counts."""

from pathlib import Path

import pytest

from groundstation.cli.console import counted, named_like, print_findings, print_next, run_job
from planning.base.findings import Finding, Severity


def test_equal_findings_are_printed_once_with_their_number_and_the_rest_is_counted(capsys):
    corner = [Finding(Severity.NOTE, "turn", "cuts the corner", f"waypoint {i}") for i in range(12)]
    panels = [Finding(Severity.WARNING, "unseen", f"panel {i} is not seen", f"panel {i}") for i in range(9)]
    print_findings([*corner, *panels])
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.splitlines()
    assert lines[0] == "note: cuts the corner (12 times, the first: waypoint 0)"
    assert lines[1] == "warning: panel 0 is not seen"
    assert lines[-1] == "warning: 4 more like this (--json lists all)"
    assert len(lines) == 1 + 5 + 1


def test_a_finding_says_where_it_is(capsys):
    print_findings([Finding(Severity.WARNING, "height", "high up", "sortie 3")])
    assert capsys.readouterr().err == "warning: sortie 3: high up\n"


def test_the_next_command_can_be_pasted_into_a_shell(capsys):
    print_next("check", Path("my plan.json"), "b.json")
    assert capsys.readouterr().err == "next: app.py check 'my plan.json' b.json\n"


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("app.py", "app.py"),
        ("/opt/ground station/bin/reflight", "reflight"),
        ("reflight.exe", "reflight"),
        ("/opt/groundstation/__main__.py", "python -m groundstation"),
    ],
)
def test_the_next_command_begins_as_this_one_did(capsys, monkeypatch, typed, told):
    monkeypatch.setattr("sys.argv", [typed, "demo"])
    print_next("check", "b.json")
    assert capsys.readouterr().err == f"next: {told} check b.json\n"


@pytest.mark.parametrize(
    ("name", "made"),
    [
        ("office.site.json", "office.kmz"),
        ("office.plan.json", "office.kmz"),
        ("v1.2.json", "v1.2.kmz"),
        ("office", "office.kmz"),
        (".site.json", ".site.json.kmz"),
    ],
)
def test_files_are_named_after_what_they_are_made_from(name, made):
    assert named_like(Path("folder") / name, ".kmz") == Path("folder") / made


def test_things_are_counted_in_english():
    assert [counted(n, "sortie") for n in (0, 1, 2)] == ["0 sorties", "1 sortie", "2 sorties"]


def test_progress_is_written_over_and_taken_away_on_a_terminal_only(capsys, monkeypatch):
    def work(context):
        context.report("looking", 1, 4)
        return "found"

    assert run_job("search", work) == "found"
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    assert run_job("search", work) == "found"
    err = capsys.readouterr().err
    assert "looking  25 %" in err
    assert err.endswith("\r\033[K")
    assert "\n" not in err
