"""A whole data set of synthetic photos: read back by other means, effects both ways, nothing left after a failure."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import open3d as o3d
import pytest
from numpy.typing import NDArray

from groundstation.services.reconstruct.training import _config_of_data_set
from planning.base.effects import decide
from planning.base.errors import InputError, OperationCancelled
from planning.base.progress import Monitor
from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh, join
from planning.geo.ray_casting import RayCaster
from planning.site.records import Airspace, Facade, Obstacle, Panel, Site, SiteModel
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.record import intrinsics_of
from reconstruction.dataset.layers import (
    Scene,
    draw_layers,
    draw_panels,
    normal_map,
    normals_from_16_bit,
    normals_to_16_bit,
    straightened,
)
from reconstruction.dataset.prepare import (
    HiddenPanels,
    LensDistortion,
    PanelsInPhotos,
    PrepareParameters,
    most_moved_px,
    prepare,
)
from reconstruction.dataset.refined_mesh import frame_width_m, grown_corners, refine_mesh
from reconstruction.light.photo_set import read_photo_set
from reconstruction.training.parameters import TrainRequest
from tests.planning.photos.photo_writer import exif_part, segment
from tests.reconstruction.dataset.test_panel_images import grid
from tests.reconstruction.panels.rectify.scenes import looking_at, surface_mesh
from tests.reconstruction.panels.rectify.test_surface import surface

Array = NDArray[np.float64]
FACE = surface(0.0, lean_rad=0.0)
LENS = Intrinsics(200, 150, 142.0, 142.0, 100.0, 75.0)
BENT = replace(LENS, distortion=(-0.11, 0.015, 0.0004, -0.0003, -0.02))
QUICK = PrepareParameters(n_points=500)


def site_model(obstacle: TriangleMesh | None = None) -> SiteModel:
    panels = tuple(
        Panel(f"A-{i:04d}", tuple(tuple(map(float, corner)) for corner in corners))  # type: ignore[arg-type]
        for i, corners in enumerate(grid())
    )
    airspace = Airspace((-80.0, -80.0, -5.0), (80.0, 80.0, 80.0), -5.0)
    site = Site("made", Origin(22.3, 114.2, 60.0), (Facade("A", panels),), airspace, (0.0, -40.0, 0.0))
    mesh = surface_mesh(FACE, (-7.0, -7.0), (7.0, 7.0), 0.4, 0.1)
    if obstacle is None:
        return SiteModel(site, mesh)
    return SiteModel(replace(site, obstacles=(Obstacle("kiosk", mesh="kiosk.ply"),)), mesh, (obstacle,))


def kiosk() -> TriangleMesh:
    middle = FACE.anchor_enu_m + 8.0 * FACE.normal_enu
    return box_mesh(middle - 1.0, middle + 1.0)


def photos_in(folder: Path, lens: Intrinsics = LENS, n: int = 3) -> list[PosedPhoto]:
    folder.mkdir(exist_ok=True)
    photos = []
    for number, aside in enumerate(np.linspace(-6.0, 6.0, n)):
        photo = looking_at(FACE, 16.0, float(aside), 2.0, lens)
        path = folder / f"DJI_{number:04d}.JPG"
        y, x = np.mgrid[: lens.height_px, : lens.width_px]
        picture = np.stack([x % 256, y % 256, np.full_like(x, 40 * number)], axis=-1).astype(np.uint8)
        path.write_bytes(cv2.imencode(".jpg", picture)[1].tobytes())
        photos.append(replace(photo, name=path.name, path=path))
    return photos


@pytest.mark.slow
def test_what_is_written_is_read_by_others_and_agrees(tmp_path: Path) -> None:
    photos = photos_in(tmp_path / "in")
    prepared = prepare(photos, site_model(), tmp_path / "out", QUICK)
    assert [photo.name for photo in prepared.photos] == [photo.name for photo in photos]
    model = read_model(tmp_path / "out" / "sparse" / "0")
    images = {image.name: image for image in model.images.values()}
    for photo in photos:
        image = images[photo.name]
        assert np.allclose(image.centre_world, photo.pose.position_enu_m)
        assert np.allclose(image.cam_from_world, photo.pose.cam_from_enu)
        assert intrinsics_of(model.cameras[image.camera_id]) == LENS
    nerfstudio = json.loads((tmp_path / "out" / "transforms.json").read_text())
    for frame, photo in zip(nerfstudio["frames"], photos, strict=True):
        world_from_cam = np.array(frame["transform_matrix"])
        seen = FACE.anchor_enu_m
        x, y, z = (np.linalg.inv(world_from_cam) @ [*seen, 1.0])[:3]
        pixel = frame["fl_x"] * x / -z + frame["cx"], frame["fl_y"] * -y / -z + frame["cy"]
        assert np.allclose(pixel, photo.pixels(seen[None])[0])
        assert (tmp_path / "out" / frame["file_path"]).is_file()
    cloud = o3d.io.read_point_cloud(str(tmp_path / "out" / "points.ply"))
    assert np.allclose(np.asarray(cloud.points), model.points.xyz, atol=1e-5)
    assert np.array_equal(np.round(np.asarray(cloud.colors) * 255.0), model.points.rgb)
    described = json.loads((tmp_path / "out" / "dataset.json").read_text())
    assert [panel["index"] for panel in described["panels"]] == list(range(1, 25))
    assert {effect["effect"] for effect in described["effects"]} == {"lens distortion", "hidden panels"}


def test_without_panels_it_is_a_data_set_for_plain_splats(tmp_path: Path) -> None:
    photos = photos_in(tmp_path / "in")
    model = site_model()
    bare = replace(model, site=replace(model.site, facades=(), building_mesh="made.ply"))
    known = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
    prepared = prepare(photos, bare, tmp_path / "out", QUICK, cloud=known)
    assert [photo.name for photo in prepared.photos] == [photo.name for photo in photos]
    name = f"{photos[0].name}.png"
    assert (cv2.imread(str(tmp_path / "out" / "masks" / name), cv2.IMREAD_UNCHANGED) == 255).all()
    assert not cv2.imread(str(tmp_path / "out" / "panels" / name), cv2.IMREAD_UNCHANGED).any()
    assert cv2.imread(str(tmp_path / "out" / "normals" / name), cv2.IMREAD_UNCHANGED).any()
    found = read_photo_set(tmp_path / "out")
    assert len(found.panels.corners_enu_m) == 0
    assert len(found.photos) == 3
    points = read_model(tmp_path / "out" / "sparse" / "0").points.xyz
    assert len(points) == 502
    np.testing.assert_allclose(points[:2], known)
    plain = _config_of_data_set(tmp_path / "out", TrainRequest("smoke"))
    assert not plain.trained_by.knows_panels
    with pytest.raises(InputError, match="has no panels, and reflight learns"):
        _config_of_data_set(tmp_path / "out", TrainRequest("smoke", "reflight"))


@pytest.mark.slow
def test_layers_show_panels_facade_and_flat_glass(tmp_path: Path) -> None:
    photo = photos_in(tmp_path / "in", n=1)[0]
    prepare([photo], site_model(), tmp_path / "out", PrepareParameters(normal_step=1, n_points=0))
    name = f"{photo.name}.png"
    panels = cv2.imread(str(tmp_path / "out" / "panels" / name), cv2.IMREAD_UNCHANGED)
    mask = cv2.imread(str(tmp_path / "out" / "masks" / name), cv2.IMREAD_UNCHANGED)
    normals = cv2.imread(str(tmp_path / "out" / "normals" / name), cv2.IMREAD_UNCHANGED)
    assert panels.dtype == np.uint16
    assert normals.dtype == np.uint16
    for number, corners in enumerate(grid(), 1):
        x, y = photo.pixels(corners.mean(axis=0)[None])[0]
        if 0 <= x < 200 and 0 <= y < 150:
            assert panels[int(y), int(x)] == number
    assert (mask[panels > 0] == 255).all()
    glass = normals_from_16_bit(normals[..., ::-1])[cv2.erode((panels > 0).astype(np.uint8), np.ones((3, 3))) > 0]
    assert np.abs(glass - FACE.normal_enu).max() < 1e-4
    frames = (mask == 255) & (panels == 0)
    assert 0.0 < frames.mean() < 0.2


@pytest.mark.slow
def test_distortion_is_taken_away_where_it_is_worth_it(tmp_path: Path) -> None:
    assert decide(LensDistortion(), photos_in(tmp_path / "bent", BENT)).on
    assert not decide(LensDistortion(), photos_in(tmp_path / "straight")).on
    barely = replace(LENS, distortion=(1e-4, 0.0, 0.0, 0.0, 0.0))
    assert not decide(LensDistortion(), photos_in(tmp_path / "barely", barely)).on
    assert most_moved_px(barely) < LensDistortion().tolerance < most_moved_px(BENT)
    photos = photos_in(tmp_path / "bent", BENT, 1)
    prepared = prepare(photos, site_model(), tmp_path / "out", QUICK)
    assert prepared.photos[0].intrinsics == LENS
    assert not (tmp_path / "out" / "images" / photos[0].name).samefile(photos[0].path)


def test_a_straightened_picture_shows_every_direction_where_the_straight_camera_has_it() -> None:
    photo = looking_at(FACE, 16.0, 0.0, 0.0, BENT)
    y, x = np.mgrid[:150, :200]
    pixels = np.column_stack([x.ravel() + 0.5, y.ravel() + 0.5])
    rays = BENT.rays(pixels)
    value = 127.0 + 100.0 * np.sin(8.0 * rays[:, 0]) * np.cos(8.0 * rays[:, 1])
    picture = np.repeat(value.reshape(150, 200, 1), 3, axis=2).round().astype(np.uint8)
    straight, found, valid = straightened(photo, picture)
    rays = straight.intrinsics.rays(pixels)
    wanted = (127.0 + 100.0 * np.sin(8.0 * rays[:, 0]) * np.cos(8.0 * rays[:, 1])).reshape(150, 200)
    assert np.abs(found[5:-5, 5:-5, 0] - wanted[5:-5, 5:-5]).max() < 2.5
    assert valid.all()
    right = np.ones((150, 200), bool)
    right[:, :100] = False
    _, _, valid = straightened(photo, picture, right)
    assert not valid[:, :100].any()
    assert valid[:, 104:].all()


@pytest.mark.long
def test_black_corners_of_a_straightened_picture_count_for_nothing(tmp_path: Path) -> None:
    cushion = replace(LENS, distortion=(0.12, 0.0, 0.0, 0.0, 0.0))
    prepared = prepare(photos_in(tmp_path / "in", cushion, 1), site_model(), tmp_path / "out", QUICK)
    (photo,) = read_photo_set(tmp_path / "out").photos
    assert prepared.photos[0].mask == photo.mask == tmp_path / "out" / "valid" / f"{photo.name}.png"
    valid = cv2.imread(str(photo.mask), cv2.IMREAD_UNCHANGED) > 0
    assert not valid[[0, 0, -1, -1], [0, -1, 0, -1]].any()
    assert valid[40:110, 40:160].all()
    for layer in ("panels", "masks"):
        assert not cv2.imread(str(tmp_path / "out" / layer / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)[~valid].any()


@pytest.mark.slow
def test_hidden_panels_are_taken_out_where_something_hides_them(tmp_path: Path) -> None:
    photos = photos_in(tmp_path / "in")
    for model, on in ((site_model(), False), (site_model(kiosk()), True)):
        caster = RayCaster(join([refine_mesh(model.building, grid()).mesh, *model.obstacles]))
        decision = decide(HiddenPanels(), PanelsInPhotos(photos, grid(), caster))
        assert decision.on == on
    with_kiosk = prepare(photos, site_model(kiosk()), tmp_path / "with", QUICK)
    without = prepare(photos, site_model(kiosk()), tmp_path / "without", replace(QUICK, hidden_panels="off"))
    assert with_kiosk.decisions[1].on
    assert not without.decisions[1].on
    shares = []
    for folder in ("with", "without"):
        index = cv2.imread(str(tmp_path / folder / "panels" / f"{photos[1].name}.png"), cv2.IMREAD_UNCHANGED)
        shares.append((index > 0).mean())
    assert shares[1] - shares[0] > HiddenPanels().tolerance
    plain_on = prepare(photos, site_model(), tmp_path / "on", replace(QUICK, hidden_panels="on"))
    plain_off = prepare(photos, site_model(), tmp_path / "off", replace(QUICK, hidden_panels="off"))
    for photo in plain_on.photos:
        one, other = (
            cv2.imread(str(prepared.folder / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
            for prepared in (plain_on, plain_off)
        )
        assert (one != other).mean() <= HiddenPanels().tolerance


@pytest.mark.slow
def test_broken_photos_are_reported_and_left_out(tmp_path: Path) -> None:
    photos = photos_in(tmp_path / "in")
    photos[0].path.write_bytes(b"not a picture")
    photos[1] = replace(photos[1], intrinsics=replace(LENS, width_px=201))
    prepared = prepare(photos, site_model(), tmp_path / "out", QUICK)
    assert [photo.name for photo in prepared.photos] == [photos[2].name]
    assert {finding.code for finding in prepared.findings} == {"photo-unreadable", "photo-size"}
    photos[2].path.unlink()
    with pytest.raises(InputError, match="none of the 3 photos"):
        prepare(photos, site_model(), tmp_path / "again", QUICK)
    assert not (tmp_path / "again").exists()


@pytest.mark.long
@pytest.mark.parametrize("orientation", [3, 6, 8])
def test_photos_marked_to_be_shown_turned_are_straightened_as_they_are_stored(tmp_path: Path, orientation: int) -> None:
    photos = photos_in(tmp_path / "in", BENT, 1)
    prepare(photos, site_model(), tmp_path / "plain", QUICK)
    content, mark = photos[0].path.read_bytes(), exif_part(image={0x0112: orientation})
    photos[0].path.write_bytes(content[:2] + segment(mark) + content[2:])
    prepared = prepare(photos, site_model(), tmp_path / "marked", QUICK)
    assert prepared.findings == ()
    one, other = (cv2.imread(str(tmp_path / name / "images" / photos[0].name)) for name in ("plain", "marked"))
    np.testing.assert_array_equal(one, other)


@pytest.mark.long
@pytest.mark.parametrize("lens", [LENS, BENT])
def test_a_camera_of_the_turned_picture_gets_the_turned_picture(tmp_path: Path, lens: Intrinsics) -> None:
    upright = replace(lens, width_px=150, height_px=200, cx_px=75.0, cy_px=100.0)
    photos = photos_in(tmp_path / "in", upright, 1)
    lying = np.rot90(cv2.imread(str(photos[0].path)))  # EXIF's 6 turns it back
    content = cv2.imencode(".jpg", np.ascontiguousarray(lying), [cv2.IMWRITE_JPEG_QUALITY, 100])[1].tobytes()
    photos[0].path.write_bytes(content[:2] + segment(exif_part(image={0x0112: 6})) + content[2:])
    prepared = prepare(photos, site_model(), tmp_path / "out", QUICK)
    assert prepared.findings == ()
    found = read_photo_set(tmp_path / "out")
    picture = found.picture(found.photos[0])
    assert picture.shape == (200, 150, 3)
    middle = picture[100, 75]  # red is 40 * the photo's number, green and blue are y and x
    assert np.abs(middle.astype(int) - (0, 100, 75)).max() < 12


@pytest.mark.slow
def test_a_cancelled_run_leaves_nothing(tmp_path: Path) -> None:
    class Cancelling(Monitor):
        def report(self, stage: str, done: int, total: int) -> None:
            if stage == "preparing photos" and done:
                raise OperationCancelled

    (tmp_path / "there").mkdir()
    for name in ("new", "there"):
        with pytest.raises(OperationCancelled):
            prepare(photos_in(tmp_path / "in", n=9), site_model(), tmp_path / name, QUICK, Cancelling())
    assert not (tmp_path / "new").exists()
    assert list((tmp_path / "there").iterdir()) == []


def test_wrong_input_is_refused_in_words(tmp_path: Path) -> None:
    photos = photos_in(tmp_path / "in")
    with pytest.raises(InputError, match="not empty"):
        prepare(photos, site_model(), tmp_path / "in", QUICK)
    with pytest.raises(InputError, match="no photos"):
        prepare([], site_model(), tmp_path / "out", QUICK)


def test_normals_survive_16_bits() -> None:
    rng = np.random.default_rng(0)
    normals = rng.normal(size=(50, 40, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals[:5] = 0.0
    back = normals_from_16_bit(normals_to_16_bit(normals.astype(np.float32)))
    assert np.abs(back - normals).max() < 5e-5
    assert (back[:5] == 0.0).all()


def test_normals_by_rays_and_by_panels_agree() -> None:
    photo = looking_at(FACE, 16.0, 0.0, 0.0, LENS)
    model = site_model()
    refined = RayCaster(refine_mesh(model.building, grid()).mesh)
    index = draw_panels(photo, grid()).index
    rays, known = normal_map(photo, refined), normal_map(photo, refined, 1, index, grid())
    inside = cv2.erode((index > 0).astype(np.uint8), np.ones((3, 3))) > 0
    same = np.linalg.norm(rays - known, axis=2) < 1e-3
    assert same[inside].mean() > 0.99
    assert np.array_equal(rays[index == 0], known[index == 0])


def test_frames_are_measured_and_covered() -> None:
    assert frame_width_m(grid()) == pytest.approx(0.1, abs=0.01)
    grown = grown_corners(site_model().site.facades)
    assert np.linalg.norm(grown[0, 1] - grown[0, 0]) == pytest.approx(1.5, abs=0.02)
    photo = looking_at(FACE, 16.0, 0.0, 0.0, LENS)
    layers = draw_layers(photo, Scene(grid(), grown, RayCaster(site_model().building), None), 4)
    outline = np.array([grid()[0, 0], grid()[5, 1], grid()[-1, 2], grid()[-6, 3]])
    inside = np.zeros((150, 200), np.uint8)
    cv2.fillConvexPoly(inside, np.round(photo.pixels(outline) - 0.5).astype(np.int32), 1)
    assert layers.facade[cv2.erode(inside, np.ones((5, 5))) > 0].all()
    assert layers.normals_enu.shape == (38, 50, 3)


def test_a_site_without_panels_hides_none():
    found = HiddenPanels().assess(PanelsInPhotos((), np.zeros((0, 4, 3)), RayCaster(empty_mesh())))
    assert found.size == 0.0
    assert str(found.reason) == "the site has no panels"
