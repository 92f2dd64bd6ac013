"""In which order Tab goes through a window: region by region as it is read, whatever was made first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cmp_to_key

from PySide6.QtCore import Qt
from PySide6.QtGui import QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QApplication, QFocusFrame, QWidget

FRAME_PX = 2


def next_in_order(regions: Sequence[QWidget], current: QWidget | None, *, forward: bool) -> QWidget | None:
    """The widget that gets the focus after `current`; None where no region takes it.

    After the last widget the first one follows. What is outside all regions is skipped; from a frame inside one it goes
    on beside it.

    Parameters
    ----------
    regions
        Of one window, none inside another.
    """
    shown = [widget for region in regions for widget in _shown_in(region)]
    stops = [place for place, widget in enumerate(shown) if _takes_tab(widget)]
    if not stops:
        return None
    while current is not None and current not in shown:
        current = current.parentWidget()
    if current is None:
        return shown[stops[0 if forward else -1]]
    here = shown.index(current)
    beside = [place for place in stops if place > here] if forward else [place for place in stops if place < here]
    if not beside:
        beside = stops
    return shown[beside[0 if forward else -1]]


def first_in(region: QWidget) -> QWidget | None:
    """The first widget of a region that Tab reaches."""
    return next((widget for widget in _shown_in(region) if _takes_tab(widget)), None)


class FocusFrame(QFocusFrame):
    """Shows which frame has the keyboard, where no widget has it: see `set_enabled`. Widgets show it by themselves."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        # Else it comes up with its window, around nothing.
        self.hide()
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._follow)

    def _follow(self, _before: QWidget | None, now: QWidget | None) -> None:
        is_ours = now is not None and now.window() is self.window()
        is_frame = is_ours and now is not None and not now.focusPolicy() & Qt.FocusPolicy.TabFocus
        is_shown = is_frame and now is not self.window()
        self.setWidget(now if is_shown else None)  # type: ignore[arg-type]
        self.setVisible(is_shown)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """A line around it, as around a button; inside, for what scrolls shows nothing beside it."""
        painter = QPainter(self)
        painter.setPen(QPen(self.palette().highlight(), FRAME_PX))
        inset = 2 * FRAME_PX
        painter.drawRect(self.rect().adjusted(inset, inset, -inset, -inset))
        painter.end()


def set_enabled(widget: QWidget, is_enabled: bool) -> None:
    """Enable or disable a widget; where the keyboard was in it, it goes to the frame around.

    Qt would give it to the next widget: a key that is pressed again would press that one, and forms would scroll to it.
    """
    focus = widget.window().focusWidget()
    around = widget.parentWidget()
    if not is_enabled and around is not None and focus is not None and (focus is widget or widget.isAncestorOf(focus)):
        around.setFocus(Qt.FocusReason.OtherFocusReason)
    widget.setEnabled(is_enabled)


def _shown_in(region: QWidget) -> Iterator[QWidget]:
    """A region and what is shown in it, from the top to the bottom; what is beside each other from left to right.

    Qt's own order cannot be asked for: PySide takes each widget that `nextInFocusChain` gives for a part of the one it
    was asked of. With that one go, in Python, all that follow it, the window's menus and rows among them, and the next
    time these are laid out the process ends.
    """
    if not region.isVisible():
        return
    yield region
    inside = [child for child in region.children() if isinstance(child, QWidget) and not child.isWindow()]
    for child in sorted(inside, key=cmp_to_key(_reading_order)):
        yield from _shown_in(child)


def _reading_order(one: QWidget, other: QWidget) -> int:
    """Negative where one is read before the other."""
    a, b = one.geometry(), other.geometry()
    common = min(a.bottom(), b.bottom()) - max(a.top(), b.top())
    is_beside = 2 * common > min(a.height(), b.height())
    return a.left() - b.left() if is_beside else a.top() - b.top()


def _takes_tab(widget: QWidget) -> bool:
    takes_keys = widget.isEnabled() and bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
    return takes_keys and widget.focusProxy() is None
