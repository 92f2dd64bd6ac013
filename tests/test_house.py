"""The house rules: import directions, nothing heavy before it is needed, the agreed layout."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def python(code):
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )


def test_import_rules_hold():
    from importlinter.cli import lint_imports

    assert lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True) == 0


@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("planning", ["torch", "PySide6", "pyvista", "pymavlink", "matplotlib"]),
        ("missions", ["torch", "PySide6", "pyvista", "open3d"]),
        ("groundstation.services", ["torch", "PySide6", "pyvista"]),
        ("groundstation.cli", ["torch", "PySide6", "pyvista"]),
    ],
)
def test_importing_every_module_of_a_package_loads_nothing_it_must_not(package, forbidden):
    code = f"""
import importlib, pkgutil, sys
package = importlib.import_module({package!r})
for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
    importlib.import_module(module.name)
print([name for name in {forbidden!r} if name in sys.modules])
"""
    done = python(code)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


@pytest.mark.alone
def test_help_answers_in_under_half_a_second_and_names_the_commands():
    fastest = 9.0
    for _ in range(3):
        started = time.perf_counter()
        done = subprocess.run([sys.executable, "app.py", "-h"], cwd=ROOT, capture_output=True, text=True, check=False)
        fastest = min(fastest, time.perf_counter() - started)
    assert done.returncode == 0
    commands = (
        "demo project site plan check compare brief export import simulate report topup signing route tradeoff "
        "train render score organise records"
    )
    for command in commands.split():
        assert f"\n    {command} " in done.stdout
    assert fastest < 0.5


def test_top_level_holds_the_agreed_folders_and_nothing_else_of_ours():
    folders = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "__"))}
    agreed = {"groundstation", "planning", "reconstruction", "missions", "tests", "docs"}
    made = {"demo-out", "benchmark-out", "reflight.egg-info"}
    assert folders - made == agreed
    assert [path.name for path in ROOT.glob("*.py")] == ["app.py"]


def test_only_one_module_each_imports_nlopt_casadi_and_pyvrp():
    for library in ("nlopt", "casadi", "pyvrp"):
        users = [
            path.relative_to(ROOT).as_posix()
            for folder in ("planning", "missions", "groundstation")
            for path in (ROOT / folder).rglob("*.py")
            if f"import {library}" in path.read_text("utf-8") or f"from {library}" in path.read_text("utf-8")
        ]
        assert len(users) == 1, (library, users)
