"""Folders of rendered photos: what lies in them, what is true in them, and how an interrupted run goes on."""

import json
from dataclasses import replace
from datetime import timedelta

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.photos.folder import read_photos
from planning.plan import Viewpoint
from planning.site.bundled import single_panel
from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import angle_between_deg
from reconstruction.dataset.layers import normals_from_16_bit
from reconstruction.photos.poses import pose_photos
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import Shot, posed_photos
from reconstruction.scenes.photos.photo_layers import BYTES_PER_PIXEL
from reconstruction.scenes.runs import photo_folder
from reconstruction.scenes.runs.photo_folder import render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look

LENS = Intrinsics(64, 48, 60.0, 60.0, 32.0, 24.0)
ASIDE_M = (-4.0, 0.0, 5.0)


@pytest.fixture(scope="module")
def scene():
    return build_scene(single_panel(), Look(near=False), 2)


def job_for(scene, folder, **changes):
    """Photos of the panel from 12 m, each turned towards it."""
    corners = scene.panes.corners_enu_m[0]
    middle = corners.mean(axis=0)
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    normal /= np.linalg.norm(normal)
    right = np.cross([0.0, 0.0, 1.0], normal)
    shots = []
    for number, aside_m in enumerate(ASIDE_M):
        place = middle + 12.0 * normal + aside_m * right
        towards = middle - place
        heading = float(np.degrees(np.arctan2(towards[0], towards[1])))
        shots.append(Shot(Viewpoint(f"v{number}", tuple(place.tolist()), heading, 0.0), timedelta(seconds=5 * number)))
    photos = posed_photos(shots, LENS, folder / "images")
    return replace(PhotoJob(scene, photos, RenderSettings(), {"site": "single-panel"}, n_points=2000), **changes)


@pytest.fixture(scope="module")
def written(scene, tmp_path_factory):
    """A finished run; tests must not change it."""
    folder = tmp_path_factory.mktemp("run") / "photos"
    return render_photo_folder(job_for(scene, folder), folder, 1)


def record_of(folder):
    return json.loads((folder / "scene.json").read_text())


class StopsAfter:
    """Cancels once so many photos are done."""

    def __init__(self, n):
        self._n = n

    def report(self, stage, done, total):
        if stage == "rendering photos" and done >= self._n:
            raise OperationCancelled("enough")


@pytest.mark.slow
def test_photos_are_read_back_as_the_cameras_that_took_them(scene, written):
    images = written.folder / "images"
    back = pose_photos(read_photos(images).photos, scene.site.site, images).photos
    assert [photo.name for photo in back] == [photo.name for photo in written.photos]
    for photo, true in zip(back, written.photos, strict=True):
        assert photo.pose.position_enu_m == pytest.approx(true.pose.position_enu_m, abs=1e-3)
        assert angle_between_deg(photo.pose.cam_from_enu, true.pose.cam_from_enu) < 0.01
        assert photo.intrinsics == LENS
        assert photo.taken_at == true.taken_at


def test_what_is_true_of_the_panels_middle_stands_in_the_layers(scene, written):
    middle = scene.panes.corners_enu_m[0].mean(axis=0)
    for photo in written.photos:
        x, y = photo.pixels(middle[None])[0].astype(int)
        panels = cv2.imread(str(written.folder / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        depth = np.load(written.folder / "depth" / f"{photo.name}.npy")
        coded = cv2.imread(str(written.folder / "normals" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        normal = normals_from_16_bit(coded[..., ::-1])[y, x]
        assert panels.dtype == np.uint16
        assert panels[y, x] == 1
        ray = photo.intrinsics.rays(np.array([[x + 0.5, y + 0.5]]))
        met = photo.pose.position_enu_m + depth[y, x] * photo.pose.directions_enu(ray)[0]
        flat = np.cross(*(scene.panes.corners_enu_m[0][[1, 3]] - scene.panes.corners_enu_m[0][0]))
        flat /= np.linalg.norm(flat)
        assert (met - middle) @ flat == pytest.approx(0.0, abs=1e-3)
        assert normal @ flat > np.cos(np.radians(2.0))


def test_layers_have_the_photos_size_and_agree_with_each_other(written):
    folder = written.folder
    for photo in written.photos:
        picture = cv2.imread(str(photo.path))
        glass = cv2.imread(str(folder / "glass" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED) > 0
        mask = cv2.imread(str(folder / "masks" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED) > 0
        panels = cv2.imread(str(folder / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        diffuse = np.load(folder / "diffuse" / f"{photo.name}.npy")
        reflection = np.load(folder / "reflection" / f"{photo.name}.npy")
        assert picture.shape == diffuse.shape == reflection.shape == (48, 64, 3)
        assert diffuse.dtype == reflection.dtype == np.float16
        assert (glass == (panels > 0)).all()
        assert mask[glass].mean() > 0.99
        assert glass.sum() < mask.sum() < mask.size
        assert reflection[glass].mean() > 0.0
        inside = cv2.erode((~glass).astype(np.uint8), np.ones((3, 3))) > 0
        assert not reflection[inside].any()


def test_cameras_stand_in_colmaps_and_nerfstudios_files_and_in_the_data_set(written):
    model = read_model(written.folder / "sparse" / "0")
    frames = json.loads((written.folder / "transforms.json").read_text())["frames"]
    description = json.loads((written.folder / "dataset.json").read_text())
    assert len(model.images) == len(frames) == len(description["photos"]) == 3
    assert len(model.points.ids) == 2000
    for frame, photo in zip(frames, written.photos, strict=True):
        assert np.array(frame["transform_matrix"])[:3, 3] == pytest.approx(photo.pose.position_enu_m)
        paths = [value for key, value in frame.items() if key.endswith("_path")]
        assert len(paths) == 8
        assert all((written.folder / path).is_file() for path in paths)


def test_the_record_says_how_the_photos_were_made(scene, written):
    record = record_of(written.folder)
    assert record["format"] == "reflight-scene-photos/1"
    assert record["complete"] is True
    assert record["seed"] == scene.seed
    assert [effect["effect"] for effect in record["effects"]] == [d.effect for d in written.decisions]
    assert all(len(sums) == 8 for sums in record["files"].values())


def test_all_files_of_a_photo_take_no_more_than_is_reckoned_with(written):
    for sums in record_of(written.folder)["files"].values():
        n_bytes = sum((written.folder / path).stat().st_size for path in sums)
        headers = 128 * len(sums) + 2048
        assert n_bytes < BYTES_PER_PIXEL * LENS.width_px * LENS.height_px + headers


@pytest.mark.slow
def test_an_interrupted_run_goes_on_and_ends_as_if_it_had_not_been(scene, written, tmp_path):
    job = job_for(scene, tmp_path / "again")
    with pytest.raises(OperationCancelled):
        render_photo_folder(job, tmp_path / "again", 1, StopsAfter(1))
    begun = record_of(tmp_path / "again")
    assert (begun["complete"], len(begun["files"])) == (False, 1)
    assert not (tmp_path / "again" / "transforms.json").exists()
    done = render_photo_folder(job, tmp_path / "again", 1)
    assert done.n_kept == 1
    assert record_of(tmp_path / "again") == record_of(written.folder)


@pytest.mark.slow
def test_photos_whose_files_are_damaged_or_gone_are_made_again(scene, tmp_path):
    job = job_for(scene, tmp_path)
    render_photo_folder(job, tmp_path, 1)
    before = record_of(tmp_path)
    (tmp_path / "depth" / f"{job.photos[0].name}.npy").unlink()
    job.photos[1].path.write_bytes(b"torn")
    assert render_photo_folder(job, tmp_path, 1).n_kept == 1
    assert record_of(tmp_path) == before


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"settings": RenderSettings(tolerance=2.0)}, "settings.tolerance"),
        ({"made_from": {"site": "another"}}, "made_from.site"),
    ],
)
def test_photos_made_in_another_way_are_not_mixed_with_these(scene, written, changes, place):
    before = record_of(written.folder)
    with pytest.raises(InputError, match=f"another run: {place} is .* new folder"):
        render_photo_folder(job_for(scene, written.folder, **changes), written.folder, 1)
    assert record_of(written.folder) == before


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("seed", "look", "place"),
    [(3, Look(near=False), "seed"), (2, Look(near=False, tilt_deg=1.0), "scene_sha256")],
)
def test_photos_of_another_scene_are_not_mixed_with_these(written, seed, look, place):
    other = build_scene(single_panel(), look, seed)
    with pytest.raises(InputError, match=f"another run: {place} is .* new folder"):
        render_photo_folder(job_for(other, written.folder), written.folder, 1)


def test_fewer_views_are_another_run(scene, written):
    job = job_for(scene, written.folder)
    with pytest.raises(InputError, match="number of photos is 3 there, and 2 was asked for"):
        render_photo_folder(replace(job, photos=job.photos[:2]), written.folder, 1)


@pytest.mark.slow
def test_a_folder_of_something_else_is_left_alone(scene, tmp_path):
    (tmp_path / "letter.txt").write_text("Dear")
    with pytest.raises(InputError, match=r"is not empty, and has no scene\.json"):
        render_photo_folder(job_for(scene, tmp_path), tmp_path, 1)
    with pytest.raises(InputError, match="expected a folder, found a file"):
        render_photo_folder(job_for(scene, tmp_path), tmp_path / "letter.txt", 1)
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


def test_a_disk_that_is_too_small_is_noticed_before(scene, tmp_path, monkeypatch):
    usage = photo_folder.shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr(photo_folder.shutil, "disk_usage", lambda _: usage)
    with pytest.raises(InputError, match=r"take about \d+\.\d kB, and 1\.0 kB are free there; make room"):
        render_photo_folder(job_for(scene, tmp_path / "new"), tmp_path / "new", 1)
    assert not (tmp_path / "new").exists()


def test_a_run_without_views_is_refused(scene, tmp_path):
    with pytest.raises(InputError, match="no views to photograph"):
        render_photo_folder(job_for(scene, tmp_path, photos=()), tmp_path)


@pytest.mark.slow
def test_processes_side_by_side_write_the_same(scene, written, tmp_path):
    render_photo_folder(job_for(scene, tmp_path / "two"), tmp_path / "two", 2)
    assert record_of(tmp_path / "two") == record_of(written.folder)
