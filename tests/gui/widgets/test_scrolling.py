"""Rows that wrap: everything is inside, margins count, and the height that is asked for is the height that is used."""

import pytest
from PySide6.QtWidgets import QPushButton, QWidget

from groundstation.gui.widgets.scrolling import ButtonGrid, WrappingRow

MARGINS = (7, 3, 11, 5)


@pytest.mark.parametrize("margins", [(0, 0, 0, 0), MARGINS])
@pytest.mark.parametrize("width", [120, 260, 900])
@pytest.mark.parametrize("make", [WrappingRow, lambda: WrappingRow(first_grows=True), ButtonGrid])
def test_buttons_stand_within_the_margins_and_below_each_other_where_there_is_no_room(qtbot, make, width, margins):
    page, layout = QWidget(), make()
    qtbot.addWidget(page)
    page.setLayout(layout)
    layout.setContentsMargins(*margins)
    buttons = [QPushButton(f"Button {number}") for number in range(5)]
    for button in buttons:
        layout.addWidget(button)
    page.resize(width, layout.heightForWidth(width))
    page.show()
    left, top, right, bottom = margins
    places = [button.geometry() for button in buttons]
    assert min(place.left() for place in places) == left
    assert min(place.top() for place in places) == top
    assert max(place.right() for place in places) < width - right
    assert max(place.bottom() for place in places) + 1 == page.height() - bottom
    assert not any(a.intersects(b) for n, a in enumerate(places) for b in places[:n])


def test_what_a_row_wants_and_needs_has_its_margins(qtbot):
    sizes = []
    for margins in ((0, 0, 0, 0), MARGINS):
        layout = WrappingRow()
        page = QWidget()
        qtbot.addWidget(page)
        page.setLayout(layout)
        layout.setContentsMargins(*margins)
        layout.addWidget(QPushButton("Button"))
        sizes.append((layout.sizeHint(), layout.minimumSize()))
    for bare, framed in zip(*sizes, strict=True):
        assert framed.width() - bare.width() == MARGINS[0] + MARGINS[2]
        assert framed.height() - bare.height() == MARGINS[1] + MARGINS[3]
