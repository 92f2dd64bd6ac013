"""Coverage in the Photos tab: panels painted in 3-D, the photos of one panel, and known panels drawn into photos."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from planning.site.file import site_sha256
from tests.gui.driving import turn_until
from tests.services import project_cases

PANEL = Item(ItemKind.PANEL, "X-1")


@pytest.fixture
def in_3d(page):
    page.tab.pane.coverage.click()
    page.idle()
    yield page
    page.tab.pane.photo.click()
    page.controller.context.select(None)


def scene(page):
    return page.tab.pane.scene.scene()


@pytest.mark.slow
def test_the_view_is_there_only_while_it_is_seen_and_looked_at_from_where_it_was(in_3d):
    assert scene(in_3d) is not None
    scene(in_3d).turn_by_hand(20.0, 5.0)
    before = scene(in_3d).orbit()
    in_3d.tab.pane.photo.click()
    assert scene(in_3d) is None
    in_3d.tab.pane.coverage.click()
    assert scene(in_3d).orbit() == before
    in_3d.controller.window.show_tab("site")
    assert scene(in_3d) is None
    shared = in_3d.controller.window.shared_view.scene()
    assert shared._panel_values is None
    in_3d.controller.window.show_tab("photos")
    assert scene(in_3d) is not None


def test_panels_have_the_colour_of_what_is_seen_of_them(in_3d):
    scale, values = scene(in_3d)._panel_values
    coverage = in_3d.tab.controller.coverage
    assert values.tolist() == coverage.seen_per_panel.tolist()
    assert values[0] > 0
    assert (scale.title, scale.unit, scale.high) == ("Sections that photos show", "", values.max())


@pytest.mark.slow
def test_with_a_plan_the_colour_tells_how_much_of_its_promise_was_kept(in_3d):
    context = in_3d.controller.context
    plan = project_cases.plan(2, x_m=-0.5)
    context.amend(context.document.with_plan(PlanEntry("plan-1", "Plan 1", plan)))
    in_3d.idle()
    scale, values = scene(in_3d)._panel_values
    assert (scale.title, scale.unit, scale.low, scale.high) == ("Seen of what the plan promised", "%", 0.0, 100.0)
    assert values == pytest.approx(100.0 * in_3d.tab.controller.coverage.kept_promise(), nan_ok=True)
    assert "the plan promised" in in_3d.tab.coverage.text()


def test_a_panel_that_is_clicked_tells_its_photos_and_a_photo_is_shown_by_a_click(in_3d):
    scene(in_3d).picked.emit(PANEL, Qt.KeyboardModifier.NoModifier)
    assert in_3d.controller.context.selection == PANEL
    sightings, coverage = in_3d.tab.sightings, in_3d.tab.controller.coverage
    assert in_3d.tab.details.currentWidget() is sightings
    assert "Panel X-1" in sightings.text()
    n_photos, n_missing = len(coverage.sightings(0)), len(coverage.missing(0))
    assert f"Photos that show it: {n_photos}" in sightings.text()
    assert f"Sections that no photo shows: {n_missing}" in sightings.text()
    assert sightings.photos.count() == n_photos > 0
    section = coverage.sightings(0)[0].section
    sightings.pick_section(section)
    assert sightings.photos.count() == len(coverage.sightings(0, section))
    row = sightings.photos.visualItemRect(sightings.photos.item(0)).center()
    QTest.mouseClick(sightings.photos.viewport(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, row)
    in_3d.idle()
    assert not in_3d.tab.pane.is_coverage_shown()
    assert in_3d.tab.pane.card().path == coverage.sightings(0, section)[0].photo.path


@pytest.mark.slow
def test_coverage_is_counted_again_for_panels_that_are_used_and_otherwise_once_the_tab_is_seen(found):
    found.tab.use.click()
    found.idle()
    assert found.controller.window.shown_tab() == "site"
    assert len(found.tab.controller.coverage.panel_ids) == 30
    assert "of 1080 sections" in found.tab.coverage.text()
    found.controller.context.session.undo()
    found.idle()
    assert found.tab.controller.coverage is None
    assert "counted again" in found.tab.coverage.text()
    found.controller.window.show_tab("photos")
    found.idle()
    assert found.tab.controller.coverage.panel_ids == ("X-1",)
    assert "of 36 sections" in found.tab.coverage.text()


@pytest.mark.slow
def test_a_site_that_loses_its_panels_says_so_and_paints_nothing(in_3d):
    context = in_3d.controller.context
    model = context.document.site
    site = replace(model.site, facades=())
    context.change("Remove", replace(context.document, site=replace(model, site=site, sha256=site_sha256(site))))
    in_3d.idle()
    assert in_3d.tab.controller.coverage is None
    assert "no panels yet" in in_3d.tab.coverage.text()
    assert scene(in_3d)._panel_values is None


@pytest.mark.slow
def test_without_photos_the_view_says_what_to_do(in_3d):
    in_3d.controller.context.session.open(Document(), None)
    assert "Open or import a site" in in_3d.tab.pane.scene._text.text()
    assert scene(in_3d) is not None


@pytest.mark.slow
def test_known_panels_are_drawn_into_photos_in_which_they_were_not_looked_for(found):
    found.tab.strip.choose(0)
    found.idle()
    assert found.view._outlines == ()
    assert "known panel, not looked for here" not in found.view.legend()
    # As if the facade had not been searched in the first photo.
    draft = found.draft
    grids = {key: grid for key, grid in draft.found.grids.items() if key[1] != 0}
    found.found(replace(draft, found=replace(draft.found, grids=grids)))
    found.tab.strip.choose(0)
    found.idle()
    assert len(found.view._outlines) == 30
    assert found.view.legend() == ("known panel, not looked for here",)
    picture = found.view.picture().levels[0]
    lower_edge = found.view.to_widget(QPointF(0.0, picture.height())).y()
    assert lower_edge <= found.view.room().bottom() + 0.5 < found.view.height()
    posed = found.tab.pane.card().posed
    corners = draft.facade("A").panels[0].corners_enu_m
    assert found.view._outlines[0] == pytest.approx(posed.pixels(corners))


@pytest.mark.slow
def test_before_a_search_the_panels_of_the_site_are_drawn(page):
    page.tab.strip.choose(0)
    page.idle()
    assert len(page.view._outlines) == 1
    middle = page.view._outlines[0].mean(axis=0)
    corners = np.array(page.controller.context.document.site.site.panels[0].corners_enu_m)
    assert middle == pytest.approx(page.tab.pane.card().posed.pixels(corners.mean(axis=0))[0], abs=2.0)


@pytest.mark.slow
def test_used_panels_tell_on_the_site_tab_how_good_they_are_and_undo_takes_that_back(found):
    found.tab.use.click()
    found.idle()
    context = found.controller.context
    panel = context.document.site.site.panels[4]
    known = context.document.found_facades.of(panel)
    context.select(Item(ItemKind.PANEL, panel.id))
    text = found.controller.window.tab("site").right.findChild(_panel_page()).text()
    assert f"corners ± {1000.0 * known.corner_sigma_m:.3g} mm" in text
    assert f"confidence {100.0 * known.confidence:.0f} %" in text
    context.session.undo()
    assert context.document.found_facades is None
    context.select(PANEL)
    assert "corners" not in found.controller.window.tab("site").right.findChild(_panel_page()).text()


@pytest.mark.slow
def test_a_view_that_is_open_when_the_window_is_made_anew_is_freed(application, in_3d):
    from groundstation.services.settings import Language

    in_3d.controller.choose(language=Language.GERMAN)
    turn_until(application, lambda: in_3d.controller.window.shared_view.scene() is not None)
    assert scene(in_3d) is None
    in_3d.controller.choose(language=Language.ENGLISH)
    turn_until(application, lambda: in_3d.controller.window.shared_view.scene() is not None)
    in_3d.controller.window.show_tab("photos")
    in_3d.tab = in_3d.controller.window.tab("photos")


def _panel_page():
    from groundstation.gui.site.pages import PanelPage

    return PanelPage
