"""The sun on the Plan tab, chosen and clicked as a pilot does."""

from datetime import date, timedelta

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QScrollArea

from groundstation.gui.charts.sun_chart import LEAST_LINE_PX, SunChart
from groundstation.gui.plan.sun_panel import SunPanel
from groundstation.services.mission.sunlight import Look, SunRequest, day_rows, hour_marks, sun_report, zone_of_offset
from groundstation.services.project.document import Document, PlanEntry
from tests.gui.driving import click_on, turn_until_idle
from tests.gui.window.test_main_window import controller
from tests.planning.insight.sun_cases import aimed, wall
from tests.planning.insight.test_sun_times import hovering

__all__ = ["controller"]

WINTER = date(2026, 12, 21)


@pytest.fixture(scope="module")
def flight():
    """A site and a plan of one photo, which shows the sun in glass at noon in winter."""
    model = wall(heading_deg=180.0)
    view = aimed("v0", (0.0, -19.0, 4.0), (0.0, 1.0, 0.335))
    return model, hovering(model, view.position_enu_m, (view,))


def report_of(flight, day=WINTER):
    model, plan = flight
    return sun_report(model, plan, SunRequest(day, zone_of_offset(0.0)))


def look_at(rows, share):
    """What the last stretch of a row shows at a part of the day."""
    return [stretch.look for stretch in rows.stretches if stretch.first <= share <= stretch.last][-1]


def test_rows_show_night_sun_and_what_take_offs_spoil(flight):
    sky, facade, sortie = day_rows(report_of(flight))
    assert [row.name for row in (sky, facade, sortie)] == ["sun", "facade 'A'", "sortie 1"]
    assert [look_at(sky, share) for share in (0.1, 0.5, 0.9)] == [Look.NIGHT, Look.SKY, Look.NIGHT]
    assert look_at(facade, 0.5) is Look.SUN
    assert look_at(sortie, 0.4985) is Look.BAD
    assert look_at(sortie, 0.6) is Look.GOOD
    for row in (sky, facade, sortie):
        assert all(0.0 <= stretch.first < stretch.last <= 1.0 for stretch in row.stretches)


def test_a_click_into_the_bar_says_what_a_take_off_there_spoils(application, flight):
    panel = SunPanel()
    panel.resize(900, 300)
    panel.show()
    panel.set_report(report_of(flight))
    application.processEvents()
    place = panel.chart.place_of(0.4985, 2)
    click_on(panel, panel.chart, QPoint(round(place.x()), round(place.y())))
    assert panel.chart.mark() == pytest.approx(0.4985, abs=0.003)
    assert "elevation 18." in panel.text()
    assert "facade 'A': in the sun\n" in panel.text()
    assert "sortie 1: with take-off then, the sun or its mirror image is in 1 of 1 photos" in panel.text()
    night = panel.chart.place_of(0.01, 2)
    click_on(panel, panel.chart, QPoint(round(night.x()), round(night.y())))
    assert "sun at heading" in panel.text()
    assert "with take-off then" not in panel.text()
    panel.set_report(None)
    assert panel.chart.rows() == ()
    QTest.mouseClick(panel.chart, Qt.MouseButton.LeftButton)
    panel.close()


def test_what_is_drawn_where_is_what_the_rows_say(application, flight):
    chart = SunChart()
    chart.resize(400, 200)
    report = report_of(flight)
    chart.set_rows(day_rows(report), hour_marks(report.day.track))
    chart.show()
    picture = chart.grab().toImage()
    colours = {
        name: picture.pixelColor(chart.place_of(share, row).toPoint()).name()
        for name, share, row in (("night", 0.1, 0), ("day", 0.52, 0), ("sun", 0.52, 1), ("bad", 0.4985, 2))
    }
    assert len({colours[name] for name in ("night", "day", "sun")}) == 3
    assert colours["bad"] == picture.pixelColor(2, 2).name(), "many spoiled photos are a low bar"
    chart.close()


def test_all_rows_have_room_in_the_list_of_a_small_screen_or_scroll_under_hours_that_stay(application, flight, letters):
    report = report_of(flight)
    sky, facade, sortie = day_rows(report)
    panel = SunPanel()
    panel.resize(974, 150)
    panel.show()
    panel.set_report(report)
    chart = panel.chart
    chart.set_rows((sky, facade, facade, sortie), hour_marks(report.day.track))
    area = panel.findChild(QScrollArea)
    application.processEvents()
    assert chart.height() <= area.viewport().height(), "nothing scrolls"
    assert chart.place_of(0.0, 3).y() < chart.hours_top_px() < chart.height() - chart.line_px()
    chart.set_rows((sky, *[facade] * 20, sortie), hour_marks(report.day.track))
    application.processEvents()
    bar = area.verticalScrollBar()
    assert chart.line_px() < LEAST_LINE_PX + 1.0
    assert bar.maximum() > 0
    hours = []
    for place in (0, bar.maximum() // 2, bar.maximum()):
        bar.setValue(place)
        application.processEvents()
        seen = area.viewport().grab().toImage()
        hours.append(seen.copy(0, seen.height() - round(chart.line_px()), seen.width(), round(chart.line_px()) - 6))
    assert hours[0] == hours[1] == hours[2]
    assert len({hours[0].pixel(x, hours[0].height() // 2) for x in range(hours[0].width())}) > 5, "letters are there"
    assert chart.place_of(0.0, 21).y() < chart.hours_top_px(), "the last row can be scrolled to"
    panel.close()


@pytest.mark.slow
def test_the_tab_looks_at_the_chosen_day_once_somebody_does(application, controller, flight):
    names = []
    controller.context.jobsChanged.connect(lambda: names.extend(job.name for job in controller.context.jobs()))
    model, plan = flight
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    page = controller.window.tab("plan")
    assert "Look at the sun" not in names
    bar = page.lists.tabBar()
    (index,) = (n for n in range(bar.count()) if bar.tabText(n) == "Sun")
    click_on(controller.window, bar, bar.tabRect(index).center())
    turn_until_idle(application, controller)
    assert "Look at the sun" in names
    assert "sun over 'wall' on" in page.sun.text()
    page.sun.day.setFocus()
    page.sun.day.selectAll()
    QTest.keyClicks(page.sun.day, "2026-12-21")
    QTest.keyClick(page.sun.day, Qt.Key.Key_Return)
    turn_until_idle(application, controller)
    assert page.sun.value() == WINTER
    assert "on 2026-12-21" in page.sun.text()
    assert "sortie 1: take off at" in page.sun.text()
    click_on(controller.window, page.sun.after)
    turn_until_idle(application, controller)
    assert page.sun.value() == WINTER + timedelta(days=1)
    assert "on 2026-12-22" in page.sun.text()
    proposed = page.sun.choose.text().removeprefix("Plan take-off for ")
    assert f"sortie 1: take off at {proposed} " in page.sun.text()
    click_on(controller.window, page.sun.choose)
    day = controller.window.tab("mission").findings.day_box().value()
    assert f"{day.at:%Y-%m-%d %H:%M}" == f"2026-12-22 {proposed}"
    assert day == controller.window.tab("mission").controller.day
    assert f"Take-off planned for 2026-12-22 {proposed}" in "".join(controller.window.messages.texts())
    other = wall(heading_deg=0.0)
    controller.context.session.open(Document(other), None)
    turn_until_idle(application, controller)
    assert "sortie" not in page.sun.text()
    assert "sun in panes of facade A: off" in page.sun.text()
