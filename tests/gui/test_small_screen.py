"""Everything can be reached on a laptop of 1280 x 720 pixels with text of 160 %, in both languages.

In each tab, phase and dialog, whatever can be pressed or filled in lies on the screen, whole, or in something that
scrolls to it; and buttons are wide enough for their words.
"""

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractScrollArea,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QTabBar,
    QTabWidget,
    QToolButton,
    QWidget,
)

from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.scrolling import FittedLine, ShortText
from groundstation.services.fly.events import Request, ViewState
from groundstation.services.fly.options import ConnectionChoice, LinkKind
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.settings import Language
from planning.base.findings import Severity
from tests.gui.driving import clicked, close_controller, escape, turn_until, turn_until_idle
from tests.services.live_cases import planned

SCREEN = QRect(0, 0, 1280, 720)

LEAST_PX = 40
"""Of something that scrolls, to be of use."""

LEAST_LETTERS = 5
"""Of a choice that is cut, to be told from others."""

DIRECT = Qt.FindChildOption.FindDirectChildrenOnly

CONTROLS = (QAbstractButton, QComboBox, QAbstractSpinBox, QLineEdit)


def controls(window):
    """What can be pressed or filled in now."""
    for widget in window.findChildren(QWidget):
        is_inside = isinstance(widget.parentWidget(), (QAbstractSpinBox, QComboBox, QTabBar))
        is_own = not is_inside and not widget.objectName().startswith("qt_")
        if isinstance(widget, CONTROLS) and widget.isVisible() and widget.window() is window and is_own:
            yield widget


def text_of(widget):
    kind = next((kind for kind in (QAbstractButton, QLineEdit, QLabel) if isinstance(widget, kind)), None)
    return widget.accessibleName() if kind is None else kind.text(widget)


def name_of(widget):
    text = text_of(widget)
    return f"{type(widget).__name__} “{text}” in {type(widget.parentWidget()).__name__}"


def room_of(widget):
    # Unbound: a widget may have something of its own under the name `size`.
    return QRect(QWidget.mapToGlobal(widget, QPoint(0, 0)), QWidget.size(widget))


def area_around(widget):
    """The nearest area that scrolls to a widget."""
    above = widget.parentWidget()
    while above is not None and not above.isWindow():
        if isinstance(above, QScrollArea) and QScrollArea.widget(above).isAncestorOf(widget):
            return above
        above = above.parentWidget()
    return None


def out_of_reach(window):
    """Controls of a window that a user cannot get at, with why."""
    found = []
    for widget in controls(window):
        target, why = widget, ""
        while (area := area_around(target)) is not None and not why:
            inside = QScrollArea.widget(area)
            if not grown(inside.rect()).contains(QRect(target.mapTo(inside, QPoint(0, 0)), room_of(target).size())):
                why = "outside of what scrolls"
            view = QAbstractScrollArea.viewport(area)
            if min(view.width(), view.height()) < LEAST_PX:
                why = f"in an area that shows {view.width()} x {view.height()} pixels"
            target = area
        above = target.parentWidget()
        while above is not None and not target.isWindow() and not why:
            if not grown(room_of(above)).contains(room_of(target)):
                why = f"{room_of(target).getRect()} sticks out of {type(above).__name__} {room_of(above).getRect()}"
            if above.isWindow():
                break
            above = above.parentWidget()
        if not why and not grown(SCREEN).contains(room_of(target)):
            why = f"off the screen: {room_of(target).getRect()}"
        if why:
            found.append(f"{name_of(widget)}: {why}")
    return found


def grown(rectangle):
    return rectangle.adjusted(-1, -1, 1, 1)


def cut_short(window):
    """Buttons that are too narrow for their words."""
    found = []
    for button in controls(window):
        style = button.toolButtonStyle() if isinstance(button, QToolButton) else None
        # Those that show a sign alone say the word by their tool tip.
        is_sign = style == Qt.ToolButtonStyle.ToolButtonIconOnly and not button.icon().isNull() and button.toolTip()
        if isinstance(button, (QPushButton, QToolButton)) and text_of(button) and not is_sign:
            lines = text_of(button).replace("&", "").splitlines()
            needed = max(button.fontMetrics().horizontalAdvance(line) for line in lines)
            if needed > button.width():
                found.append(f"{name_of(button)}: {needed} > {button.width()}")
    return found


def cut_choices(window):
    """Lists to choose from whose choice is cut though the row has more room, or cut without saying all of it."""
    found = []
    for box in controls(window):
        if isinstance(box, ChoiceBox) and box.is_cut():
            form = box.parentWidget().layout()
            is_form = isinstance(form, QFormLayout) and form.indexOf(box) >= 0
            room = form.contentsRect().width() if is_form else 0
            if is_form and box.width() < room - 2:
                found.append(f"{name_of(box)}: “{box.shown_text()}” of “{box.currentText()}”, {box.width()} of {room}")
            if len(box.shown_text()) < LEAST_LETTERS or box.currentText() not in box.help_text():
                found.append(f"{name_of(box)}: “{box.shown_text()}” of “{box.currentText()}”")
    return found


def squeezed(window):
    """Boxes that are lower than their text needs."""
    return [
        f"{name_of(box)} is {QWidget.height(box)} px high, its text {box.fontMetrics().height()}"
        for box in controls(window)
        if isinstance(box, (QComboBox, QAbstractSpinBox)) and QWidget.height(box) < box.fontMetrics().height() + 2
    ]


def sideways(window):
    """Columns of forms that have more to the side than they show, each with what needs the width."""
    found = []
    for area in window.findChildren(QScrollArea):
        view, inside = QAbstractScrollArea.viewport(area), QScrollArea.widget(area)
        if area.isVisible() and inside is not None and inside.width() > view.width():
            found.append(f"{type(inside).__name__} {inside.width()} > {view.width()}: {why_wide(inside)}")
    return found


def why_wide(widget):
    """The way down to what makes a widget wide."""
    parts = [part for part in widget.findChildren(QWidget, options=DIRECT) if part.isVisible()]
    way = f"{type(widget).__name__} “{text_of(widget)}” {least_px(widget)}"
    return f"{way} > {why_wide(max(parts, key=least_px))}" if parts and not isinstance(widget, CONTROLS) else way


def least_px(widget):
    return max(widget.minimumSizeHint().width(), widget.minimumWidth())


def cut_labels(window):
    """Lines of text that are wider than their place and neither break, shrink nor end in dots."""
    found = []
    for label in window.findChildren(QLabel):
        is_line = label.isVisible() and label.window() is window and not label.wordWrap() and not label.isWindow()
        lines = "" if isinstance(label, (FittedLine, ShortText)) else label.text().replace("&", "")
        if is_line and not Qt.mightBeRichText(lines):
            needed = max((label.fontMetrics().horizontalAdvance(line) for line in lines.splitlines()), default=0)
            if needed > label.contentsRect().width() + 1:
                found.append(f"{name_of(label)}: {needed} > {label.contentsRect().width()}")
    return found


def cut_words(window):
    """Texts of several lines that are lower than their lines."""
    return [
        f"{name_of(label)} of {label.height()} px needs {label.heightForWidth(label.width())} at {label.width()}"
        for label in window.findChildren(QLabel)
        if label.isVisible() and label.window() is window and label.wordWrap() and label.text()
        if label.heightForWidth(label.width()) > label.height() + 1
    ]


def cut_lines(window):
    """Lines to type into that show less than what stands in them."""
    return [
        f"{name_of(line)}: {line.fontMetrics().horizontalAdvance(line.text())} > {line.width()}"
        for line in controls(window)
        if isinstance(line, QLineEdit) and line.fontMetrics().horizontalAdvance(line.text()) > line.width() - 8
    ]


def hidden_titles(window):
    """Rows of tabs in which the title of the one that is shown is not seen whole."""
    found = []
    for bar in window.findChildren(QTabBar):
        if not bar.isVisible() or bar.window() is not window or bar.currentIndex() < 0:
            continue
        arrows = [each for each in bar.findChildren(QToolButton, options=DIRECT) if each.isVisible()]
        end = min([bar.width(), *(each.x() for each in arrows)])
        room = bar.tabRect(bar.currentIndex())
        if room.left() < -1 or room.right() > end + 1:
            title = bar.tabText(bar.currentIndex())
            found.append(f"the title “{title}” at {room.left()} to {room.right()} of {end}")
    return found


class ViewPictures:
    """Looks at the window in each state."""

    def __init__(self, application, controller):
        self.application, self.controller, self.found = application, controller, {}

    def at(self, state, window=None):
        window = self.controller.window if window is None else window
        of_words = cut_short, cut_choices, cut_labels, cut_words, cut_lines, hidden_titles
        checks = (out_of_reach, squeezed, sideways, *of_words)
        problems = ["not looked yet"]
        # Layouts of areas within areas take some turns, and a busy machine comes to them late.
        for _ in range(3):
            turn_until_idle(self.application, self.controller)
            problems = problems and [problem for check in checks for problem in check(window)]
        if window.width() > SCREEN.width() or window.height() > SCREEN.height():
            problems.append(f"the window is {window.width()} x {window.height()}")
        if problems:
            self.found[state] = problems

    def told(self):
        """What was found, one problem a line, each where it was seen first."""
        first = {problem: state for state, problems in reversed(self.found.items()) for problem in problems}
        return "\n".join(f"{state}: {problem}" for problem, state in first.items())

    def dialog(self, state, open_it):
        """Look at a dialog that an action brings up, and leave it."""

        def step(dialog):
            self.at(state, dialog)
            escape(dialog)

        with clicked(step):
            open_it()


@pytest.fixture(
    params=[
        (Language.GERMAN, 1.6),
        pytest.param((Language.ENGLISH, 1.6), marks=pytest.mark.slow),
        pytest.param((Language.GERMAN, 1.0), marks=pytest.mark.slow),
        pytest.param((Language.ENGLISH, 1.3), marks=pytest.mark.slow),
    ],
    ids=lambda param: f"{param[0]}-{param[1]}",
)
def looks(application, worker, tmp_path, monkeypatch, request):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    from groundstation.gui.window.project_controller import ProjectController

    language, scale = request.param
    controller = ProjectController(application, worker=worker)
    controller.show()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.choose(language=language, text_scale=scale)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.window.setGeometry(SCREEN)
    yield ViewPictures(application, controller)
    # What follows is in English and of usual size, in a window that is there no longer.
    controller.choose(language=Language.ENGLISH, text_scale=1.0)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    close_controller(controller)


@pytest.mark.slow
def test_everything_can_be_reached_in_every_tab_phase_and_dialog(looks):
    controller, window = looks.controller, looks.controller.window
    controller.context.say(Severity.WARNING, "a warning of many words " * 15, about="plan.long")
    looks.at("nothing open")
    window.shared_view.show_page(SharedViewPage.MAP)
    looks.at("nothing open, map")
    model, plan = planned()
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    for page in SharedViewPage:
        window.shared_view.show_page(page)
        for item in (None, *(Item(kind, name) for kind, name in THINGS)):
            controller.context.select(item)
            looks.at(f"site, {page.name}, {item}")
        controller.context.select(Item(ItemKind.VIEWPOINT, plan.viewpoints[0].id))
        window.show_tab("plan")
        looks.at(f"plan, {page.name}")
        window.show_tab("site")
    window.shared_view.show_page(SharedViewPage.SCENE)
    _in_the_plan_tab(looks, window.tab("plan"), window)
    _in_the_mission_tab(looks, window)
    _in_the_fly_tab(looks, window)
    for name in ("photos", "reconstruct", "model"):
        window.show_tab(name)
        looks.at(name)
    window.messages._all.click()
    looks.at("messages")
    window.messages._all.click()
    looks.dialog("shortcuts", controller.menus.show_shortcuts)
    looks.dialog("about", controller.menus._show_about)
    looks.dialog("save as", controller.save_as)
    assert not looks.found, looks.told()


THINGS = ((ItemKind.BUILDING, ""), (ItemKind.HOME, ""), (ItemKind.AIRSPACE, ""), (ItemKind.FACADE, "A"))


def _in_the_plan_tab(looks, page, window):
    window.show_tab("plan")
    for number in range(page.right.count()):
        page.right.setCurrentIndex(number)
        looks.at(f"plan, right {number}")
    for number in range(page.lists.count()):
        page.lists.setCurrentIndex(number)
        looks.at(f"plan, list {number}")
    page.form._more.click()
    looks.at("plan, more settings")
    page.form._more.click()
    page.lists.setCurrentIndex(0)


def _in_the_mission_tab(looks, window):
    from groundstation.gui.mission.brief_printer import BriefDialog

    window.show_tab("mission")
    page = window.tab("mission")
    for number in range(page.lists.count()):
        page.lists.setCurrentIndex(number)
        looks.at(f"mission, list {number}")
    page.lists.setCurrentIndex(0)
    dialog = page.export()
    turn_until(looks.application, lambda: dialog.prepared() is not None)
    looks.at("export", dialog)
    dialog.reject()
    page.print_brief()
    dialog = window.findChildren(BriefDialog)[-1]
    turn_until(looks.application, dialog.is_ready)
    looks.at("brief", dialog)
    dialog.reject()


def _in_the_fly_tab(looks, window):
    window.show_tab("fly")
    page = window.tab("fly")
    looks.at("fly, not connected")
    for number in range(page.right.count()):
        page.right.setCurrentIndex(number)
        looks.at(f"fly, right {number}")
    page.right.setCurrentIndex(0)
    for kind in LinkKind:
        page.connection.kind.setCurrentIndex(page.connection.kind.findData(kind))
        looks.at(f"fly, {kind.name}")
    page.controller.set_choice(ConnectionChoice(speed_up=20.0))
    page.connection.setValue(page.controller.choice)
    page.connection.button.click()
    turn_until(looks.application, lambda: page.buttons.button(Request.UPLOAD).isEnabled())
    looks.at("fly, connected")
    page.buttons.button(Request.UPLOAD).click()
    turn_until(looks.application, lambda: page.buttons.button(Request.START).isEnabled())
    looks.at("fly, ready")
    looks.dialog("fly, start", page.buttons.button(Request.START).click)
    page.strip.set_states(tuple((f"v{n:04d}", ViewState.TO_COME) for n in range(700)))
    page.band.show_lost(7.0)
    looks.at("fly, link lost")
    page.band.hide()
    for number in range(page._lists.count()):
        page._lists.setCurrentIndex(number)
        looks.at(f"fly, list {number}")
    page.connection.button.click()
    turn_until(looks.application, lambda: not page.controller.is_connected)


@pytest.mark.slow
def test_the_import_dialog_can_be_reached(looks, tmp_path):
    import trimesh

    path = tmp_path / "tower.obj"
    trimesh.creation.box((20.0, 10.0, 30.0)).export(path)
    dialog = looks.controller.window.tab("site").left.opener.import_site(path)
    turn_until(looks.application, lambda: not dialog.is_busy())
    looks.at("import", dialog)
    QApplication.processEvents()
    dialog.reject()
    assert not looks.found, looks.told()


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("scale", [1.0, 1.6])
def test_tabs_that_have_no_room_are_reached_by_arrows_that_can_be_seen(application, scale):
    from groundstation.gui.widgets.theme import apply_theme
    from groundstation.services.settings import Theme

    apply_theme(application, Theme.LIGHT, scale)
    tabs = QTabWidget()
    for name in ("Viewpoints", "Not covered", "Clearance", "Plans"):
        tabs.addTab(QWidget(), name)
    tabs.resize(220, 120)
    tabs.show()
    application.processEvents()
    arrows = [arrow for arrow in tabs.tabBar().findChildren(QToolButton) if arrow.isVisible()]
    assert len(arrows) == 2
    for arrow in arrows:
        assert arrow.width() >= 24
        middle = arrow.grab().toImage().convertToFormat(QImage.Format.Format_Grayscale8)
        inside = [
            middle.pixelColor(x, y).lightness()
            for x in range(4, middle.width() - 4)
            for y in range(8, middle.height() - 8)
        ]
        assert max(inside) - min(inside) > 40, "the arrow is not drawn"
    tabs.close()
    apply_theme(application, Theme.LIGHT)
