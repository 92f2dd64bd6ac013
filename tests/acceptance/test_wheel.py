"""The pilot's whole day by commands, with the program installed from its wheel, far from its sources, on real input."""

import csv
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import numpy as np
import pytest

from missions.mavlink.autopilots import Autopilot
from planning.site.file import read_site
from planning.site.records import panel_corners
from tests.cli.test_simulate_command import vehicle_at_a_port

ROOT = Path(__file__).parents[2]

TRAINING = "n_splats = 150\nmax_splats = 200\n"
"""Settings of a training that shows that everything works, and nothing else."""

COMMAND_S = 1200.0
"""Longest that a command may take: the first ones of a new installation compile their kernels."""

pytestmark = [pytest.mark.slow, pytest.mark.timeout(3600)]


def far_from_sources() -> dict[str, str]:
    """The environment without what leads back to the sources and their compiled kernels."""
    return {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "NUMBA"))}


class Installed:
    """The installed command, in a folder whose name has spaces and umlauts."""

    def __init__(self, folder: Path, program: Path) -> None:
        self.folder, self.program = folder, program
        # Settings are those of a new user.
        self._environment = far_from_sources()
        self._environment["REFLIGHT_CONFIG_DIR"] = str(folder / "config")

    def run(self, *arguments: object, status: int = 0) -> subprocess.CompletedProcess[str]:
        """Run a command, which must end as expected; a refusal is one clear line."""
        return self._ended([self.program], arguments, status)

    def run_module(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        """The same, as `python -m groundstation`."""
        return self._ended([self.program.with_name("python"), "-m", "groundstation"], arguments, 0)

    def run_python(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        """The interpreter that the program is installed for."""
        return self._ended([self.program.with_name("python")], arguments, 0)

    def _ended(self, program, arguments, status):
        done = subprocess.run(
            [*program, *map(str, arguments)], cwd=self.folder, env=self._environment, capture_output=True,
            text=True, timeout=COMMAND_S, check=False,
        )  # fmt: skip
        assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}\n{done.stderr}"
        assert "Traceback" not in done.stderr
        assert "app.py" not in done.stderr, "a command that is not installed"
        if status == 1:
            assert done.stderr.startswith("error: ")
            assert done.stdout == ""
        return done

    def json(self, *arguments: object, status: int = 0) -> dict:
        """Run a command that prints one JSON object."""
        return json.loads(self.run(*arguments, "--json", status=status).stdout)


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The program from its wheel in an environment of its own; only what it needs of others is that of the tests."""
    folder = tmp_path_factory.mktemp("wheel") / "Flug über Glas"
    sources, wheels, venv = folder / "Quellen", folder / "Räder", folder / "Umgebung für Flüge"
    shutil.copytree(
        ROOT, sources, ignore=shutil.ignore_patterns(".*", "__pycache__", "tests", "_build", "build", "*.egg-info")
    )
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    subprocess.run(
        [*pip, "wheel", "--no-deps", "--no-build-isolation", "--no-index", "-w", wheels, sources],
        check=True,
        env=far_from_sources(),
    )
    shutil.rmtree(sources)
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", venv], check=True)
    program = venv / "bin" / "reflight"
    (wheel,) = wheels.glob("*.whl")
    subprocess.run(
        [*pip, "--python", venv, "install", "--no-deps", "--no-index", wheel], check=True, env=far_from_sources()
    )
    # A path alone: what stands in that folder to find the sources is not read.
    packages = next((venv / "lib").glob("python*")) / "site-packages"
    (packages / "needed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    day = folder / "Tag 1, Südseite"
    day.mkdir()
    return Installed(day, program)


def test_the_program_runs_from_the_wheel_alone(installed):
    assert installed.run("--version").stdout.startswith("Reflight ")
    assert installed.run("-h").stdout.startswith("usage: reflight")
    assert installed.run_module("--version").stdout == installed.run("--version").stdout
    assert installed.run_module("-h").stdout.startswith("usage: python -m groundstation")
    for example in ("plan.py", "export.py"):
        text = (ROOT / "docs" / "reference" / "examples" / example).read_text("utf-8")
        assert installed.run_python("-c", text).stdout
    installed.run_module("plan", "single-panel.site.json", "-o", "by module.json", "--views", 3)
    assert (installed.folder / "by module.json").is_file()
    code = "import missions, planning, groundstation as g; print(missions.__file__, planning.__file__, g.__file__)"
    python = installed.program.with_name("python")
    found = subprocess.run(
        [python, "-I", "-c", code], cwd=installed.folder, capture_output=True, text=True, check=True
    ).stdout
    assert found.count(str(installed.program.parents[1])) == 3
    assert str(ROOT) not in found


def test_the_wheel_has_the_manual_and_the_sample_project(installed):
    """The pages of docs, and the archive that the start page opens."""
    code = (
        "from pathlib import Path\n"
        "from groundstation.services.manual import chapters, manual_folder, page_part\n"
        "from groundstation.services.project.sample import unpack_sample\n"
        "folder = manual_folder()\n"
        "pages = [name for chapter in chapters(folder) for name, _ in chapter.pages]\n"
        "print(folder, len(pages), page_part(folder / 'start.md')[0].splitlines()[0])\n"
        "print((folder / 'pictures' / 'window.png').is_file(), unpack_sample(Path('sample')).is_dir())\n"
    )
    said = installed.run_python("-c", code).stdout
    n_pages = sum(1 for path in (ROOT / "docs").rglob("*.md") if "_build" not in path.parts)
    assert str(installed.program.parents[1]) in said
    assert f" {n_pages - 1} # Start here" in said
    assert "True True" in said


def test_morning_a_real_building_is_planned_checked_exported_and_flown(installed, shared_data):
    day = installed.folder
    model = shared_data / "bim" / "curtain_wall_small.ifc"
    said = installed.run("site", "import", model, "-o", "site.json")
    assert "21 panels on 2 facades" in said.stdout
    assert said.stderr.splitlines()[-1] == "next: reflight plan site.json -o site.plan.json"
    planned = installed.json("plan", "site.json", "-o", "plan.json", "--views", 12)
    assert planned["views"] == 12
    assert 0 < planned["covered"] <= planned["reachable_upper_bound"] <= planned["total"] == 21 * 36
    assert "ready to fly" in installed.run("check", "plan.json", "site.json").stdout
    missions = {
        "dji-kmz": "Süd.kmz",
        "mavlink-plan": "Süd.plan",
        "mavlink-wpl": "Süd.waypoints",
        "kml": "Süd.kml",
        "csv": "Süd.csv",
    }
    for kind, name in missions.items():
        installed.run("export", "plan.json", "--format", kind, "-o", name, "--site", "site.json")
        assert (day / name).stat().st_size > 500
    with zipfile.ZipFile(day / "Süd.kmz") as mission:
        assert {"wpmz/template.kml", "wpmz/waylines.wpml"} <= set(mission.namelist())
    for name in ("Süd.kmz", "Süd.plan", "Süd.waypoints"):
        installed.run("import", name, "--site", "site.json", "-o", "zurück.json")
        back = json.loads((day / "zurück.json").read_text())
        assert len(back["viewpoints"]) == 12
        assert back["coverage"]["covered"] == planned["covered"]
    installed.run("brief", "plan.json", "site.json", "-o", "Auftrag.html")
    assert "</html>" in (day / "Auftrag.html").read_text("utf-8")
    flown = installed.json("simulate", "plan.json", "site.json", "-o", "flight.json")
    assert (flown["n_taken"], flown["covered"]) == (12, planned["covered"])
    assert json.loads((day / "flight.json").read_text())["format"].startswith("reflight-flight/")
    with vehicle_at_a_port(day, Autopilot.PX4) as (_, url):
        flown = installed.json(
            "simulate", "plan.json", "site.json", "-o", "link.json", "--link", url, "--logs", "Logs ü"
        )
    assert flown["n_taken"] == 12
    (log,) = (day / "Logs ü").glob("*.tlog")
    report = installed.json("report", "plan.json", "site.json", "--log", log, "-o", "report.json")
    assert report["n_taken"] == 12
    assert (day / "report.json").is_file()
    missing = installed.run("check", "plan nicht da.json", "site.json", status=1)
    assert "plan nicht da.json" in missing.stderr


def test_evening_real_photos_of_glass_become_a_model_with_records(installed, shared_data):
    day, wall = installed.folder, shared_data / "glass" / "wall"
    for name in ("photos", "colmap"):
        shutil.copytree(wall / name, day / f"{name} Südwand", copy_function=shutil.copyfile)
    for name in ("wall.site.json", "wall.site.ply", "wall.obj"):
        shutil.copyfile(wall / name, day / name)
    photos, poses = "photos Südwand", ("--colmap", "colmap Südwand")
    seen = installed.json("photos", photos, "wall.site.json", *poses, "--scale", 4)
    assert seen["total"] == 11 * 36
    # Mirror images on this wall hide its frames from the search for lines: the network finds them.
    found = ("panels", photos, "wall.obj", "-o", "found.site.json", *poses)
    installed.run(*found, "--origin=22.3,114.2,50")
    known, panes = (
        panel_corners(read_site(day / name).site).mean(axis=1) for name in ("wall.site.json", "found.site.json")
    )
    nearest = np.linalg.norm(panes[:, None] - known[None], axis=2).argmin(axis=1)
    assert len(panes) == len(set(nearest)) >= 9
    facade = sorted((shared_data / "facades" / "cmp").glob("*.jpg"))[0]
    installed.run("segment", facade, "-o", "panels.json")
    assert json.loads((day / "panels.json").read_text())["format"].startswith("reflight-panels/")
    installed.run("prepare", photos, "wall.site.json", "-o", "Datensatz", *poses, "--normal-step", 8, "--points", 500)
    assert len(list((day / "Datensatz" / "images").iterdir())) == 17
    (day / "klein.toml").write_text(TRAINING)
    training = ("--preset", "smoke", "--method", "2dgs", "--iterations", 6, "--settings", "klein.toml")
    trained = installed.json("train", "Datensatz", "-o", "Modell", *training)
    assert trained["iterations"] == 6
    assert 0 < trained["splats"] <= 200
    installed.run("render", "Modell", "--views", "Datensatz", "-o", "Bilder", "--width", 64, "--held-out")
    assert len(list((day / "Bilder").glob("*.png"))) == 3
    installed.run("export", "Modell", "--format", "web", "-o", "Seite")
    assert "<html" in (day / "Seite" / "index.html").read_text("utf-8")
    installed.run("records", "Modell", "make", "--objects", "wall.site.json")
    installed.run(
        "records", "Modell", "add", "A-0000", "inspection", "date=2026-03-31", "inspector=Müller", "method=drone",
        "result=crack",
    )  # fmt: skip
    assert "Müller" in installed.run("records", "Modell", "show", "A-0000").stdout
    installed.run("records", "Modell", "export", "-o", "Tabellen")
    with (day / "Tabellen" / "inspections.csv").open(newline="", encoding="utf-8-sig") as file:
        (row,) = csv.DictReader(file)
    assert "Müller" in row.values()
    installed.run("records", "Modell", "check")
