"""Scenes of objects as the window knows them."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.model.facility_records import book_of_scene, object_rows, update_objects
from groundstation.services.model.scene_card import PanelRow, is_model, is_scene, read_card, scenes_beside, view_of
from planning.base.errors import InputError
from reconstruction.objects.gs_scene import GsElement
from reconstruction.objects.store import StoredScene, usual_look, write_scene
from reconstruction.records.entries import global_id_of
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


@pytest.fixture
def folder(tmp_path):
    write_scene(synthetic_scene(), tmp_path / "one.gsscene")
    return tmp_path / "one.gsscene"


def element(corners):
    return PanelRow(GsElement(global_id_of("x", "y"), "y", 0, corners, 0, 0), "A", global_id_of("x", "A"))


def turned(corners, turn):
    return tuple(tuple(map(float, turn @ np.array(corner))) for corner in corners)


SQUARE = ((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 0.0, 3.0), (0.0, 0.0, 3.0))


def test_a_card_has_all_panels_with_their_facades(folder):
    card = read_card(folder)
    scene = synthetic_scene()
    assert [(panel.name, panel.facade) for panel in card.panels] == [
        (element.name, component.name) for component, element in scene.elements
    ]
    assert card.by_number[1] is card.by_global_id[card.panels[1].global_id] is card.panels[1]
    assert card.panels[0].size_m == pytest.approx((1.35, 1.8))
    assert (is_scene(folder), is_model(folder)) == (True, False)
    assert (card.n_gaussians, card.name, card.origin) == (scene.n_gaussians, scene.name, scene.origin)


def test_the_first_view_is_square_before_the_largest_facade_and_shows_all_of_it(tmp_path):
    scene = synthetic_scene()
    corners = np.array([element.corners_enu_m for element in scene.components[0].elements])
    middle = 0.5 * (corners.reshape(-1, 3).min(axis=0) + corners.reshape(-1, 3).max(axis=0))
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    along = np.cross(normal, (0.0, 0.0, 1.0))
    found = []
    # Photos before it were taken from 3.4 m, aside as most are, or nearer than any view begins, or not at all.
    for number, distance_m in enumerate((3.4, 2.1, None)):
        places = [] if distance_m is None else [(middle + distance_m * normal + 2.0 * along).tolist()]
        places += [(middle - 30.0 * normal).tolist(), (middle + 0.5 * normal).tolist()]
        folder = tmp_path / f"{number}.gsscene"
        write_scene(replace(scene, training={**scene.training, "places_enu_m": places}), folder)
        first = read_card(folder).first_view
        inside = (corners.reshape(-1, 3) - first.pose.position_enu_m) @ first.pose.cam_from_enu.T
        lens = first.intrinsics
        assert first.pose.cam_from_enu[2] == pytest.approx(-normal)
        assert (inside[:, 2] > 0.0).all()
        assert (np.abs(lens.fx_px * inside[:, 0] / inside[:, 2]) < lens.width_px / 2).all()
        assert (np.abs(lens.fy_px * inside[:, 1] / inside[:, 2]) < lens.height_px / 2).all()
        found.append(float((first.pose.position_enu_m - middle) @ normal))
    assert found[0] == pytest.approx(3.4)
    assert found[1] < found[0] < found[2]


def test_the_first_view_of_a_model_without_panels_is_a_photo_s_in_the_midst_of_the_others(tmp_path):
    scene = synthetic_scene()
    places = [[90.0, 0.0, 3.0], [10.0, -20.0, 3.0], [12.0, -21.0, 4.0]]
    looks = {"places_enu_m": places, "forwards_enu": [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8]]}
    bare = tuple(replace(part, elements=(), kind="background") for part in scene.components)
    bare = replace(scene, components=bare, training={**scene.training, **looks})
    write_scene(bare, tmp_path / "bare.gsscene")
    first = read_card(tmp_path / "bare.gsscene").first_view
    assert first.pose.position_enu_m.tolist() == places[2]
    assert first.pose.forward_enu == pytest.approx((0.6, 0.0, -0.8))
    assert first.pose.angles_deg[2] == pytest.approx(0.0, abs=1e-9)
    assert usual_look({"places_enu_m": places}) is None


def test_records_are_of_a_panel_its_facade_or_the_building(folder, tmp_path):
    card, scene = read_card(folder), synthetic_scene()
    second = scene.components[1]
    panel = second.elements[0].global_id
    subjects = [card.subject(level, panel) for level in ("panel", "facade", "building")]
    assert [(each.global_id, each.name) for each in subjects] == [
        (panel, "B-0000"),
        (second.global_id, "B"),
        (scene.global_id, "made"),
    ]
    assert [each.panel for each in subjects] == [card.by_global_id[panel], None, None]
    assert {each.global_id for each in subjects} <= {row.global_id for row in object_rows(StoredScene(folder))}
    # Where nothing is chosen, only the building is known, and a facade that there is no other of.
    assert card.subject("panel", "") is card.subject("facade", "") is None
    assert card.subject("building", "").global_id == scene.global_id
    write_scene(synthetic_scene(((3, 1),)), tmp_path / "alone.gsscene")
    assert read_card(tmp_path / "alone.gsscene").subject("facade", "").name == "A"


def test_a_folder_without_a_scene_is_refused(tmp_path):
    with pytest.raises(InputError, match="no scene of objects"):
        read_card(tmp_path)


def test_scenes_beside_are_found_and_damaged_ones_left_out(folder, tmp_path):
    assert scenes_beside(folder) == ()
    write_scene(synthetic_scene(seed=1), tmp_path / "two.gsscene")
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "gsscene.json").write_text("{")
    assert [path.name for path in scenes_beside(folder)] == ["two.gsscene"]


@pytest.mark.parametrize(
    "turn",
    [
        np.eye(3),
        np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    ],
)
def test_a_panel_is_seen_whole_and_straight_from_its_front(turn):
    panel = element(turned(SQUARE, turn))
    camera = view_of((panel,))
    corners = np.array(panel.element.corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    assert camera.pose.forward_enu @ normal < 0.0
    np.testing.assert_allclose(np.linalg.det(camera.pose.cam_from_enu), 1.0)
    inside = camera.pose.points_cam(corners)
    lens = camera.intrinsics
    x = lens.cx_px + lens.fx_px * inside[:, 0] / inside[:, 2]
    y = lens.cy_px + lens.fy_px * inside[:, 1] / inside[:, 2]
    assert (inside[:, 2] > 0).all()
    assert ((x >= 0) & (x <= lens.width_px) & (y >= 0) & (y <= lens.height_px)).all()
    np.testing.assert_allclose(inside[:, 2], inside[0, 2])


def test_panels_all_around_and_none_at_all_have_a_view():
    back = element(SQUARE[::-1])
    around = view_of((element(SQUARE), back))
    assert np.isfinite(around.pose.position_enu_m).all()
    assert np.isfinite(view_of(()).pose.cam_from_enu).all()


def test_records_know_the_objects_of_the_scene_they_lie_beside(folder):
    rows = object_rows(StoredScene(folder))
    assert [row.layer for row in rows].count("element") == len(read_card(folder).panels)
    with book_of_scene(folder, "test") as book:
        assert {row.global_id for row in book.objects()} == {row.global_id for row in rows}
        assert book.origin == read_card(folder).origin
    gone = read_card(folder).panels[-1].global_id
    write_scene(synthetic_scene(((3, 0, 5), ())), folder)
    update_objects(folder, "test")
    with book_of_scene(folder, "test") as book:
        assert not book.is_present(gone)
        assert gone in {row.global_id for row in book.objects(with_absent=True)}
