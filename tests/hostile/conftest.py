"""The files that all tests here start from, and the process that does their cases."""

from __future__ import annotations

import json
import os
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
        self._said = (folder / "said.txt").open("w+")
        home = {"HOME": str(folder), "REFLIGHT_CONFIG_DIR": str(folder / "config"), "TMPDIR": str(folder)}
        self._process = subprocess.Popen(
            [sys.executable, "-W", "error", "-m", "tests.hostile.forks"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said, text=True, cwd=ROOT,
            env={**os.environ, **home, "PYTHONPATH": str(ROOT), "NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        self._ask(LOADED)

    def run(self, job: dict[str, object]) -> dict[str, object]:
        """Do a case."""
        return json.loads(self._ask(job))

    def _ask(self, question: object) -> str:
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        assert answer, Path(self._said.name).read_text()
        return answer

    def close(self) -> None:
        """End it."""
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()
        self._said.close()


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
