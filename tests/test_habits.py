"""Files about the project itself say what is so."""

import re
from pathlib import Path

import pytest

from groundstation import __version__
from tests.coverage_table import table

ROOT = Path(__file__).parents[1]


def test_the_version_to_cite_is_that_of_the_program():
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    assert f"\n## {__version__}" in (ROOT / "CHANGELOG.md").read_text("utf-8")


@pytest.mark.parametrize("name", ["CITATION.cff", ".pre-commit-config.yaml"])
def test_files_for_other_programs_are_yaml_with_what_they_need(name):
    yaml = pytest.importorskip("yaml")
    content = yaml.safe_load((ROOT / name).read_text("utf-8"))
    if name == "CITATION.cff":
        assert {"cff-version", "message", "title", "authors"} <= set(content)
    else:
        assert all(hook["entry"].startswith(".venv/bin/") for hook in content["repos"][0]["hooks"])


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"])
def test_files_and_commands_that_are_named_exist(name):
    text = (ROOT / name).read_text("utf-8")
    paths = re.findall(r"`((?:planning|missions|reconstruction|groundstation|docs|tests)/[\w/.]+)`", text)
    absent = [path for path in paths if "XX" not in path and not (ROOT / path).exists()]
    assert absent == []
    makefile = (ROOT / "Makefile").read_text("utf-8")
    assert [target for target in re.findall(r"`make ([\w-]+)`", text) if f"\n{target}:" not in makefile] == []


def test_coverage_is_told_by_room():
    def file(n_run, n_lines):
        return {"summary": {"covered_lines": n_run, "num_statements": n_lines}}

    measured = {
        "files": {"planning/geo/a.py": file(1, 2), "planning/geo/b.py": file(2, 2), "planning/c.py": file(0, 4)}
    }
    assert table(measured).splitlines()[2:] == [
        "| planning | 4 | 0% |",
        "| planning/geo | 4 | 75% |",
        "| all | 8 | 38% |",
    ]
