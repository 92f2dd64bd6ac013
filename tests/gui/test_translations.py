"""The German window: nothing is left in English, forgotten or out of date."""

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PySide6.QtCore import QTranslator
from PySide6.QtWidgets import QMenu, QWidget

from groundstation.gui.application.translate import FOLDER
from groundstation.gui.map.map_view import MapView
from groundstation.gui.tabs import TABS
from groundstation.services.settings import Language
from tests.gui.driving import close_controller, turn_until

GUI = FOLDER.parent
ROOT = GUI.parent.parent
SOURCES = sorted(GUI.rglob("*.py"))
GERMAN = FOLDER / "reflight_de.ts"

SHOWS_TEXT = {
    *("QAction", "QCheckBox", "QGroupBox", "QLabel", "QPushButton", "QRadioButton"),
    *("addAction", "addItem", "addMenu", "addRow", "addTab", "setPlaceholderText", "setStatusTip", "setText"),
    *("setTitle", "setToolTip", "setWindowTitle"),
}
"""Calls whose text stands in the window."""

NAMES = {"ArduPilot", "PX4", "EPSG:25832", "[*] - Reflight"}
"""Shown as they are in every language."""


def messages(path):
    """(context, source, comment) of all texts in a file of translations, with what stands for them."""
    found = {}
    for context in ElementTree.parse(path).getroot().iter("context"):
        for message in context.iter("message"):
            key = (context.findtext("name"), message.findtext("source"), message.findtext("comment") or "")
            found[key] = message.find("translation")
    return found


@pytest.fixture(scope="module")
def german():
    return messages(GERMAN)


def name_of(call):
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def calls(path):
    return [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Call)]


def test_every_text_has_a_finished_translation(german):
    open_ones = [key for key, translation in german.items() if translation.get("type") or not translation.text]
    assert len(german) > 500
    assert not open_ones


@pytest.mark.lint
def test_the_file_holds_the_texts_of_the_sources_and_no_others(german, tmp_path):
    lupdate = shutil.which("pyside6-lupdate", path=Path(sys.executable).parent)
    if lupdate is None:
        pytest.skip("pyside6-lupdate is not installed beside the interpreter")
    fresh = tmp_path / GERMAN.name
    collected = tmp_path / "messages.py"
    code = "groundstation.gui.application.collect_messages"
    subprocess.run([sys.executable, "-m", code, str(collected)], cwd=ROOT, check=True)
    sources = [*(str(path.relative_to(ROOT)) for path in SOURCES), str(collected)]
    run = subprocess.run(
        [lupdate, *sources, "-locations", "none", "-target-language", "de_DE", "-ts", str(fresh)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        pytest.skip(f"lupdate does not run here: {run.stderr.strip()}")
    assert set(messages(fresh)) - set(german) == set(), "run `make translations` and translate what is new"
    assert set(german) - set(messages(fresh)) == set(), "run `make translations`"


def test_the_compiled_file_answers_what_the_translations_say(application, german):
    translator = QTranslator()
    assert translator.load(str(GERMAN.with_suffix(".qm")))
    differing = {
        key: translator.translate(*key)
        for key, translation in german.items()
        if translator.translate(*key) != translation.text
    }
    assert not differing, "run `make translations`"


def test_placeholders_and_mnemonics_survive_translation(german):
    for (context, source, _), translation in german.items():
        for pattern in (r"\{[^}]*\}", r"&(?=\w)"):
            there, here = re.findall(pattern, source), re.findall(pattern, translation.text)
            assert sorted(set(there)) == sorted(set(here)), f"{context}: {source!r} is {translation.text!r}"
            assert len(there) == len(here) or pattern.startswith(r"\{"), f"{context}: {source!r}"


def test_ends_of_texts_survive_translation(german):
    """Full stops, colons and ellipses say what a button does and whether a sentence goes on."""
    for (context, source, _), translation in german.items():
        ends = [re.search(r"( ?\.\.\.|[.:?;]|)$", text).group() for text in (source, translation.text)]
        assert ends[0] == ends[1], f"{context}: {source!r} is {translation.text!r}"
        assert re.findall(r"^\s*|\s*$", source) == re.findall(r"^\s*|\s*$", translation.text), f"{context}: {source!r}"


@pytest.mark.lint
@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(GUI)))
def test_texts_are_literals_that_qt_linguist_finds(path, german):
    known = {source for _, source, _ in german}
    for call in calls(path):
        if name_of(call) == "tr":
            text = call.args[0]
            assert isinstance(text, ast.Constant), f"line {call.lineno}: a text to translate must be a literal"
            assert text.value in known, f"line {call.lineno}: Qt Linguist does not find {text.value!r}"


@pytest.mark.lint
@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(GUI)))
def test_no_widget_gets_a_text_that_is_not_translated(path):
    for call in calls(path):
        if name_of(call) not in SHOWS_TEXT:
            continue
        for argument in call.args:
            parts = argument.values if isinstance(argument, ast.JoinedStr) else [argument]
            for part in parts:
                shown = part.value if isinstance(part, ast.Constant) and isinstance(part.value, str) else ""
                is_word = re.search(r"[^\W\d_]{2}", re.sub(r"<[^>]*>|&\w+;", "", shown))
                assert shown in NAMES or not is_word, f"line {call.lineno}: {shown!r} goes through tr()"


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)

    def speak(language):
        controller.choose(language=language)
        turn_until(application, lambda: controller.window.shared_view.scene() is not None)

    speak(Language.GERMAN)
    yield controller
    speak(Language.ENGLISH)
    close_controller(controller)


@pytest.mark.lint
def test_what_went_wrong_is_passed_on_with_its_parts():
    """A signal of `str` passes on a plain text, which nobody translates."""
    made = re.compile(r"^    (\w*(?:[Ff]ailed|[Rr]efused)\w*) = Signal\(.*\bstr\b", re.MULTILINE)
    assert [(path.name, name) for path in SOURCES for name in made.findall(path.read_text("utf-8"))] == []


def test_an_overlay_that_cannot_be_read_is_told_in_german(application, controller, tmp_path):
    view = MapView()
    told = []
    view.refused.connect(told.append)
    bad = tmp_path / "bad.geojson"
    bad.write_text("nonsense")
    view.add_overlay(bad)
    turn_until(application, lambda: told)
    assert "bad.geojson: kein gültiges JSON" in told[0]


def test_the_window_speaks_german_once_it_is_chosen(controller):
    titles = [action.text().replace("&", "") for action in controller.window.menuBar().actions()]
    assert {"Projekt", "Bearbeiten", "Ansicht", "Hilfe"} <= set(titles)
    assert [spec.shown_title() for spec in TABS] == [
        *("Start", "Standort", "Planung", "Mission", "Fliegen", "Fotos", "Rekonstruktion", "Modell")
    ]


@pytest.mark.long
def test_no_two_german_entries_of_a_menu_share_a_letter(controller):
    bar = controller.window.menuBar()
    for name in controller.window.tab_names():
        controller.window.show_tab(name)
        menus = [bar, *(action.menu() for action in bar.actions() if isinstance(action.menu(), QMenu))]
        for menu in menus:
            letters = [found for action in menu.actions() for found in re.findall(r"&(\w)", action.text().lower())]
            assert len(letters) == len(set(letters)), [action.text() for action in menu.actions()]


@pytest.mark.long
def test_keys_have_german_names_wherever_they_are_shown(controller):
    from groundstation.gui.window.menus import sections

    controller.choose(language=Language.GERMAN)
    told = " ".join(keys for _, rows in sections(controller.window) for keys, _ in rows)
    for english in ("Ctrl", "Shift", "Return", "Enter", "Home", "Space", "PgUp", "Page", "Backspace", "Startplatz"):
        assert english not in told
    for key in ("Strg+Umschalt+Eingabe", "Pos1", "Leertaste", "Entf"):
        assert key in told
    tips = [button.toolTip() for button in controller.window.findChildren(QWidget) if "Ctrl+" in button.toolTip()]
    assert tips == []
