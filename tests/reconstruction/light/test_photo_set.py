"""Data set folders as they are read: what is understood, what is refused, and which views are held out."""

import json
import shutil

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.light.photo_set import PanelPlanes, held_out_names, read_photo_set
from tests.reconstruction.light.synthetic_folder import LENS, corners_of, far, write_folder

NAMES = [f"p{number:03d}.jpg" for number in range(40)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder of three photos; tests must not change it."""
    made = tmp_path_factory.mktemp("set") / "photos"
    write_folder(made, far, 3, exposure=0.5)
    return made


@pytest.fixture
def own(folder, tmp_path):
    """A copy that may be damaged."""
    return shutil.copytree(folder, tmp_path / "own")


def test_cameras_panels_and_exposure_are_those_that_were_written(folder):
    found = read_photo_set(folder)
    assert [photo.name for photo in found.photos] == ["p00.png", "p01.png", "p02.png"]
    assert found.photos[0].intrinsics == LENS
    assert np.array_equal(found.panels.corners_enu_m, corners_of())
    assert found.exposure == 0.5
    assert found.picture(found.photos[0]).shape == (30, 40, 3)
    numbers = found.panel_numbers(found.photos[0])
    assert numbers.min() == -1
    assert numbers.max() <= 5


def test_a_folder_that_does_not_say_its_exposure_has_1(own):
    (own / "scene.json").unlink()
    assert read_photo_set(own).exposure == 1.0


def test_places_are_rescaled_by_one_cube_around_all_panels():
    planes = PanelPlanes(corners_of())
    assert planes.half_side_m == pytest.approx(2.95)
    scaled = planes.rescaled(planes.corners_enu_m)
    assert np.abs(scaled[..., 0]).max() == pytest.approx(1.0)
    assert np.abs(scaled).max() <= 1.0 + 1e-12
    assert np.allclose(planes.normals_enu, (0.0, -1.0, 0.0))


def edited(own, change):
    path = own / "dataset.json"
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.update(format="reflight-plan/1"), "reflight-dataset/1"),
        (lambda d: d["panels"][0].update(index=7), "indices"),
        (lambda d: d["panels"][0]["corners_enu_m"].pop(), "four corners"),
        (lambda d: d["panels"][1].update(corners_enu_m=[[0, 0, 0]] * 4), "panel 2 has next to no area"),
        (lambda d: d.pop("panels"), "panels"),
    ],
)
def test_descriptions_that_make_no_sense_are_refused_by_name(own, change, words):
    edited(own, change)
    with pytest.raises(InputError, match=words) as caught:
        read_photo_set(own)
    assert "dataset.json" in str(caught.value)


def test_a_folder_without_description_is_refused(tmp_path):
    with pytest.raises(InputError, match="prepare"):
        read_photo_set(tmp_path)


@pytest.mark.parametrize("exposure", [0.0, -1.0, "bright"])
def test_an_exposure_that_is_none_is_refused(own, exposure):
    for content in ({"exposure": exposure}, {"exposure": 1.0, "captures": {"p00.png": {"exposure": exposure}}}):
        (own / "scene.json").write_text(json.dumps(content))
        with pytest.raises(InputError, match="exposure"):
            read_photo_set(own)


def test_pictures_that_are_missing_damaged_or_of_another_size_are_refused_by_name(own):
    found = read_photo_set(own)
    one, two, three = found.photos
    one.path.unlink()
    two.path.write_bytes(two.path.read_bytes()[:20])
    cv2.imwrite(str(three.path), np.zeros((30, 41, 3), np.uint8))
    for photo, words in ((one, "cannot be read"), (two, "cannot be decoded"), (three, "40 x 30 pixels .* got 41 x 30")):
        with pytest.raises(InputError, match=words) as caught:
            found.picture(photo)
        assert photo.name in str(caught.value)


def test_panel_layers_of_another_run_are_refused(own):
    found = read_photo_set(own)
    path = own / "panels" / "p00.png.png"
    cv2.imwrite(str(path), np.full((30, 40), 7, np.uint16))
    with pytest.raises(InputError, match=r"panel 7, and dataset\.json 6"):
        found.panel_numbers(found.photos[0])
    cv2.imwrite(str(path), np.zeros((30, 40, 3), np.uint8))
    with pytest.raises(InputError, match="one channel"):
        found.panel_numbers(found.photos[0])


def test_held_out_views_are_so_many_and_follow_from_names_and_seed_alone():
    held = held_out_names(NAMES, 0.15, 3)
    assert len(held) == 6
    assert held == held_out_names(NAMES[::-1], 0.15, 3)
    assert held != held_out_names(NAMES, 0.15, 4)
    assert set(held) < set(NAMES)


def test_at_least_one_view_is_held_out_and_one_is_not():
    assert len(held_out_names(NAMES[:2], 0.01, 0)) == 1
    assert len(held_out_names(NAMES[:2], 0.99, 0)) == 1
    with pytest.raises(InputError, match="at least two"):
        held_out_names(NAMES[:1], 0.5, 0)
    for share in (0.0, 1.0):
        with pytest.raises(ValueError, match="share"):
            held_out_names(NAMES, share, 0)


def test_a_building_without_panels_is_a_set_for_plain_splats(own):
    edited(own, lambda description: description.update(panels=[]))
    panels = read_photo_set(own).panels
    assert panels.corners_enu_m.shape == (0, 4, 3)
    assert panels.half_side_m == 1.0
