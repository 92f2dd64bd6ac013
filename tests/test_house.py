"""The house rules: import directions, nothing heavy before it is needed, the agreed layout."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def python(code):
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=500, check=False
    )


@pytest.mark.lint
@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("planning", ["torch", "PySide6", "pyvista", "pymavlink", "matplotlib", "rasterio", "numba"]),
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
@pytest.mark.parametrize("program", [["app.py"], ["-m", "groundstation"]], ids=["app.py", "module"])
def test_help_answers_in_under_half_a_second_and_names_the_commands(program, tmp_path):
    """Of processor time, which others on the machine do not lengthen by making it wait; compiled, as for a user."""
    own = {"PYTHONPYCACHEPREFIX": str(tmp_path), "PYTHONDONTWRITEBYTECODE": ""}
    command, fastest = [sys.executable, *program, "-h"], 9.0
    for _ in range(4):
        before = _children_s()
        done = subprocess.run(
            command, cwd=ROOT, env={**os.environ, **own}, capture_output=True, text=True, check=False, timeout=300
        )
        fastest = min(fastest, _children_s() - before)
    assert done.returncode == 0
    commands = (
        "demo project site plan check compare brief export import simulate report topup signing route tradeoff "
        "train render score organise records"
    )
    for command in commands.split():
        assert f"\n    {command} " in done.stdout
    assert 0.0 < fastest < 0.5


def _children_s() -> float:
    """Processor time of all processes that have been waited for."""
    times = os.times()
    return times.children_user + times.children_system


def test_top_level_holds_the_agreed_folders_and_nothing_else_of_ours():
    folders = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "__"))}
    agreed = {"groundstation", "planning", "reconstruction", "missions", "tests", "docs"}
    made = {"demo-out", "benchmark-out", "reflight.egg-info", "reflight_groundstation.egg-info"}
    assert folders - made == agreed
    assert [path.name for path in ROOT.glob("*.py")] == ["app.py"]


@pytest.mark.lint
def test_only_one_module_each_imports_nlopt_casadi_and_pyvrp_and_two_rasterio():
    # Rasters are heights below a site, and pictures on the map.
    for library, n_users in {"nlopt": 1, "casadi": 1, "pyvrp": 1, "rasterio": 2}.items():
        users = [
            path.relative_to(ROOT).as_posix()
            for folder in ("planning", "missions", "groundstation")
            for path in (ROOT / folder).rglob("*.py")
            if f"import {library}" in path.read_text("utf-8") or f"from {library}" in path.read_text("utf-8")
        ]
        assert len(users) == n_users, (library, users)


READS = re.compile(
    r"\.read_bytes\(|\.read_text\(|\.open\(\"r|(?<![\w.])(?<!def )open\(|tomllib\.loads?\(|json\.loads?\(|imdecode\(|"
    r"imread\(|ZipFile\((?!.*\"w\")|np\.load\(|np\.fromfile\(|sqlite3\.connect\(|load_mesh\(|ifcopenshell\.open\(|"
    r"torch\.load\(|safe_open\(|fromstring\(|ElementTree\.parse\(|QImage\(str|QPixmap\(str"
)

READERS = {
    # Where files of others are opened, and texts parsed within bounds.
    "planning/base/files.py", "planning/base/json_file.py", "planning/geo/mesh.py",
    # Behind that: what was read or looked at there is given to the library of its kind.
    "planning/site/importing/ifc_content.py", "reconstruction/records/ifc/extract.py", "missions/mission/safe_files.py",
    "reconstruction/exports/sog.py", "reconstruction/photos/decode.py",
    "reconstruction/metrics/lpips.py", "reconstruction/training/training_state.py",
    "reconstruction/objects/store.py", "reconstruction/splats/ply.py",
    # SQLite looks at its files itself, and texts of one cell are short.
    "reconstruction/records/database.py", "groundstation/services/map/tiles.py",
    "reconstruction/records/book.py", "reconstruction/records/csv.py",
    # Files of our own: in the package, or made by a process of ours a moment ago; the system's; texts of our own.
    "planning/geo/geoid.py", "planning/base/step_physical_file.py",
    "planning/site/importing/ifc_file.py", "reconstruction/records/ifc/importing.py",
    "reconstruction/colmap/pycolmap_run.py", "reconstruction/exports/web.py", "reconstruction/gpu/shaders.py",
    "reconstruction/panels/network/confidence.py",
    "reconstruction/panels/network/network.py", "reconstruction/photos/lens.py",
    "reconstruction/panels/network/random_pictures.py", "reconstruction/panels/network/pool.py",
    "reconstruction/scenes/runs/cluster_workers.py", "reconstruction/scenes/runs/run_record.py",
    "reconstruction/objects/organise.py", "groundstation/services/reconstruct/choices.py",
    "groundstation/gui/application/collect_messages.py", "groundstation/services/messages.py",
    "groundstation/services/fly/flying.py", "groundstation/cli/commands/tradeoff.py",
    "groundstation/services/project/sample.py", "groundstation/gui/window/help.py",
    "groundstation/services/mission/proof.py",
    # Shares nothing with the rest, so that it can be read alone.
    "planning/proof/reflight_verify.py",
}  # fmt: skip


@pytest.mark.lint
def test_files_of_others_are_opened_in_one_place():
    found = {
        path.relative_to(ROOT).as_posix()
        for folder in ("planning", "missions", "groundstation", "reconstruction")
        for path in (ROOT / folder).rglob("*.py")
        if READS.search(path.read_text("utf-8"))
    }
    assert found - READERS == set(), (
        "read them by planning.base.files: read_input_file, open_input_file or check_input_file"
    )
    assert READERS - found == set(), "these read nothing any more"


def qt_names(tree):
    """Names in a module that stand for something of PySide6: imported, or another name for such a thing."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "PySide6":
            names |= {alias.asname or alias.name for alias in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Attribute) and root_of(node.value) in names:
            names |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    return names


def root_of(node):
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


def identities_of_qt(source):
    """Lines that compare something with a member of a Qt enum by `is`."""
    tree = ast.parse(source)
    names = qt_names(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and any(isinstance(op, (ast.Is, ast.IsNot)) for op in node.ops):
            sides = (node.left, *node.comparators)
            if any(isinstance(side, ast.Attribute) and root_of(side) in names for side in sides):
                yield node.lineno


def calls_of(source, classes):
    """Lines that call a method of one of some classes, by the class."""
    for node in ast.walk(ast.parse(source)):
        called = node.func if isinstance(node, ast.Call) else None
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name) and called.value.id in classes:
            yield node.lineno


def test_the_check_for_identities_sees_them_in_every_dress():
    source = """
from PySide6.QtWidgets import QMessageBox as Box
buttons = Box.StandardButton
a = said is Box.StandardButton.Yes
b = buttons.Yes is not said
c = said == buttons.Yes
d = said is None
"""
    assert list(identities_of_qt(source)) == [4, 5]


@pytest.mark.lint
@pytest.mark.parametrize("folder", ["groundstation/gui", "tests/gui"])
def test_members_of_qt_enums_are_compared_by_value(folder):
    """Qt gives a number where an enum is expected, or a new member for flags: `is` is then false without a word."""
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line in identities_of_qt(path.read_text())
    ]
    assert found == [], "compare members of Qt enums with == and !="


@pytest.mark.lint
def test_dialogs_of_qt_are_asked_in_one_place():
    asking = {"QMessageBox", "QFileDialog", "QInputDialog"}
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in sorted((ROOT / "groundstation" / "gui").rglob("*.py"))
        if path.name != "questions.py" or path.parent.name != "widgets"
        for line in calls_of(path.read_text(), asking)
    ]
    assert found == [], "ask by the functions of groundstation.gui.widgets.questions: they give a bool or a path"


@pytest.mark.lint
def test_no_test_answers_in_place_of_a_dialog():
    """Dialogs are clicked (`tests.gui.driving.clicked`); a test that answers for one says nothing about it."""
    words = re.compile(
        r"""setattr\(\s*[\w.]*(QMessageBox|QFileDialog|QInputDialog|QDialog|Dialog|questions)\b"""
        r"""|\.(questions|asks|_questions)(\.\w+)? = """
        r"""|class \w+\((\w*Questions|QMessageBox|QFileDialog)\)"""
    )
    found = [
        f"{path.relative_to(ROOT)}: {match.group(0)}"
        for path in sorted((ROOT / "tests").rglob("*.py"))
        for match in words.finditer(path.read_text())
    ]
    assert found == []


SAID = {"Finding", "Assessment", "FlightEvent", "note", "append", "about", "glue"}
"""What shows its texts to users, beside errors and what is assigned to `text`, `message` and `reason`."""

WRONG_CALLS = {"ValueError", "TypeError", "RuntimeError", "AttributeError", "KeyError"}


def plain_sentences(source):
    """Lines with an f-string of several words that is shown to users; what has tags in it is a page."""
    tree = ast.parse(source)
    parents = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
    for node in ast.walk(tree):
        parts = getattr(node, "values", ()) if isinstance(node, ast.JoinedStr) else ()
        text = " ".join(part.value for part in parts if isinstance(part, ast.Constant))
        if len(re.findall("[a-z]{2,}", text)) < 3 or "<" in text:
            continue
        above = parents[node]
        while not isinstance(above, (ast.Call, ast.stmt)):
            above = parents[above]
        name = ast.unparse(above.func).split(".")[-1] if isinstance(above, ast.Call) else ""
        target = ast.unparse(above.targets[0]) if isinstance(above, ast.Assign) else ""
        if (
            name in SAID
            or (name.endswith("Error") and name not in WRONG_CALLS)
            or target in ("text", "message", "reason")
        ):
            yield node.lineno


@pytest.mark.lint
def test_sentences_for_users_are_messages_that_can_be_translated():
    sentences = 'x = 1\nraise InputError(f"there is no {x}; name one")\ntext = f"{x} is not one"'
    assert set(plain_sentences(sentences)) == {2, 3}
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for house in ("planning", "missions", "reconstruction", "groundstation")
        for path in sorted((ROOT / house).rglob("*.py"))
        if path.parent.name != "colmap"
        for line in plain_sentences(path.read_text())
    ]
    assert found == [], "make them by planning.base.messages.say: an f-string stays English"


@pytest.mark.slow
def test_tests_that_were_compiled_before_are_found_so_by_pytest(tmp_path):
    """In a fresh clone each of several test processes would compile all of them."""
    shutil.copy(ROOT / "tests" / "rewritten.py", tmp_path)
    (tmp_path / "test_one.py").write_text("def test_one():\n    assert len('ab') == 3\n")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    run = {"cwd": tmp_path, "env": environment, "capture_output": True, "text": True, "check": False}
    subprocess.run([sys.executable, "-m", "rewritten"], **run)
    (kept,) = tmp_path.rglob("test_one*pytest*.pyc")
    before = kept.stat().st_mtime_ns, kept.stat().st_ino
    said = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_one.py"], **run).stdout
    assert "where 2 = len('ab')" in said
    assert (kept.stat().st_mtime_ns, kept.stat().st_ino) == before
