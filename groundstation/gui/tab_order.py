"""In which order Tab goes through a window: region by region as it is read, whatever was made first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget


def next_in_order(regions: Sequence[QWidget], current: QWidget | None, *, forward: bool) -> QWidget | None:
    """The widget that gets the focus after `current`; None where no region takes it.

    Within a region the order is Qt's own; after the last widget the first one follows. What is outside all regions is
    skipped.

    Parameters
    ----------
    regions
        Of one window, none inside another.
    """
    stops = [widget for region in regions for widget in _stops_in(region)]
    if not stops:
        return None
    if current not in stops:
        return stops[0 if forward else -1]
    return stops[(stops.index(current) + (1 if forward else -1)) % len(stops)]


def first_in(region: QWidget) -> QWidget | None:
    """The first widget of a region that Tab reaches."""
    return next(_stops_in(region), None)


def _stops_in(region: QWidget) -> Iterator[QWidget]:
    widget = region
    while True:
        if (region is widget or region.isAncestorOf(widget)) and _takes_tab(widget):
            yield widget
        widget = widget.nextInFocusChain()
        if widget is None or widget is region:
            return


def _takes_tab(widget: QWidget) -> bool:
    is_reached = bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
    return is_reached and widget.isVisible() and widget.isEnabled() and widget.focusProxy() is None
