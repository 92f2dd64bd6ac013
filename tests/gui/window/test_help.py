"""Help in the window: "?" beside terms, the manual with links and pictures, and a tour that can be left."""

import pytest
from PySide6.QtCore import Qt, QUrl
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWhatsThis

from groundstation.services.settings import read_settings, settings_path
from tests.gui.driving import close_controller, press_in, turn_until


@pytest.fixture
def window(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shown_tab() == "start")
    yield controller.window
    close_controller(controller)


def test_a_click_on_a_term_says_what_it_means_and_leads_to_the_manual(application, window):
    from groundstation.gui.widgets.terms import TermLabel

    window.show_tab("plan")
    application.processEvents()
    (label,) = (
        each for each in window.findChildren(TermLabel) if each.isVisible() and each.text() == "Safety distance"
    )
    QTest.mouseClick(label, Qt.MouseButton.LeftButton)
    shown = [each for each in QApplication.topLevelWidgets() if each.inherits("QWhatsThat") and each.isVisible()]
    assert len(shown) == 1
    assert "Nothing of the flight comes nearer" in label.whatsThis()
    assert label.buddy().whatsThis() == label.whatsThis(), "Shift+F1 in the field says the same"
    QWhatsThis.hideText()
    from PySide6.QtGui import QWhatsThisClickedEvent

    QApplication.sendEvent(label, QWhatsThisClickedEvent("guide/plan.md"))
    assert window._manual.page.name == "guide/plan.md"
    assert window._manual.isVisible()
    assert "The Plan tab" in window._manual.page.toPlainText()
    window._manual.close()


@pytest.mark.long
def test_the_manual_follows_links_goes_back_searches_and_shows_pictures(application, window):
    press_in(window, "Manual")
    manual = window._manual
    assert manual.page.name == "start.md"
    picture = manual.page.loadResource(2, QUrl("pictures/window.png"))
    assert 200 <= picture.width() <= manual.page.viewport().width()
    assert manual.page.loadResource(2, QUrl("https://example.org/picture.png")) is None
    manual.page.anchorClicked.emit(QUrl("guide/window.md#keyboard-and-mouse"))
    assert manual.page.name == "guide/window.md"
    assert manual.page.textCursor().block().text() == "Keyboard and mouse"
    manual.page.anchorClicked.emit(QUrl("plan.md"))
    assert manual.page.name == "guide/plan.md"
    manual.back.click()
    manual.back.click()
    assert manual.page.name == "start.md"
    assert not manual.back.isEnabled()
    QTest.keyClicks(manual.search, "mission tab")
    first = manual.tree.topLevelItem(0)
    assert first.text(0) == "The Mission tab"
    manual.tree.setCurrentItem(first)
    assert manual.page.name == "guide/mission.md"
    manual.open_page("glossary")
    assert "Ground sampling distance" in manual.page.toPlainText()
    manual.open_page("guide/no-such-page.md")
    assert "no-such-page.md" in manual.page.toPlainText()
    manual.close()


@pytest.mark.long
def test_the_tour_is_offered_once_goes_through_the_window_and_can_be_left(application, window):
    from groundstation.gui.window.help import Tour

    press_in(window, "Take the tour")
    tour = window.findChild(Tour)
    seen = []
    while tour.isVisible() and tour.next.text() == "Next":
        seen.append(tour.text())
        assert window.rect().contains(tour.geometry())
        press_in(window, "Next")
        application.processEvents()
    assert len(seen) >= 4
    assert len(set(seen)) == len(seen)
    press_in(window, "Finish")
    assert tour.isHidden()
    assert read_settings(settings_path()).has_seen_tour
    window.show_tab("start")
    assert not window.tab("start")._tour.isVisible()
    press_in(window, "Tour of the window")
    again = next(each for each in window.findChildren(Tour) if each.isVisible())
    application.processEvents()
    QTest.keyClick(again.next, Qt.Key.Key_Escape)
    assert again.isHidden()
