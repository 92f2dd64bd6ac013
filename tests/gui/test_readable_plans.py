"""Plans of many views in the 3-D view: what is looked at in full and the rest faint, layers, a flight on screen."""

import numpy as np
import pytest
from PySide6.QtTest import QTest

from groundstation.services.project.document import Item, ItemKind
from planning.coverage.sections import NOT_SEEN, SectionGrid, panel_frames, sections_seen
from planning.plan import viewpoint_arrays
from planning.site.records import panel_corners
from tests.missions.plans import make_plan, ring
from tests.planning.plan_cases import kiosk

SIZE = (900, 600)


@pytest.fixture(scope="module")
def plan():
    return make_plan([(ring(40), {}), (ring(40, 32.0, 40), {})])


@pytest.fixture
def view(application, plan):
    from groundstation.gui.view3d.scene_view import SceneView

    view = SceneView()
    view.canvas().smooths_at_rest = False
    view.resize(*SIZE)
    view.show()
    QTest.qWaitForWindowExposed(view)
    view.set_site(kiosk())
    view.set_plan(plan)
    view.look_at_all()
    yield view
    view.close_view()
    view.deleteLater()
    application.processEvents()


def strengths(view):
    """How strongly each sortie is drawn."""
    from groundstation.gui.view3d.drawables import Layer

    found = []
    for number in range(2):
        parts = view.canvas()._drawn[Layer.ROUTES, number]
        found.append(parts[0].actor.GetProperty().GetOpacity())
    return found


def n_pyramids(view):
    from groundstation.gui.view3d.drawables import Layer

    parts = view.canvas()._drawn.get(Layer.FRUSTA, [])
    return sum(len(part.drawable.cells) // 8 for part in parts)


def test_only_the_selected_sortie_is_drawn_in_full_with_its_pyramids(view):
    from groundstation.gui.view3d.scene_picture import FADED

    assert (strengths(view), n_pyramids(view)) == ([1.0, 1.0], 0)
    view.set_selection([Item(ItemKind.SORTIE, "2")])
    assert (strengths(view), n_pyramids(view)) == ([FADED, 1.0], 40)
    view.set_selection([Item(ItemKind.LEG, "1/3")])
    assert (strengths(view), n_pyramids(view)) == ([1.0, FADED], 0)
    view.set_selection([Item(ItemKind.SORTIE, "9"), Item(ItemKind.BUILDING)])
    view.set_selection([])
    assert (strengths(view), n_pyramids(view)) == ([1.0, 1.0], 0)


def test_views_of_the_panel_that_is_pointed_at_are_drawn_in_full(view, plan):
    from groundstation.gui.view3d.scene_picture import FADED

    panel = kiosk().site.panels[0]
    frames = panel_frames(panel_corners(kiosk().site))
    rules = plan.constraints
    seen = sections_seen(
        viewpoint_arrays(plan.viewpoints), frames, plan.camera, SectionGrid(rules.section_step_deg), rules.whole_panel
    )
    expected = np.flatnonzero(seen[:, 0] != NOT_SEEN)
    assert 0 < len(expected) < 80
    assert view.views_of_panel(panel.id).tolist() == expected.tolist()
    view.set_hover(Item(ItemKind.PANEL, panel.id))
    assert (strengths(view), n_pyramids(view)) == ([FADED, FADED], len(expected))
    view.set_hover(None)
    assert (strengths(view), n_pyramids(view)) == ([1.0, 1.0], 0)
    assert view.views_of_panel("nowhere").tolist() == []


def test_sorties_are_layers_that_are_hidden_faint_and_not_picked(view, plan):
    rows = view.layer_panel()
    view._layers_button.click()
    keys = [row.key for row in rows.list.value()]
    assert keys[:5] == ["1", "2", "routes", "viewpoints", "frusta"]
    rows.list.boxes("2")[1].setValue(50)
    assert strengths(view) == [1.0, 0.5]
    position = np.array(plan.viewpoints[45].position_enu_m)
    pixel = view._navigator.pinhole().project(position[None])[0][0]
    assert view.pick_at(*pixel).item.kind in (ItemKind.VIEWPOINT, ItemKind.LEG)
    for key in ("1", "2"):
        rows.list.boxes(key)[0].click()
    hit = view.pick_at(*pixel)
    assert hit is None or hit.item.kind not in (ItemKind.VIEWPOINT, ItemKind.LEG)
    rows.list.boxes("frusta")[0].click()
    assert n_pyramids(view) == 0
    rows.list.boxes("1")[0].click()
    assert n_pyramids(view) == 40
    view.set_plan(plan)
    assert view.sortie_state(2) == (True, 1.0)
    view.set_plan(None)
    assert "1" not in [row.key for row in rows.list.value()]


def test_layers_of_the_site_are_faint_and_the_list_stays_in_the_view(view):
    from groundstation.gui.view3d.drawables import Layer

    view._layers_button.click()
    panel = view.layer_panel()
    panel.list.boxes("building")[1].setValue(30)
    (part, *_) = view.canvas()._drawn[Layer.BUILDING]
    assert part.actor.GetProperty().GetOpacity() == pytest.approx(0.3)
    view.set_site(kiosk())
    (part, *_) = view.canvas()._drawn[Layer.BUILDING]
    assert part.actor.GetProperty().GetOpacity() == pytest.approx(0.3)
    assert view.rect().contains(panel.geometry())
    view.resize(500, 300)
    assert view.rect().contains(panel.geometry())


def test_what_is_pointed_at_is_told_with_its_place_in_the_plan(view, plan):
    assert view._tip_of(Item(ItemKind.VIEWPOINT, plan.viewpoints[45].id)).endswith("photo 6 of 40 of sortie 2")
    panel = kiosk().site.panels[0].id
    assert f"in {len(view.views_of_panel(panel))} views" in view._tip_of(Item(ItemKind.PANEL, panel))
    view.set_plan(None)
    assert view._tip_of(Item(ItemKind.PANEL, panel)) == f"Panel {panel}"


def test_shadows_lie_on_the_ground_within_the_site_away_from_the_sun(application):
    from groundstation.gui.view3d.drawables import shadow
    from groundstation.gui.view3d.paint import SUN
    from planning.geo.mesh import box_mesh

    mesh = box_mesh(np.array([0.0, 0.0, 0.0]), np.array([10.0, 10.0, 20.0]))
    points, cells = shadow(mesh, SUN, 0.0, np.array([-50.0, -50.0]), np.array([50.0, 50.0]))
    assert (points[:, 2] == 0.0).all()
    assert cells.shape == mesh.triangles.shape
    reach = 20.0 * np.linalg.norm(SUN[:2]) / SUN[2]
    tip = points[:, :2] - mesh.vertices_enu_m[:, :2]
    assert np.linalg.norm(tip, axis=1).max() == pytest.approx(reach)
    assert (tip @ SUN[:2] <= 1e-12).all()
    clipped, _ = shadow(mesh, SUN, 0.0, np.array([0.0, 0.0]), np.array([10.0, 12.0]))
    assert clipped[:, 1].max() == 12.0


@pytest.fixture
def player(application):
    from groundstation.gui.camera_preview.plan_player import PlanPlayer

    player = PlanPlayer()
    yield player
    player.deleteLater()


def test_the_slider_flies_all_sorties_as_they_are_timed(player, plan):
    from groundstation.gui.camera_preview.flight import camera_flight

    player.set_plan(plan)
    heard = []
    player.poseChanged.connect(heard.append)
    flights = [camera_flight(plan, sortie) for sortie in plan.sorties]
    player.setValue(0.0)
    assert player.duration_s == pytest.approx(sum(flight.duration_s for flight in flights))
    for number, share in ((0, 0.3), (1, 0.6)):
        t_s = share * flights[number].duration_s
        player.slider.setValue(round(10 * (t_s + (flights[0].duration_s if number else 0.0))))
        expected = flights[number].pose_at(player.value() - (flights[0].duration_s if number else 0.0))
        assert heard[-1].sortie == number
        np.testing.assert_allclose(heard[-1].position_enu_m, expected.position_enu_m, atol=1e-9)
        assert player.text().startswith(f"Sortie {number + 1}: ")
    player.setValue(1e9)
    assert player.value() == player.duration_s
    assert heard[-1].sortie == 1
    player.stop.click()
    assert (heard[-1], player.value(), player.text()) == (None, 0.0, "")


def test_playing_goes_on_by_the_clock_and_ends(player, plan, monkeypatch):
    from groundstation.gui.camera_preview import plan_player

    now = [100.0]
    monkeypatch.setattr(plan_player.time, "monotonic", lambda: now[0])
    player.set_plan(plan)
    player.play.click()
    now[0] += 0.5
    player._tick()
    assert player.value() == pytest.approx(10.0)
    now[0] += 1e6
    player._tick()
    assert player.value() == player.duration_s
    assert not player.play.isChecked()
    player.play.click()
    assert player.play.isChecked()
    player._tick()
    assert player.value() < 1.0
    player.set_plan(None)
    assert (player.duration_s, player.pose(), player.play.isChecked()) == (0.0, None, False)


def test_the_flown_sortie_is_drawn_in_full(view, player, plan):
    from groundstation.gui.view3d.scene_picture import FADED

    player.poseChanged.connect(view.set_flown)
    player.set_plan(plan)
    player.setValue(0.9 * player.duration_s)
    assert strengths(view) == [FADED, 1.0]
    assert "flown" in view.canvas()._drawn
    player.rewind()
    assert strengths(view) == [1.0, 1.0]
    assert "flown" not in view.canvas()._drawn
