"""The list of layers: what it shows, what the user edits in it, and that widgets under the hand stay."""

import pytest
from PySide6.QtWidgets import QToolButton


@pytest.fixture
def layers(application):
    from groundstation.gui.widgets.layer_list import LayerList, LayerRow

    found = LayerList()
    found.setValue([LayerRow("a", "Plan"), LayerRow("b", "yard.kml", False, 0.4, "#ff0000", can_remove=True)])
    found.show()
    yield found
    found.close()


def test_layers_are_shown_as_they_are(layers):
    box, slider = layers.boxes("b")
    assert (box.text(), box.isChecked(), slider.value(), slider.isEnabled()) == ("yard.kml", False, 40, False)
    box, slider = layers.boxes("a")
    assert (box.isChecked(), slider.value(), slider.isEnabled()) == (True, 100, True)


def test_edits_are_told_and_kept(layers):
    heard = []
    layers.changed.connect(lambda *change: heard.append(change))
    box, slider = layers.boxes("b")
    box.click()
    assert slider.isEnabled()
    slider.setValue(70)
    layers.boxes("a")[0].click()
    assert heard == [("b", True, 0.4), ("b", True, 0.7), ("a", False, 1.0)]
    assert [(row.is_visible, row.opacity) for row in layers.value()] == [(False, 1.0), (True, 0.7)]


def test_showing_values_tells_nothing_and_keeps_the_widgets(layers):
    from dataclasses import replace

    heard = []
    layers.changed.connect(lambda *change: heard.append(change))
    before = layers.boxes("a")
    layers.setValue([replace(row, opacity=0.5, is_visible=True) for row in layers.value()])
    assert heard == []
    assert layers.boxes("a") == before
    assert before[1].value() == 50
    layers.setValue(layers.value()[1:])
    assert [row.key for row in layers.value()] == ["b"]


def test_only_what_can_go_has_a_button_that_removes_it(layers):
    heard = []
    layers.removed.connect(heard.append)
    (button,) = [button for button in layers.findChildren(QToolButton) if button.text() == "×"]
    button.click()
    assert heard == ["b"]
