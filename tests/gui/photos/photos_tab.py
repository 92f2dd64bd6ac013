"""The Photos tab in the real window with its photos read, and hands to work it."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.services.project.document import Document
from groundstation.services.project.session import History
from tests.gui.driving import choose, clicked, turn_until, turn_until_idle
from tests.services.photo_cases import draft_of, site_model, with_paths


class PhotosTab:
    """A user at the tab."""

    def __init__(self, application, controller, folder, model=None):
        self.application, self.controller = application, controller
        controller.context.session.open(Document(site_model() if model is None else model), None)
        controller.window.show_tab("photos")
        self.tab = controller.window.tab("photos")
        self.messages = []
        controller.context.messageShown.connect(self.messages.append)
        turn_until(application, self.tab.choose.isEnabled)
        with clicked(choose(folder)):
            self.tab.choose.click()
        self.idle()

    @property
    def view(self):
        return self.tab.pane.view

    @property
    def draft(self):
        return self.tab.controller.draft

    @property
    def grid(self):
        return self.draft.grid(self.tab.pane.place())

    def idle(self):
        turn_until_idle(self.application, self.controller)
        turn_until(self.application, lambda: not self.tab.store.is_busy())
        self.application.processEvents()

    def found(self, draft=None):
        """Give the controller what a search finds in these photos; the search itself is tested where it is."""
        cards = self.tab.controller.cards
        draft = draft_of([card.posed for card in cards]) if draft is None else draft
        self.tab.controller._history = History(with_paths(draft, [card.path for card in cards]))
        self.tab.controller.draftChanged.emit()
        self.idle()

    def at(self, point_px):
        return self.view.place_of(point_px).toPoint()

    def press(self, point_px):
        QTest.mouseClick(self.view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, self.at(point_px))
        self.idle()

    def drag(self, start, end):
        buttons = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        QTest.mousePress(self.view, *buttons, start)
        QTest.mouseMove(self.view, end)
        QTest.mouseRelease(self.view, *buttons, end)
        self.idle()

    def use_tool(self, name):
        from groundstation.gui.photos.grid_view import Tool

        self.tab.tools._buttons[Tool[name]].click()

    def keys(self, *keys, shift=False):
        modifier = Qt.KeyboardModifier.ShiftModifier if shift else Qt.KeyboardModifier.NoModifier
        for key in keys:
            QTest.keyClick(self.view, Qt.Key[f"Key_{key}"], modifier)
