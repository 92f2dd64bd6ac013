"""Tabs that are made by and by: a part in each turn, the rest at once for whoever wants it now."""

from collections.abc import Iterator

from PySide6.QtCore import QObject

from groundstation.gui.application.gradual import GradualTab


class Counted(GradualTab):
    """Three parts."""

    def __init__(self, parent: QObject, *, at_once: bool = True) -> None:
        self.made: list[int] = []
        super().__init__(parent, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        for number in range(3):
            self.made.append(number)
            yield


def test_a_part_a_turn_and_the_rest_where_it_is_wanted(application):
    parent = QObject()
    assert Counted(parent).made == [0, 1, 2]
    tab = Counted(parent, at_once=False)
    assert tab.made == []
    assert tab.go_on()
    assert tab.made == [0]
    tab.finish()
    assert tab.made == [0, 1, 2]
    assert not tab.go_on()
    tab.finish()
    assert tab.made == [0, 1, 2]
