"""The files that all tests here start from, and the process that does their cases."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hostile.inputs import complete_workspace, make_workspace

ROOT = Path(__file__).resolve().parents[2]

LOADED = (
    "planning.planner", "planning.site.importing.importer", "planning.geo.mesh", "missions.formats.registry",
    "missions.flight.logs.read", "groundstation.services.project.folder", "groundstation.services.plan.planning",
    "groundstation.services.reconstruct.training", "groundstation.services.model.export", "cv2", "trimesh",
    "scipy.sparse", "rasterio", "planning.site.importing.attach_terrain",
    "reconstruction.training.model.saved", "reconstruction.records.book", "reconstruction.metrics.lpips",
    "groundstation.services.project.recovery",
)  # fmt: skip
"""Modules that take long to load, or whose memory is not the file's."""


class Forks:
    """The process that does the cases; see `tests.hostile.forks`."""

    def __init__(self, folder: Path) -> None:
        self.said = (folder / "said.txt").open("w+")
        home = {"HOME": str(folder), "REFLIGHT_CONFIG_DIR": str(folder / "config"), "TMPDIR": str(folder)}
        threads = {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        self._environment = {**os.environ, **home, **threads, "PYTHONPATH": str(ROOT)}
        self._process: subprocess.Popen[str] | None = None

    def run(self, job: dict[str, object]) -> dict[str, object]:
        """Do a case."""
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-W", "error", "-m", "tests.hostile.forks"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.said, text=True, cwd=ROOT,
                env=self._environment, start_new_session=True,
            )  # fmt: skip
            self._ask(LOADED)
        return json.loads(self._ask(job))

    def _ask(self, question: object) -> str:
        """Its answer; where none is waited for any more, it ends: the next case would be told this one's."""
        try:
            self._process.stdin.write(json.dumps(question) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except BaseException:
            os.killpg(self._process.pid, signal.SIGKILL)
            self.close()
            raise
        assert answer, Path(self.said.name).read_text()
        return answer

    def close(self) -> None:
        """End it."""
        if self._process is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
            self._process.wait()
            self._process.stdout.close()
            self._process = None


@pytest.fixture(scope="session")
def workspace(tmp_path_factory):
    folder = tmp_path_factory.mktemp("workspace")
    make_workspace(folder)
    return folder


@pytest.fixture(scope="session")
def full_workspace(workspace):
    complete_workspace(workspace)
    return workspace


@pytest.fixture(scope="session")
def forks(tmp_path_factory):
    opened = Forks(tmp_path_factory.mktemp("forks"))
    yield opened
    opened.close()
    opened.said.close()
