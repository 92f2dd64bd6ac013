"""What lies over the view while a vehicle is connected: figures, attitude, warnings and the camera's picture."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QMargins, QObject, QRect, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.fly.instruments import AttitudeView, FlightFigures
from groundstation.gui.fly.live_camera import LiveCamera
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.announce import AgedWarning, ordered_warnings
from groundstation.services.fly.events import LinkState, LiveView
from groundstation.services.fly.sortie import LiveSortie
from groundstation.services.units import UnitSystem, minutes_text
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity

EDGE_PX = 6
SIDE_PX = 210
"""Width of attitude and camera picture."""

LARGE_SIDE_PX = 440
"""Of the camera picture once it was clicked."""

ATTITUDE_PX = 180
MAX_SHOWN = 3
"""Warnings; the rest are counted."""


class WarningBanner(QFrame):
    """The warnings that hold, in their colour, with how long they have; gone when they are over.

    Signals
    -------
    muteToggled(bool)
        Whether they are not spoken.
    """

    muteToggled = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Warnings"))
        self._units = UnitSystem.METRIC
        self._labels = [QLabel() for _ in range(MAX_SHOWN)]
        self._more = QLabel()
        self.mute = QPushButton(self.tr("Mute"))
        self.mute.setCheckable(True)
        self.mute.setToolTip(self.tr("Warnings are shown, and not spoken"))
        self.mute.toggled.connect(self.muteToggled)
        self.mute.hide()
        texts = self._texts = QVBoxLayout()
        texts.setSpacing(2)
        for label in (*self._labels, self._more):
            label.setWordWrap(True)
            label.setMargin(5)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
            texts.addWidget(label)
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addLayout(texts, 1)
        row.addWidget(self.mute, 0, Qt.AlignmentFlag.AlignTop)
        self.set_warnings(())

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units

    def set_muted(self, *, is_muted: bool, has_voice: bool) -> None:
        """Show whether warnings are spoken; without a voice nothing is to be chosen."""
        blocker = QSignalBlocker(self.mute)
        self.mute.setChecked(is_muted)
        del blocker
        self.mute.setVisible(has_voice)

    def set_warnings(self, aged: Sequence[AgedWarning]) -> bool:
        """Show these warnings; returns whether another size is needed."""
        ages_s = {each.warning.code: each.age_s for each in aged}
        warnings = ordered_warnings([each.warning for each in aged])
        before = [(label.isHidden(), label.text()) for label in (*self._labels, self._more)]
        for number, label in enumerate(self._labels):
            label.setVisible(number < len(warnings))
            if number < len(warnings):
                self._fill(label, warnings[number], ages_s[warnings[number].code])
            else:
                label.setText("")
        n_more = len(warnings) - MAX_SHOWN
        self._more.setVisible(n_more > 0)
        self._more.setText(self.tr("{0} more in the list").format(n_more) if n_more > 0 else "")
        return before != [(label.isHidden(), label.text()) for label in (*self._labels, self._more)]

    def height_for(self, width_px: int) -> int:
        """Height that the shown lines need; a layout that is not seen yet would answer for the lines before."""
        beside = 0 if self.mute.isHidden() else self.mute.sizeHint().width() + self._row.spacing()
        shown = [label for label in (*self._labels, self._more) if not label.isHidden()]
        lines = sum(label.heightForWidth(max(1, width_px - beside)) for label in shown)
        lines += self._texts.spacing() * max(0, len(shown) - 1)
        return max(lines, 0 if self.mute.isHidden() else self.mute.sizeHint().height())

    def is_empty(self) -> bool:
        """Whether nothing is wrong."""
        return self._labels[0].isHidden()

    def text(self) -> str:
        """All that is shown, a line each."""
        return "\n".join(label.text() for label in (*self._labels, self._more) if not label.isHidden())

    def _fill(self, label: QLabel, warning: FlightWarning, age_s: float) -> None:
        look, words = colours(), translated(warning.text, self._units)
        is_error = warning.severity is Severity.ERROR
        title = self.tr("DANGER") if is_error else self.tr("Warning")
        text = self.tr("{0} ({1}): {2}").format(title, minutes_text(age_s), words)
        if label.text() != text:
            label.setText(text)
        style = f"background: {look.error if is_error else look.warning}; color: {look.base}; font-weight: bold;"
        if label.styleSheet() != style:
            label.setStyleSheet(style)


class FlightOverlay(QObject):
    """Lays it over a shared view, and keeps the view's own marks free of it."""

    def __init__(self, shared_view: SharedView, parent: QObject) -> None:
        super().__init__(parent)
        self._shared_view = shared_view
        self.figures, self.attitude = FlightFigures(shared_view), AttitudeView(shared_view)
        self.banner, self.camera = WarningBanner(shared_view), LiveCamera(shared_view)
        self._view: LiveView | None = None
        self._warnings: tuple[AgedWarning, ...] = ()
        self._is_shown = self._has_sides = self._is_stale = False
        self._is_large = False
        self._n_drawn = 0
        for widget in self._parts():
            widget.hide()
        self.camera.sizeToggled.connect(self.toggle_camera)
        shared_view.resized.connect(self._place)
        shared_view.pageShown.connect(lambda _page: self._place())

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self.figures.set_units(units)
        self.banner.set_units(units)

    def set_sortie(self, sortie: LiveSortie | None) -> None:
        """The sortie whose site the camera sees."""
        self.camera.set_sortie(sortie)

    def set_video(self, url: str) -> None:
        """The stream that the camera sends; empty for none."""
        self.camera.set_video(url)
        self._place()

    def toggle_camera(self) -> None:
        """Make the camera's picture large, or small again."""
        self._is_large = not self._is_large
        self._place()

    def set_view(self, view: LiveView | None) -> None:
        """The flight as it stands; drawn with the next `draw`."""
        self._view, self._is_stale = view, True

    def set_warnings(self, warnings: tuple[AgedWarning, ...]) -> None:
        """The warnings of all flights; drawn with the next `draw`."""
        self._warnings, self._is_stale = warnings, True

    def show(self, *, is_shown: bool, has_sides: bool = True) -> None:
        """Appear or go; without its sides there are warnings alone, for the lists have the figures, too."""
        if (is_shown, has_sides) != (self._is_shown, self._has_sides):
            self._is_shown, self._has_sides, self._is_stale = is_shown, has_sides, True
            self._place()
            self.draw()

    def draw(self) -> None:
        """Bring everything up to date; the camera's picture every second time, for it costs as much as the rest."""
        if not self._is_shown:
            return
        self._n_drawn += 1
        if self._is_stale:
            self._is_stale = False
            view = self._view
            wide = self.figures.sizeHint().width()
            self.figures.set_view(view)
            is_wider = self.figures.sizeHint().width() != wide
            state = None if view is None else view.state
            attitude = None if state is None or state.attitude is None else state.attitude.value
            pointing = None if state is None or state.camera is None else state.camera.value
            self.attitude.set_angles(attitude, pointing, is_old=view is not None and view.link is LinkState.LOST)
            if self.banner.set_warnings(self._warnings) or is_wider:
                self._place()
        if self.camera.isVisible():
            self.camera.show_video()
            is_due = self._n_drawn % 2 == 0 and self._view is not None and not self.camera.shows_video()
            if is_due and self._view is not None:
                self.camera.look(self._view.state)

    def close_view(self) -> None:
        """Free what the camera's picture holds."""
        self.camera.close_view()

    def _parts(self) -> tuple[QWidget, ...]:
        return self.figures, self.attitude, self.banner, self.camera

    def _place(self) -> None:
        """Put everything where it goes: figures at the left, attitude and camera at the right, warnings between."""
        room, is_over = self._shared_view.room(), self._is_shown
        # The camera preview has controls of its own at its edges.
        has_sides = is_over and self._has_sides and self._shared_view.page() is not SharedViewPage.CAMERA
        left = min(self.figures.sizeHint().width(), room.width() // 3)
        side = min(SIDE_PX, room.width() // 3)
        high = min(self.figures.sizeHint().height(), room.height() - 2 * EDGE_PX)
        self._put(self.figures, QRect(room.left() + EDGE_PX, room.top() + EDGE_PX, left, high), has_sides)
        x = room.right() - EDGE_PX - side
        upper = min(ATTITUDE_PX, room.height() // 2)
        self._put(self.attitude, QRect(x, room.top() + EDGE_PX, side, upper), has_sides)
        free = room.height() - upper - 3 * EDGE_PX
        wide = min(LARGE_SIDE_PX, room.width() // 2) if self._is_large else side
        while wide > side and self.camera.height_for(wide) > free:
            wide -= 10
        lower = self.camera.height_for(wide)
        at = QRect(room.right() - EDGE_PX - wide, room.bottom() - EDGE_PX - lower, wide, lower)
        self._put(self.camera, at, has_sides and lower <= free and self.camera.has_site())
        taken_left = left + EDGE_PX if has_sides else 0
        taken_right = side + EDGE_PX if has_sides else 0
        width = room.width() - taken_left - taken_right - 2 * EDGE_PX
        lines = self.banner.height_for(width)
        at = QRect(room.left() + taken_left + EDGE_PX, room.top() + EDGE_PX, width, lines)
        self._put(self.banner, at, is_over and not self.banner.is_empty())
        top = 0 if not has_sides or self.banner.isHidden() else at.height() + EDGE_PX
        self._shared_view.set_insets(QMargins(taken_left, top, taken_right, 0))

    def _put(self, widget: QWidget, at: QRect, is_shown: bool) -> None:
        if is_shown and at.width() > 0 and at.height() > 0:
            if widget.geometry() != at:
                widget.setGeometry(at)
            if widget.isHidden():
                widget.show()
                widget.raise_()
        elif not widget.isHidden():
            widget.hide()
