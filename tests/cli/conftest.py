"""The command line called in this process, and sites and plans made once for all of its tests."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from groundstation.cli.main import main
from groundstation.services.plan.planning import plan_site
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from tests.planning.revision.cases import QUICK

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Done:
    status: int
    out: str
    err: str

    @property
    def json(self):
        return json.loads(self.out)

    @property
    def error(self):
        """The one line of a refusal."""
        assert self.status == 1, self
        lines = self.err.splitlines()
        assert len(lines) == 1, self.err
        assert lines[0].startswith("error: ")
        assert "failed where it should not" not in lines[0]
        assert self.out == ""
        return lines[0]


@pytest.fixture(autouse=True)
def _own_settings(tmp_path_factory, monkeypatch):
    """Flights by command are entered in a log book of the test's own."""
    if "REFLIGHT_CONFIG_DIR" not in os.environ:
        monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.getbasetemp() / "config"))


@pytest.fixture
def reflight(capsys):
    """Run a command line in this process."""

    def run(*arguments):
        status = main([str(argument) for argument in arguments], lambda _wish: pytest.fail("the window was opened"))
        captured = capsys.readouterr()
        return Done(status, captured.out, captured.err)

    return run


@pytest.fixture
def process():
    """Run a command line as a user does: in a process of its own."""

    def run(*arguments, **options):
        command = [sys.executable, "-W", "error", str(ROOT / "app.py"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=500, check=False, **options)

    return run


@pytest.fixture(scope="session")
def pane(tmp_path_factory):
    """Folder with the smallest site, `site.json`, and a plan of it, `plan.json`; tests must not change it."""
    folder = tmp_path_factory.mktemp("pane")
    site = write_scene("single-panel", folder).rename(folder / "site.json")
    plan_site(site, PlanRequest(n_views=6, greedy=QUICK), folder / "plan.json")
    return folder


@pytest.fixture
def changed(tmp_path):
    """A changed copy of a JSON file; where a value is to go, `...` takes the key out."""

    def copy(source, *path_and_value):
        *path, last, value = path_and_value
        content = json.loads(source.read_text())
        place = content
        for key in path:
            place = place[key]
        if value is ...:
            del place[last]
        else:
            place[last] = value
        target = tmp_path / f"changed-{source.name}"
        target.write_text(json.dumps(content))
        return target

    return copy


BAD_CONTENTS = {
    "empty": b"",
    "blank": b" \n",
    "binary": bytes(range(256)),
    "truncated": b'{"format": "reflight-plan/1", "site": "off',
    "list": b"[]",
    "null": b"null",
    "another format": b'{"format": "reflight-flight/1"}',
    "deep": b"[" * 600 + b"]" * 600,
    "deeper": b"[" * 100_000,
    "large number": b'{"seed": ' + b"1" * 5000 + b"}",
    "not a number": b'{"format": "reflight-plan/1", "seed": NaN}',
    "nothing": b"{}",
}
"""Files that are neither plan nor site, by what is wrong with them."""


@pytest.fixture(params=sorted(BAD_CONTENTS))
def bad_file(request, tmp_path):
    """A file that is neither plan nor site."""
    path = tmp_path / "bad.json"
    path.write_bytes(BAD_CONTENTS[request.param])
    return path
