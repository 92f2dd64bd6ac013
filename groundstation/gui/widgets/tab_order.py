"""In which order Tab goes through a window: region by region as it is read, whatever was made first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QApplication, QFocusFrame, QWidget

FRAME_PX = 2


def next_in_order(regions: Sequence[QWidget], current: QWidget | None, *, forward: bool) -> QWidget | None:
    """The widget that gets the focus after `current`; None where no region takes it.

    Within a region the order is Qt's own; after the last widget the first one follows. What is outside all regions is
    skipped; from a frame inside one it goes on beside it.

    Parameters
    ----------
    regions
        Of one window, none inside another.
    """
    stops = _stops(regions)
    if not stops:
        return None
    if current not in stops:
        is_inside = any(region is current or region.isAncestorOf(current) for region in regions if current is not None)
        neighbour = _beside(stops, current, forward) if is_inside else None
        return stops[0 if forward else -1] if neighbour is None else neighbour
    return stops[(stops.index(current) + (1 if forward else -1)) % len(stops)]


def first_in(region: QWidget) -> QWidget | None:
    """The first widget of a region that Tab reaches."""
    return next(_stops_in(region), None)


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


def _beside(stops: Sequence[QWidget], current: QWidget | None, forward: bool) -> QWidget | None:
    """The stop next to a widget that is none, where there is one."""
    widget = current
    while widget is not None:
        widget = widget.nextInFocusChain() if forward else widget.previousInFocusChain()
        if widget is current or widget in stops:
            return None if widget is current else widget
    return None


def _stops(regions: Sequence[QWidget]) -> list[QWidget]:
    """All stops in order. The window's chain of widgets is walked once: it is long, and most of it is hidden."""
    if not regions:
        return []
    chain = list(_chain(regions[0]))
    reached = [(place, widget) for place, widget in enumerate(chain) if _takes_tab(widget)]
    found: list[QWidget] = []
    for region in regions:
        first = chain.index(region)
        inside = [(place < first, place, widget) for place, widget in reached if _is_in(region, widget)]
        found += [widget for _is_before, _place, widget in sorted(inside, key=lambda stop: stop[:2])]
    return found


def _stops_in(region: QWidget) -> Iterator[QWidget]:
    return (widget for widget in _chain(region) if _takes_tab(widget) and _is_in(region, widget))


def _chain(first: QWidget) -> Iterator[QWidget]:
    """The widgets of a window in Qt's own order, from one of them on."""
    widget: QWidget | None = first
    while widget is not None:
        yield widget
        widget = widget.nextInFocusChain()
        if widget is first:
            return


def _is_in(region: QWidget, widget: QWidget) -> bool:
    return region is widget or region.isAncestorOf(widget)


def _takes_tab(widget: QWidget) -> bool:
    # What most widgets fail at first: they are in tabs that are not shown.
    if not (widget.isVisible() and widget.isEnabled()):
        return False
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus) and widget.focusProxy() is None
