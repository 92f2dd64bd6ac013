"""The main window: tabs along the pilot's work around one shared view, the job bar, messages, and the menus.

It arranges; what happens in a tab is the tab's own matter, and what happens to the project is in `project_controller`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QCloseEvent, QKeyEvent, QShowEvent, QWhatsThisClickedEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QScrollArea,
    QSplitter,
    QTabBar,
    QToolButton,
    QVBoxLayout,
    QWhatsThis,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import TURN_MS, GradualTab
from groundstation.gui.application.interpreter import BackgroundImport
from groundstation.gui.shared_view import SharedView
from groundstation.gui.tabs import TABS, Place, Tab, TabSpec
from groundstation.gui.widgets.icons import NAME, icon
from groundstation.gui.widgets.job_bar import JobBar
from groundstation.gui.widgets.scrolling import CurrentStack, scrolled, split
from groundstation.gui.widgets.tab_order import FocusFrame, first_in, next_in_order
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.gui.window.message_area import MessageArea
from groundstation.gui.window.next_step import NextStepBar
from groundstation.services.project.document import Document
from groundstation.services.project.steps import Act, Step, guidance, is_done

SIDE_WIDTH_PX, DETAIL_WIDTH_PX = 300, 330
BOTTOM_HEIGHT_PX = 190
"""First sizes of what stands around the shared view, at 1280 x 720."""


if TYPE_CHECKING:
    from groundstation.gui.window.help import ManualWindow

STEPS = frozenset(Step)

MAKE_NEXT_MS = 500
"""After a tab was shown, the next one is made, which takes up to a fifth of a second."""

WANTS_TABS = (QEvent.Type.MouseButtonPress, QEvent.Type.KeyPress, QEvent.Type.TouchBegin)
"""Somebody works with the window: the tabs behind the start page are imported, which take 0.2 GB and some seconds."""

TABS_OF_ACTS = {Act(f"to-{spec.name}"): spec.name for spec in TABS}
"""Where each act leads that is nothing but a way to another tab."""

SCENE_MODULE = "groundstation.gui.view3d.scene_view"

PLAYER_MODULE = "groundstation.gui.camera_preview.plan_player"
"""The 3-D view has its time slider, and makes it with itself: imported then, it took half of 0.16 s."""


LOCK_MODULE = "filelock"
"""Of the first copy of unsaved work: imported then, it took 70 ms."""


class MainWindow(QMainWindow):
    """The window.

    Signals
    -------
    tabShown(str)
        Name of the tab that came to the front.
    closing(QCloseEvent)
        Ignore the event to stay.
    """

    tabShown = Signal(str)  # noqa: N815  (Qt's own way of naming)
    closing = Signal(object)

    def __init__(self, context: ApplicationContext) -> None:
        super().__init__()
        self._context = context
        self._tabs: dict[str, Tab] = {}
        self._shown: TabSpec | None = None
        self._begun_tabs: dict[str, Tab] = {}
        self._was_shown = False
        self._ready: set[str] = set()
        self._coming: TabSpec | None = None
        self._loading = BackgroundImport(parent=self)
        self._loading.imported.connect(self._imported)
        self._is_wanted = False
        self._first_act: tuple[str, Act] | None = None
        self._manual: ManualWindow | None = None
        self._takes_keyboard = False
        self._quick_buttons: list[QToolButton] = []
        self._ticks: dict[str, tuple[bool, Colours]] = {}
        self.shared_view = SharedView(context)
        self.shared_view.tabRequested.connect(self.show_tab)
        self.shared_view.aloneRequested.connect(self._set_view_alone)
        self.messages = MessageArea(context)
        self.job_bar = JobBar(context)
        self.next_step = NextStepBar()
        self._make_layout()
        self._focus_frame = FocusFrame(self)
        self._bar.currentChanged.connect(self._tab_chosen)
        self.next_step.wanted.connect(self.take_step)
        self.next_step.helpRequested.connect(lambda: self.open_manual(f"guide/{self.shown_tab()}.md"))
        context.milestonesChanged.connect(self._show_steps)
        context.documentChanged.connect(self._leave_start)
        self._make_soon = QTimer(self, interval=MAKE_NEXT_MS, singleShot=True)
        self._make_soon.timeout.connect(self._make_next)
        self._next_part = QTimer(self, interval=TURN_MS, singleShot=True)
        self._next_part.timeout.connect(self._make_coming)
        self._show_steps()

    def _make_layout(self) -> None:
        self._bar = QTabBar()
        self._bar.setExpanding(False)
        self._bar.setDrawBase(False)
        self._bar.setUsesScrollButtons(True)
        for spec in TABS:
            self._bar.addTab(spec.shown_title())
        self._left, self._right, self._bottom = CurrentStack(), CurrentStack(), CurrentStack()
        # The left side is as high as the window: forms are long. The lists below need width more.
        beside = 1280 - SIDE_WIDTH_PX
        widths_px = beside - DETAIL_WIDTH_PX, DETAIL_WIDTH_PX
        self._view_and_right = split((self.shared_view, self._right), widths_px, 0)
        heights_px = 450, BOTTOM_HEIGHT_PX
        self._over_bottom = split((self._view_and_right, self._bottom), heights_px, 0, Qt.Orientation.Vertical)
        self._around = split((self._left, self._over_bottom), (SIDE_WIDTH_PX, beside), 1)
        for splitter in (self._view_and_right, self._over_bottom, self._around):
            splitter.setHandleWidth(6)
        self._pages, self._title_of_coming = CurrentStack(), QLabel()
        self._title_of_coming.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._title_of_coming.setProperty("role", "muted")
        self._pages.addWidget(self._around)
        self._pages.addWidget(self._title_of_coming)
        page = QWidget()
        layout = QVBoxLayout(page)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        self._top = QHBoxLayout()
        self._top.addWidget(self._bar, 1)
        layout.addLayout(self._top)
        layout.addWidget(self.next_step)
        layout.addWidget(self._pages, 1)
        below = QHBoxLayout()
        below.addWidget(self.messages, 1)
        below.addWidget(self.job_bar, 1)
        layout.addLayout(below)
        self.setCentralWidget(page)

    def add_quick_actions(self, actions: Iterable[QAction]) -> None:
        """Put large buttons for actions beside the tabs: what is needed everywhere must be hit by a finger.

        Each action has the name of its icon as the property `groundstation.gui.widgets.icons.NAME`.
        """
        for action in actions:
            button = QToolButton()
            button.setDefaultAction(action)
            button.setAccessibleName(action.iconText())
            self._top.addWidget(button)
            self._quick_buttons.append(button)
        self._tint_quick_buttons()

    def _tint_quick_buttons(self) -> None:
        for button in self._quick_buttons:
            action = button.defaultAction()
            action.setIcon(icon(str(action.property(NAME))))

    def tab_bar(self) -> QTabBar:
        """The row of tabs."""
        return self._bar

    def open_manual(self, place: str = "") -> None:
        """Show the manual, at a page where one is wanted."""
        if self._manual is None:
            from groundstation.gui.window.help import ManualWindow

            self._manual = ManualWindow(self._context, self)
        self._manual.open_page(*([place] if place else []))

    def event(self, event: QEvent) -> bool:
        """Follow a link of "What's this?" into the manual."""
        if isinstance(event, QWhatsThisClickedEvent):
            QWhatsThis.hideText()
            self.open_manual(event.href())
            return True
        return super().event(event)

    def tab_names(self) -> tuple[str, ...]:
        """Names of all tabs, in order."""
        return tuple(spec.name for spec in TABS)

    def tab(self, name: str) -> Tab:
        """A tab by its name; made when it was not yet."""
        if name not in self._tabs:
            spec = next(spec for spec in TABS if spec.name == name)
            while self._make_part(spec):
                pass
            self._tabs[name] = self._begun(spec)
        return self._tabs[name]

    def _begun(self, spec: TabSpec) -> Tab:
        """A tab, whether it has its place in the window or not yet; perhaps not all of it."""
        if spec.name not in self._begun_tabs:
            self._begun_tabs[spec.name] = spec.begin(self._context, self.shared_view)
        return self._begun_tabs[spec.name]

    def show_tab(self, name: str) -> None:
        """Bring a tab to the front, and the keyboard to its first widget, now; one that is not made yet is made."""
        self.tab(name)
        self.lead_to(name)

    def lead_to(self, name: str, act: Act | None = None) -> None:
        """Bring a tab to the front, and the keyboard to its first widget, as soon as it is made; then do a step in it.

        The step is forgotten where another tab is chosen before.
        """
        self._first_act = None if act is None else (name, act)
        self._bar.setCurrentIndex(self.tab_names().index(name))
        if self._shown is None:
            self._tab_chosen(self._bar.currentIndex())
        self._takes_keyboard = True
        if self._coming is None:
            self._give_keyboard()

    def _give_keyboard(self) -> None:
        """To the first widget of the tab that came to the front, where somebody was led there."""
        if self._takes_keyboard and self._shown is not None:
            first = first_in(self._tabs[self._shown.name].left)
            (self._bar if first is None else first).setFocus(Qt.FocusReason.ShortcutFocusReason)
        self._takes_keyboard = False

    def shown_tab(self) -> str:
        """Name of the tab at the front."""
        return "" if self._shown is None else self._shown.name

    def take_step(self, act: Act) -> None:
        """Lead on: to another tab, or by doing something in the one that is shown."""
        if act in TABS_OF_ACTS:
            self.lead_to(TABS_OF_ACTS[act])
        elif self._shown is not None:
            self._tabs[self._shown.name].take_step(act)

    def _make_next(self) -> None:
        """Make the tab that will be wanted next, while nothing else happens, so that it is there at once."""
        if self._context.is_busy or self._coming is not None:
            self._make_soon.start()
        elif self._shown is not None and not self._bar.signalsBlocked():
            following = TABS[min(TABS.index(self._shown) + 1, len(TABS) - 1)]
            if following.module not in self._ready:
                self._make_soon.start()
            elif following.name not in self._tabs:
                has_more = self._make_part(following)
                QTimer.singleShot(TURN_MS, self, self._make_next if has_more else lambda: self.tab(following.name))

    def _make_part(self, spec: TabSpec) -> bool:
        """Make another part of a tab, or give one its place, which takes half as long again; whether there was one."""
        is_known, page = spec.name in self._begun_tabs, self._begun(spec)
        if page.go_on() if isinstance(page, GradualTab) else not is_known:
            return True
        if spec.place is Place.WHOLE_PAGE:
            places: list[tuple[CurrentStack, QWidget | None]] = [(self._pages, page.left)]
        else:
            places = [(self._left, page.left), (self._right, page.right), (self._bottom, page.bottom)]
        for stack, widget in places:
            if widget is not None and not stack.isAncestorOf(widget):
                stack.addWidget(scrolled(widget) if stack is self._left else widget)
                return True
        return False

    def _announce(self, spec: TabSpec) -> None:
        """Show a tab's title while it is made, a part in each turn: the window answers meanwhile."""
        self._coming = spec
        self.next_step.hide()
        self._title_of_coming.setText(self.tr("{0} ...").format(spec.shown_title()))
        self._pages.setCurrentWidget(self._title_of_coming)
        self._import_tabs()
        self._next_part.start()

    def _make_coming(self) -> None:
        """Go on with the tab that was announced."""
        spec = self._coming
        if spec is None or self._bar.signalsBlocked():
            return
        if spec.name in self._tabs:
            self._bring(spec)
            return
        if spec.module not in self._ready:
            self._loading.hurry(spec.module)
        elif not self._make_part(spec):
            self.tab(spec.name)
        self._next_part.start()

    def _leave_start(self, before: Document, after: Document) -> None:
        """Show a site that was opened from the start page; a window that has made room for another stays as it is."""
        is_new = after.site is not None and before.site is not after.site
        if is_new:
            self._import_tabs()
        if is_new and self.shown_tab() in ("", "start"):
            # In a turn of its own: the views have the site to take in now.
            QTimer.singleShot(0, self, self._show_site)

    def _show_site(self) -> None:
        if self.shown_tab() in ("", "start") and not self._bar.signalsBlocked():
            self.lead_to("site")

    def _show_steps(self, *_changed: object) -> None:
        """Tick the steps that are behind, and say what the one that is shown leads to."""
        now, look = self._context.milestones, colours()
        for number, spec in enumerate(TABS):
            is_behind = spec.name in STEPS and is_done(Step(spec.name), now)
            if self._ticks.get(spec.name) == (is_behind, look):
                continue
            self._ticks[spec.name] = is_behind, look
            self._bar.setTabIcon(number, icon("done", look.ok) if is_behind else icon(spec.name, look.muted))
            tip = self.tr("{0} (Ctrl+{1})").format(spec.shown_tip(), number)
            self._bar.setTabToolTip(number, self.tr("Done. {0}").format(tip) if is_behind else tip)
        shown = self._shown
        self.next_step.setVisible(shown is not None and shown.name in STEPS)
        if shown is not None and shown.name in STEPS:
            found = guidance(Step(shown.name), now)
            words = (self._context.localized(str(text)) for text in (found.done, found.next, found.label))
            self.next_step.set_guidance(found, *words)

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the signs of the tabs in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "next_step"):
            self._show_steps()
            self._tint_quick_buttons()

    def _tab_chosen(self, index: int) -> None:
        spec = TABS[index]
        if self._shown is None or spec.name in self._tabs:
            self._bring(spec)
        else:
            self._announce(spec)

    def _bring(self, spec: TabSpec) -> None:
        """Bring a tab to the front; back to it, where another one was announced."""
        is_back, self._coming = self._coming is not None, None
        if spec is self._shown and not is_back:
            return
        if self._shown is not None:
            self._tabs[self._shown.name].hidden()
        tab = self.tab(spec.name)
        self._context.report_plugin_problems()
        self._shown = spec
        # Before the page: what is shown is laid out once, with its final room.
        self._show_steps()
        if spec.place is Place.WHOLE_PAGE:
            self._pages.setCurrentWidget(tab.left)
        else:
            self._pages.setCurrentWidget(self._around)
            self._left.setCurrentWidget(_scroll_area_of(tab.left))
            for stack, widget in ((self._right, tab.right), (self._bottom, tab.bottom)):
                stack.setVisible(widget is not None)
                if widget is not None:
                    stack.setCurrentWidget(widget)
        # Keys of a tab work while it is shown; which of its actions can be done is the tab's own matter.
        for name, page in self._tabs.items():
            for action in page.actions():
                (self.addAction if name == spec.name else self.removeAction)(action)
        tab.shown()
        if spec.name == "start" and not self._is_wanted:
            self._watch_start(tab.left)
        self._give_keyboard()
        self._make_soon.start()
        self.tabShown.emit(spec.name)
        first, self._first_act = self._first_act, None
        if first is not None and first[0] == spec.name:
            # In a turn of its own: the tab is seen before a dialog lies over it.
            QTimer.singleShot(0, self, lambda: self.take_step(first[1]))

    def _set_view_alone(self, is_alone: bool) -> None:
        """Give the shared view the room of the lists, or take it back; another tab takes it back, too."""
        if self._shown is not None and self._shown.place is not Place.WHOLE_PAGE:
            tab = self._tabs[self._shown.name]
            self._right.setVisible(tab.right is not None and not is_alone)
            self._bottom.setVisible(tab.bottom is not None and not is_alone)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Let Enter press the button that has the keyboard, as in dialogs; Qt lets only Space do it."""
        button, is_enter = self.focusWidget(), Qt.Key(event.key()) in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        is_alone = not event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier and not event.isAutoRepeat()
        if is_enter and is_alone and isinstance(button, QAbstractButton):
            button.animateClick()
        else:
            super().keyPressEvent(event)

    def focusNextPrevChild(self, next: bool) -> bool:  # noqa: A002, N802
        """Take Tab through the window as it is read: tabs, form, view, details, lists, messages, jobs."""
        regions = (
            self._bar,
            *self._quick_buttons,
            self.next_step,
            self._pages if self._pages.currentWidget() is not self._around else self._left,
            self.shared_view,
            self._right,
            self._bottom,
            self.messages.sheet,
            self.messages,
            self.job_bar,
        )
        following = next_in_order(regions, self.focusWidget(), forward=next)
        if following is None:
            return False
        following.setFocus(Qt.FocusReason.TabFocusReason if next else Qt.FocusReason.BacktabFocusReason)
        return True

    def layout_text(self) -> str:
        """Sizes of everything that can be resized, as text for the settings."""
        parts = (self.saveGeometry(), *(splitter.saveState() for splitter in self._splitters()))
        return ";".join(bytes(part.toBase64().data()).decode() for part in parts)

    def set_layout_text(self, text: str) -> None:
        """Take sizes over that `layout_text` gave; texts of anything else change nothing."""
        from PySide6.QtCore import QByteArray

        parts = [QByteArray.fromBase64(part.encode()) for part in text.split(";")]
        if len(parts) == 1 + len(self._splitters()):
            self.restoreGeometry(parts[0])
            for splitter, part in zip(self._splitters(), parts[1:], strict=True):
                splitter.restoreState(part)

    def _splitters(self) -> tuple[QSplitter, ...]:
        return self._around, self._over_bottom, self._view_and_right

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Paint first; what takes long comes after."""
        super().showEvent(event)
        if not self._was_shown:
            self._was_shown = True
            first = TABS[max(0, self._bar.currentIndex())]
            QTimer.singleShot(0, self, lambda: self._loading.add(first.module, PLAYER_MODULE, SCENE_MODULE))
            if first.name != "start":
                self._import_tabs()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Import the other tabs once somebody works with the window: a start page that is only there is small."""
        if event.type() in WANTS_TABS:
            self._import_tabs()
        return super().eventFilter(watched, event)

    def _watch_start(self, page: QWidget) -> None:
        """See presses on what leads on from the start page; all that the application hears would be too much."""
        for widget in (self._bar, self.menuBar(), *page.findChildren(QAbstractButton)):
            widget.installEventFilter(self)

    def _import_tabs(self) -> None:
        if not self._is_wanted:
            self._is_wanted = True
            QTimer.singleShot(0, self, lambda: self._loading.add(*(spec.module for spec in TABS), LOCK_MODULE))

    def _imported(self, module: str) -> None:
        """Show the first tab, then the 3-D view, as they can be had."""
        if self._shown is None:
            self._tab_chosen(max(0, self._bar.currentIndex()))
        self._ready.add(module)
        if module == SCENE_MODULE:
            self.shared_view.make_scene()

    def retire(self) -> None:
        """Make room for another window on the same context: jobs go on, nobody is asked."""
        self._show_no_more()
        self.shared_view.close_views()
        self.hide()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Ask those who have something to lose, end the jobs, free the 3-D view."""
        event.accept()
        self.closing.emit(event)
        if event.isAccepted():
            self.shared_view.closing.emit(event)
        if not event.isAccepted():
            return
        self._context.close()
        self._show_no_more()
        self.shared_view.close_views()
        super().closeEvent(event)

    def _show_no_more(self) -> None:
        """Bring no tab to the front any more: its menu may have gone before the row of tabs does."""
        self._bar.blockSignals(True)


def _scroll_area_of(widget: QWidget) -> QScrollArea:
    viewport = widget.parentWidget()
    area = None if viewport is None else viewport.parentWidget()
    assert isinstance(area, QScrollArea)
    return area
