"""The window does the main job: open, look, plan, stop, cancel, undo, save; and answers while it works."""

import os
import re
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtGui import QColor

from groundstation.gui.map.map_paint import sortie_colour
from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.tabs import TABS
from groundstation.gui.window import menus
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.project.steps import Step
from groundstation.services.settings import Language, Theme
from groundstation.services.units import UnitSystem
from planning.parameters import GreedyParameters
from planning.request import PlanRequest
from tests.gui.driving import (
    PATIENCE_S,
    TurnGaps,
    click_on,
    clicked,
    close_controller,
    press_in,
    trigger,
    turn_until,
    turn_until_idle,
)

GUI = Path(menus.__file__).parents[1]

QUICK = PlanRequest(
    n_views=8, greedy=GreedyParameters(n_candidates=400, improve=False, certify=False), time_budget_s=4.0
)
"""A plan that is there at once, where the window is what is tested."""


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    yield controller
    close_controller(controller)


def opened(application, controller, scene):
    controller.window.show_tab("site")
    controller.window.tab("site").left.opener.open_bundled(scene)
    turn_until_idle(application, controller)


def planned(application, controller, request):
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    page.controller.set_request(request)
    page.controller.plan()
    turn_until_idle(application, controller)
    return page


@pytest.mark.slow
def test_window_opens_a_site_plans_it_and_shows_both(application, controller):
    opened(application, controller, "roof")
    scene = controller.window.shared_view.scene()
    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    empty = scene.screenshot()
    page = planned(application, controller, PlanRequest(n_views=12, time_budget_s=1.0))
    assert "roof: panels 32" in controller.window.messages.texts()
    assert "Views: 12, sorties: 1" in controller.window.messages.texts()
    assert page.verdict().startswith("Ready to fly")
    page.right.setCurrentWidget(page.effects_area)
    turn_until_idle(application, controller)
    assert page.effects.card("occlusion").text().splitlines()[1] == "is off"
    scene.look_at_all()
    shown = scene.screenshot()
    assert (empty.std(axis=(0, 1)) > 5).all(), "the site is not drawn"
    # Below the view the slider that flies the plan has come, so that pictures differ anyway.
    orange = np.array(QColor(sortie_colour(1)).getRgb()[:3])
    n_orange = [np.count_nonzero(np.abs(picture - orange.astype(int)).max(axis=2) < 30) for picture in (empty, shown)]
    assert n_orange[0] < 20 < 200 < n_orange[1], "the plan is not drawn"


@pytest.mark.long
def test_every_tab_can_be_shown_and_fits_a_small_screen(application, controller):
    for name in controller.window.tab_names():
        controller.window.show_tab(name)
        application.processEvents()
        assert controller.window.shown_tab() == name
        size = controller.window.minimumSizeHint()
        assert size.width() <= 1280, name
        assert size.height() <= 720, name
    assert controller.window.tab_names() == ("start", *Step)


def click_tab(window, name):
    bar = window.tab_bar()
    click_on(window, bar, bar.tabRect(window.tab_names().index(name)).center())


def test_a_tab_that_is_not_made_yet_shows_its_title_at_once_and_is_made_in_many_turns(application, controller):
    window = controller.window
    window._make_soon.stop()
    assert not {"plan", "fly"} & set(window._tabs)
    click_tab(window, "plan")
    assert window._title_of_coming.isVisible()
    assert window._title_of_coming.text() == "Plan ..."
    assert window.shown_tab() == "start"
    turns_s = []
    while window.shown_tab() != "plan":
        began_s = time.thread_time()
        application.processEvents()
        turns_s.append(time.thread_time() - began_s)
    assert not window._title_of_coming.isVisible()
    assert window.tab("plan").left.isVisible()
    assert max(turns_s) < 0.5 * sum(turns_s), "no turn has most of the work"


def test_who_goes_back_before_a_tab_is_made_is_back_at_once(application, controller):
    window = controller.window
    window._make_soon.stop()
    click_tab(window, "fly")
    click_tab(window, "start")
    assert window.shown_tab() == "start"
    assert window.tab("start").left.isVisible()
    turn_until_idle(application, controller)
    assert window.shown_tab() == "start"
    click_tab(window, "fly")
    turn_until(application, lambda: window.shown_tab() == "fly")


@pytest.mark.slow
def test_cancel_throws_a_plan_away_and_enough_keeps_the_best_so_far(application, controller):
    opened(application, controller, "roof")
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    page.controller.set_request(PlanRequest(n_views=60, time_budget_s=60.0))
    page.controller.plan()
    turn_until(application, lambda: controller.context.jobs()[0].state.name == "RUNNING")
    controller.window.job_bar.cancel_running()
    turn_until_idle(application, controller)
    assert "Plan: cancelled" in controller.window.messages.texts()
    assert controller.context.document.plans == ()
    assert not page.controller.is_planning
    page.controller.plan()
    turn_until(application, lambda: "sections" in page.chart.text())
    assert "any flight could cover" in page.chart.text(), "the bound is known while the plan runs"
    started = time.perf_counter()
    page.controller.stop_here()
    turn_until_idle(application, controller)
    assert time.perf_counter() - started < 20.0
    assert len(controller.context.document.current.plan.viewpoints) >= 1


@pytest.mark.long
def test_the_time_of_a_job_goes_on_while_it_tells_nothing(application, controller):
    go_on = threading.Event()

    def work(context):
        context.report("thinking", 1, 2)
        go_on.wait(PATIENCE_S)

    controller.context.start("Think", work)
    bar = controller.window.job_bar
    times = []

    def look():
        shown = bar._left.text() if bar.isVisible() else ""
        if shown and shown not in times:
            times.append(shown)
        return len(times) >= 3

    turn_until(application, look)
    go_on.set()
    turn_until_idle(application, controller)
    assert all(text.endswith(" so far") for text in times), times
    assert times == sorted(times)


@pytest.mark.slow
def test_editing_by_hand_shows_at_once_and_can_be_undone(application, controller):
    opened(application, controller, "roof")
    page = planned(application, controller, QUICK)
    before = controller.context.document.current.plan
    viewpoint = before.viewpoints[3]
    controller.context.select(Item(ItemKind.VIEWPOINT, viewpoint.id))
    page.controller.set_viewpoint(replace(viewpoint, position_enu_m=(0.0, 0.0, 14.0)))
    assert page.verdict().startswith("NOT ready to fly"), "without a turn of the event loop"
    assert viewpoint.id in {f.place for f in page.controller.active.revision.findings if f.severity == "error"}
    said = controller.window.messages.texts()
    assert f"Move {viewpoint.id}: sections gained" in said
    assert "Error: smallest distance at a viewpoint" in said
    controller.context.session.undo()
    assert controller.context.document.current.plan is before
    assert page.verdict().startswith("Ready to fly")
    page.viewpoint.toggle_lock()
    locked = controller.context.document.current.viewpoint(viewpoint.id)
    assert locked.locked
    page.viewpoint.delete_viewpoint()
    assert "switch off “Keep in the next plan”" in controller.window.messages.texts()
    page.viewpoint.add_viewpoint()
    assert len(controller.context.document.current.plan.viewpoints) == 9
    again = planned(application, controller, replace(QUICK, n_views=6))
    assert locked in again.controller.active.plan.viewpoints


@pytest.mark.slow
def test_plans_are_compared_side_by_side(application, controller):
    opened(application, controller, "roof")
    planned(application, controller, QUICK)
    page = planned(application, controller, PlanRequest(method="noto", share=0.9, time_budget_s=1.0))
    page.lists.compare(tuple(entry.id for entry in controller.context.document.plans))
    turn_until_idle(application, controller)
    window = page.lists.compare_window
    table = window.table()
    assert table.columnCount() == 2
    assert table.item(0, 0).text().startswith("8")
    first, second = window.scenes()
    first.orbitChanged.emit(first.orbit().turned(30.0, 5.0))
    assert second.orbit() == first.orbit().turned(30.0, 5.0)
    window.close()


@pytest.mark.slow
def test_a_row_that_is_clicked_to_compare_does_not_become_the_plan_that_is_flown(application, controller):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    opened(application, controller, "roof")
    planned(application, controller, QUICK)
    page = planned(application, controller, replace(QUICK, n_views=6))
    first, second = (entry.id for entry in controller.context.document.plans)
    plans = page.lists.plans
    page.lists.setCurrentWidget(plans)
    turn_until_idle(application, controller)
    table = plans._view

    def click(row, modifier=Qt.KeyboardModifier.NoModifier, click=QTest.mouseClick):
        place = table.visualRect(table.model().index(row, 1)).center()
        click(table.viewport(), Qt.MouseButton.LeftButton, modifier, place)

    assert controller.context.document.current_plan_id == second
    click(0)
    assert plans.selected() == (first,)
    assert controller.context.document.current_plan_id == second, "a click selects"
    click(1, Qt.KeyboardModifier.ControlModifier)
    assert plans.selected() == (first, second)
    assert controller.context.document.current_plan_id == second
    click(0)
    press_in(controller.window, "Make current")
    assert controller.context.document.current_plan_id == first
    click(1)
    click(1, click=QTest.mouseDClick)
    assert controller.context.document.current_plan_id == second


@pytest.mark.slow
def test_theme_units_and_language_change_at_once_and_are_kept(application, controller):
    from groundstation.services.settings import read_settings, settings_path

    opened(application, controller, "roof")
    light = controller.window.grab().toImage().pixelColor(5, 5).lightness()
    controller.choose(theme=Theme.DARK)
    application.processEvents()
    assert controller.window.grab().toImage().pixelColor(5, 5).lightness() < light / 2
    controller.window.show_tab("plan")
    controller.choose(units=UnitSystem.IMPERIAL)
    assert controller.window.tab("plan").form.box("constraints.min_distance_m").box().text() == "32.8 ft"
    turn_until_idle(application, controller)
    controller.choose(language=Language.GERMAN)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    assert controller.window.shown_tab() == "plan"
    titles = [spec.shown_title() for spec in TABS]
    assert "Planung" in titles
    assert "roof" in controller.window.messages.texts(), "what was said before is still there"
    turn_until_idle(application, controller)
    controller.choose(language=Language.ENGLISH, theme=Theme.LIGHT, units=UnitSystem.METRIC)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    kept = read_settings(settings_path())
    assert (kept.theme, kept.units, kept.language) == (Theme.LIGHT, UnitSystem.METRIC, Language.ENGLISH)


TOKENS = {
    **dict.fromkeys(("Left", "Right", "Up", "Down"), "Arrows"),
    **dict.fromkeys(("Return", "Enter"), "Enter"),
    **{"Plus": "+", "Minus": "-", "Equal": "=", "PageUp": "PgUp", "PageDown": "PgDown", "Escape": "Esc"},
    **{"Delete": "Del", "Insert": "Ins"},
}
"""What keys are called in the list of all, where it is not Qt's own name."""


SECTIONS = {
    "view3d/navigator.py": ("3-D view",),
    "view3d/scene_view.py": ("3-D view", "Tools in the 3-D view"),
    "map/viewport.py": ("Map",),
    "camera_preview/preview.py": ("Camera preview",),
    "camera_preview/photo_box.py": ("Camera preview",),
    "site/site_tree.py": ("Tree of the site",),
    "fly/live_pictures.py": ("Photo strip of a flight",),
    "widgets/hold_button.py": ("Start, Return and Land",),
    "photos/grid_picture.py": ("Photos",),
    "photos/grid_view.py": ("Photos",),
    "reconstruct/model_view.py": ("Models",),
    "window/main_window.py": ("Buttons",),
    "window/message_area.py": ("Messages",),
    "window/help.py": ("Tour",),
}
"""Sections of the list of keys that tell of the keys that a module takes by itself."""


def keys_in(module):
    """Names of the keys that a module of the window handles by itself."""
    return set(re.findall(r"Qt\.Key\.Key_(\w+)", (GUI / module).read_text()))


@pytest.mark.slow
def test_every_key_of_a_menu_tab_or_shortcut_is_in_the_list_and_none_twice(application, controller):
    from PySide6.QtGui import QAction, QKeySequence, QShortcut

    from groundstation.gui.window.menus import ShortcutsDialog, sections, view_keys

    for page in SharedViewPage:
        controller.window.shared_view.show_page(page)
    told = dict(sections(controller.window))
    dialog = ShortcutsDialog(controller.window)
    of_views = dict(view_keys())
    listed = [keys for title, rows in told.items() if title not in of_views for keys, _ in rows]
    assert len(listed) == len(set(listed))
    assert all(words for rows in told.values() for _, words in rows)
    everything = {key for rows in told.values() for keys, _ in rows for key in (keys, *keys.split(", "))}
    actions = [
        *controller.window.findChildren(QAction),
        *(a for n in controller.window.tab_names() for a in controller.window.tab(n).actions()),
    ]
    native = QKeySequence.SequenceFormat.NativeText
    keys = {key.toString(native) for action in actions for key in action.shortcuts()}
    keys |= {shortcut.key().toString(native) for shortcut in controller.window.findChildren(QShortcut)}
    assert len(keys) > 40
    assert keys - {""} <= everything
    assert {"Ctrl+S", "Ctrl+Z", "Ctrl+P", "F1", "Ctrl+1", "Ctrl+Shift+L"} <= set(listed)
    assert all(key in dialog.text() for key in keys)


def test_every_key_that_a_view_takes_by_itself_is_in_the_list(application):
    from groundstation.gui.window.menus import view_keys

    taking = {
        path.relative_to(GUI).as_posix()
        for path in GUI.rglob("*.py")
        if "Qt.Key.Key_" in path.read_text()
        and path.name != "screenshots.py"
        # Boxes take no key: they hear which may be a shortcut.
        and path.name != "inputs.py"
    }
    assert taking == set(SECTIONS)
    told = dict(view_keys())
    assert set(told) == {title for titles in SECTIONS.values() for title in titles}
    for module, titles in SECTIONS.items():
        words = " ".join(keys for title in titles for keys, _ in told[title])
        missing = {key for key in keys_in(module) if TOKENS.get(key, key) not in words}
        assert not missing, module


@pytest.mark.slow
def test_the_list_of_keys_is_shown_and_scrolls(application, controller):
    with clicked("OK") as shown:
        trigger(controller.window, "Shortcuts")
    assert shown[0].startswith("Shortcuts")


@pytest.mark.alone
def test_the_window_answers_within_50_ms_while_a_plan_runs(application, controller):
    """What a job's thread does now and then, such as loading a module, counts; so the best of a few plans is taken."""
    opened(application, controller, "office")
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    turn_until_idle(application, controller)
    gaps, longest_ms = TurnGaps(), []
    for seed in range(6):
        page.controller.set_request(PlanRequest(n_views=560, time_budget_s=4.0, seed=seed))
        gaps.start()
        page.controller.plan()
        turn_until(application, lambda: not page.controller.is_planning)
        longest_ms.append(gaps.longest_ms())
        turn_until_idle(application, controller)
        if longest_ms[-1] < 50.0:
            return
    pytest.fail(f"longest gaps of {len(longest_ms)} plans: {longest_ms} ms")


@pytest.mark.slow
@pytest.mark.alone
def test_the_window_answers_within_50_ms_while_a_plan_is_checked_and_proved(application, controller):
    """The best of a few, as above."""
    opened(application, controller, "roof")
    planned(application, controller, PlanRequest(n_views=24, time_budget_s=2.0))
    controller.window.show_tab("mission")
    page = controller.window.tab("mission")
    turn_until_idle(application, controller)
    gaps, longest_ms = TurnGaps(), []
    for _ in range(4):
        gaps.start()
        page.controller.check_and_prove()
        turn_until(application, lambda: not page.controller.is_proving)
        longest_ms.append(gaps.longest_ms())
        turn_until_idle(application, controller)
        assert page.findings.proof_text().startswith("Proved by an independent check")
        if longest_ms[-1] < 50.0:
            return
    pytest.fail(f"longest gaps of {len(longest_ms)} checks: {longest_ms} ms")


@pytest.mark.slow
def test_the_language_waits_while_something_runs(application, controller):
    opened(application, controller, "roof")
    controller.window.show_tab("plan")
    page, window = controller.window.tab("plan"), controller.window
    page.controller.set_request(replace(QUICK, n_views=6))
    page.controller.plan()
    controller.choose(language=Language.GERMAN)
    assert controller.window is window
    assert "started next" in controller.window.messages.texts()
    controller.choose(theme=Theme.DARK)
    assert TABS[1].shown_title() == "Site", "no text of the window is in another language than the rest"
    controller.choose(theme=Theme.LIGHT)
    turn_until_idle(application, controller)
    assert len(controller.context.document.plans) == 1
    controller.choose(language=Language.ENGLISH)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)


@pytest.mark.slow
def test_the_language_can_be_chosen_before_the_first_tab_is_there(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    first = controller.window
    assert first.shown_tab() == ""
    controller.choose(language=Language.GERMAN)
    controller.choose(language=Language.ENGLISH)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    assert controller.window is not first
    assert controller.window.shown_tab() == "start"
    close_controller(controller)


@pytest.mark.slow
def test_a_window_that_was_replaced_fills_no_menu_any_more(application, controller, monkeypatch):
    old = controller.window
    filled = []
    with monkeypatch.context() as patch:
        patch.setattr(old, "tab", filled.append)
        old.retire()
        old._bar.setCurrentIndex(3)
    assert filled == []


@pytest.mark.parametrize("is_left_alone", [True, False])
def test_modules_that_are_half_imported_are_asked_for_nothing(tmp_path, is_left_alone):
    """As pydantic's, which come with Open3D: asked while they are imported, they fail."""
    (tmp_path / "half_imported.py").write_text("def __getattr__(name):\n    raise ImportError(f'asked for {name}')\n")
    lines = (
        "import sys",
        f"sys.path.insert(0, {str(tmp_path)!r})",
        "from groundstation.gui.application import interpreter",
    )
    code = "\n".join((*lines, "interpreter.leave_modules_alone()" * is_left_alone, "import half_imported"))
    made = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (made.returncode == 0) is is_left_alone, made.stderr


@pytest.mark.long
def test_no_type_of_qt_is_left_to_be_made_when_there_are_other_threads(application, tmp_path):
    """Two threads that have types made at once end the process, which most tries of them alone show."""
    script = """
import sys, threading
from PySide6.QtWidgets import QApplication
from groundstation.gui.window.project_controller import ProjectController

def left():
    modules = [module for name, module in sys.modules.items() if name.startswith("PySide6.Qt")]
    return sum(len(set(dir(module)) - set(vars(module))) for module in modules)

def note_and_start(thread):
    begun.append((thread.name, left()))
    start(thread)

application, begun, start = QApplication(["reflight"]), [], threading.Thread.start
print(left())
threading.Thread.start = note_and_start
controller = ProjectController(application)
controller.show()
while controller.window.shown_tab() != "start":
    application.processEvents()
assert ("import", 0) in begun, begun
assert all(n == 0 for _, n in begun), begun
threads = [threading.Thread(target=lambda: [getattr(module, name) for module in modules for name in dir(module)])
    for modules in [[sys.modules["PySide6.QtWidgets"], sys.modules["PySide6.QtGui"]]] * 2]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print("alive", flush=True)
import os; os._exit(0)
"""
    own = {"REFLIGHT_CONFIG_DIR": str(tmp_path), "PYTHONFAULTHANDLER": "1"}
    made = subprocess.run(
        [sys.executable, "-c", script], env={**os.environ, **own}, capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert made.returncode == 0, made.stderr[-3000:]
    n_left, alive = made.stdout.split()
    assert (int(n_left) > 100, alive) == (True, "alive"), "types are made when they are asked for, and by one thread"


def test_a_tab_that_is_only_begun_is_whole_for_whom_wants_it(application, controller):
    window = controller.window
    begun = window._begun(next(spec for spec in TABS if spec.name == "reconstruct"))
    assert not hasattr(begun, "left")
    window.show_tab("reconstruct")
    assert window.tab("reconstruct") is begun
    assert begun.left.isVisible()
    assert not begun.go_on()
