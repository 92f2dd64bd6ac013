"""Plug-ins that somebody installs: they are found, used by command and shown, and named where they fail."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reconstruction.training.synthetic_data_set import write_data_set

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = ("glider", "flight_table", "bare_points", "tinted", "broken")


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Folder that the packages were installed into by pip, without a network."""
    folder = tmp_path_factory.mktemp("plug-ins")
    sources = [shutil.copytree(HERE / name, folder / "sources" / name) for name in PACKAGES]
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    target = folder / "installed"
    subprocess.run([*pip, "--no-index", "--no-build-isolation", "--target", target, *sources], check=True)
    return target


@pytest.fixture
def reflight(installed, tmp_path):
    """Run a command with the packages installed."""

    def run(*arguments, status=0):
        environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(installed)))}
        command = [sys.executable, "-m", "groundstation", *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == status, done.stderr
        assert "Traceback" not in done.stderr
        return done

    return run


@pytest.fixture
def flight(tmp_path):
    """A site and a plan in the folder that commands run in."""
    from groundstation.services.plan.planning import plan_site
    from planning.request import PlanRequest
    from planning.site.bundled import write_scene

    site = write_scene("single-panel", tmp_path).rename(tmp_path / "site.json")
    plan_site(site, PlanRequest(n_views=4), tmp_path / "plan.json")


@pytest.mark.slow
def test_all_plug_ins_are_listed_and_those_that_fail_are_named(reflight):
    done = reflight("--plugins")
    assert "reflight-glider 1.0\n" in done.stdout
    for name in ("crumbling", "kml", "number"):
        assert f"the plug-in '{name}' of reflight-broken 1.0 is left out: " in done.stderr
    assert "a_package_that_nobody_has" in done.stderr
    assert done.stderr.count("warning: ") == 3


@pytest.mark.slow
def test_an_aircraft_of_a_plug_in_is_listed_and_flown(reflight, flight):
    assert "\nexample_glider " in reflight("plan", "site.json", "--profile", "list").stdout
    reflight("plan", "site.json", "-o", "own.json", "--views", 4, "--profile", "example_glider")
    assert reflight("check", "own.json", "site.json", "--json").stdout.startswith("{")


@pytest.mark.slow
def test_a_mission_format_of_a_plug_in_is_offered_and_written(reflight, flight, tmp_path):
    assert "flight-table  reflight-flight-table 1.0" in reflight("export", "-h").stdout
    reflight("export", "plan.json", "--format", "flight-table", "-o", "a.table")
    assert len((tmp_path / "a.table").read_text().splitlines()) == 1 + 4


@pytest.mark.slow
def test_the_help_lists_no_plug_in_that_is_left_out(reflight):
    done = reflight("export", "-h")
    listed = done.stdout.partition("from plug-ins:\n")[2]
    assert sorted(line.split()[0] for line in listed.splitlines()) == ["bare-points", "failing", "flight-table"]
    assert "the plug-in 'kml' of reflight-broken 1.0 is left out: there is another one of that name" in done.stderr


@pytest.mark.slow
def test_a_mission_format_that_fails_is_named_and_nothing_is_written(reflight, flight, tmp_path):
    done = reflight("export", "plan.json", "--format", "failing", "-o", "a.failing", status=1)
    assert "error: the plug-in 'failing' of reflight-broken 1.0 failed: AttributeError: " in done.stderr
    done = reflight("export", "plan.json", "--format", "number", "-o", "a.number", status=1)
    assert "expected its entry point to stand for a MissionFormat, got int" in done.stderr
    assert not list(tmp_path.glob("a.*"))


@pytest.mark.slow
def test_a_name_of_this_program_stays_its_own(reflight, flight, tmp_path):
    reflight("export", "plan.json", "--format", "kml", "-o", "a.kml")
    assert b"<kml" in (tmp_path / "a.kml").read_bytes()


@pytest.mark.long
def test_the_help_does_not_wait_for_plug_ins(installed):
    code = "import sys; from groundstation.cli.main import main; main(['-h'], None); "
    code += "print('importlib.metadata' in sys.modules)"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(installed)))}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.endswith("False\n")


@pytest.mark.slow
def test_the_lists_of_the_window_have_what_plug_ins_add(installed):
    code = """
from PySide6.QtWidgets import QApplication
application = QApplication([])
from groundstation.gui.mission.export_dialog import ExportForm
from groundstation.gui.model.model_page import ExportDialog
from groundstation.gui.plan.plan_form import AircraftBox
from groundstation.services.reconstruct.choices import method_rows
from groundstation.services.units import UnitSystem
missions, models, aircraft = ExportForm(UnitSystem.METRIC), ExportDialog(()), AircraftBox()
print(missions._format.findText("Flight table (.table)") > 0)
print(models.format.findText("Bare points") > 0)
print(aircraft.findData("example_glider") >= 0)
print("tinted" in [row.name for row in method_rows()])
"""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(installed)))}
    environment["QT_QPA_PLATFORM"] = "offscreen"
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["True"] * 4, done.stderr


@pytest.mark.slow
def test_a_method_and_a_model_format_of_plug_ins_are_used_together(reflight, tmp_path):
    write_data_set(tmp_path / "data", n=8)
    (tmp_path / "quick.toml").write_text("n_splats = 150\nmax_splats = 200\n")
    quick = ("--preset", "smoke", "--settings", "quick.toml", "--iterations", 6)
    done = reflight("train", "data", "-o", "model", "--method", "tinted", *quick, "--json")
    trained = json.loads(done.stdout)
    assert trained["method"] == "tinted"
    done = reflight("export", "model", "--format", "bare-points", "-o", "a.points")
    assert "points have no colours" in done.stdout
    assert len((tmp_path / "a.points").read_text().splitlines()) == trained["splats"]


@pytest.mark.slow
def test_the_window_lists_plug_ins_and_says_which_are_left_out(installed, tmp_path):
    code = """
import os
from PySide6.QtWidgets import QApplication, QMessageBox
application = QApplication([])
from groundstation.gui.window.menus import Menus
from groundstation.gui.window.project_controller import ProjectController
controller = ProjectController(application)
controller.show()
application.processEvents()
next(each for each in vars(controller).values() if isinstance(each, Menus))._show_about()
(box,) = [each for each in application.topLevelWidgets() if isinstance(each, QMessageBox)]
print(box.text())
os._exit(0)
"""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(installed))), "PYTHONUNBUFFERED": "1"}
    environment |= {"QT_QPA_PLATFORM": "offscreen", "REFLIGHT_CONFIG_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    about = done.stdout
    assert "glider: aircraft (reflight-glider 1.0)" in about
    assert about.count("of reflight-broken 1.0 is left out: ") == 3, done.stderr
