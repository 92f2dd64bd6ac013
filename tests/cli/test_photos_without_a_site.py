"""Photos with a model of COLMAP or nerfstudio, and no site: data set, training, score and export of plain splats."""

import json
import math
import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from planning.photos.folder import read_photos
from planning.photos.jpeg import kind_of
from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import Similarity, in_enu, model_of
from reconstruction.colmap.record import ColmapPoints
from reconstruction.dataset.records import coloured_ply, read_transforms, transforms
from reconstruction.light.photo_set import read_photo_set
from reconstruction.photos.poses import pose_photos
from reconstruction.splats.surfels import read_points
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.score import score_views
from reconstruction.training.train import train_model
from tests.reconstruction.light.synthetic_folder import cameras, corners_of, far, panel_numbers, picture
from tests.services.photo_cases import site_model, write_photos

N = 6
ON_ITS_SIDE = Similarity(1.0, Rotation.from_euler("xyz", (80.0, 10.0, -25.0), degrees=True).as_matrix(), np.zeros(3))


def points_on_glass(n=400):
    rng = np.random.default_rng(1)
    xyz = np.column_stack([rng.uniform(-3.0, 3.0, n), np.zeros(n), rng.uniform(1.0, 5.0, n)])
    nothing = np.full(n, -1.0), np.zeros(n + 1, np.int64), np.zeros((0, 2), np.int64)
    return ColmapPoints(np.arange(1, n + 1), xyz, rng.integers(0, 255, (n, 3)).astype(np.uint8), *nothing)


def write_project(folder, kind="bin", moved=ON_ITS_SIDE, points=True):
    """`images/` and `sparse/0` of a wall that is seen from six places, in a frame of the model's own."""
    photos = cameras(folder, N)
    (folder / "images").mkdir(parents=True)
    for photo in photos:
        shown = picture(photo, panel_numbers(photo, corners_of()) > 0, far, 1.0)
        assert cv2.imwrite(str(photo.path), shown[..., ::-1])
    model = model_of(photos)
    if points:
        model = replace(model, points=points_on_glass())
    write_model(folder / "sparse" / "0", in_enu(model, moved), kind)
    return photos


def prepared(reflight, *arguments, out):
    done = reflight("prepare", *arguments, "-o", out, "--normal-step", 4)
    assert done.status == 0, done
    return done


def apart(one, other):
    """Distances between all cameras of two lists, one of each: the same in any frame of the same size."""
    a, b = (np.array([photo.pose.position_enu_m for photo in photos]) for photos in (one, other))
    return tuple(np.linalg.norm(each[:, None] - each, axis=2) for each in (a, b))


@pytest.mark.parametrize("kind", ["bin", "txt"])
def test_a_colmap_folder_becomes_a_data_set_that_stands_upright(reflight, tmp_path, kind):
    true = write_project(tmp_path / "wall", kind)
    out = tmp_path / "wall.dataset"
    done = prepared(reflight, tmp_path / "wall", out=out)
    assert "6 photos prepared" in done.out
    assert "the frame is that of their model, and one unit of it counts as 1 m" in done.err
    assert "was turned by" in done.err
    data = read_photo_set(out)
    assert [photo.name for photo in data.photos] == [photo.name for photo in true]
    assert np.allclose(*apart(data.photos, true))
    ups = np.array([-photo.pose.cam_from_enu[1] for photo in data.photos])
    rights = np.array([photo.pose.cam_from_enu[0] for photo in data.photos])
    assert np.abs(rights[:, 2]).max() < 0.01
    assert ups[:, 2].min() > 0.5
    described = json.loads((out / "dataset.json").read_text())
    assert described["panels"] == []
    moved = Similarity(*(np.array(described["enu_from_model"][key]) for key in ("scale", "rotation", "translation")))
    stored = read_model(tmp_path / "wall" / "sparse" / "0")
    xyz, _ = read_points(out / "points.ply")
    assert np.allclose(xyz, moved(stored.points.xyz), atol=1e-5)
    assert not (out / "refined.ply").exists()


def test_the_folder_of_photos_and_a_named_model_do_as_well(reflight, tmp_path):
    write_project(tmp_path / "wall")
    images = tmp_path / "wall" / "images"
    whole = prepared(reflight, tmp_path / "wall", out=tmp_path / "a")
    beside = prepared(reflight, images, out=tmp_path / "b")
    (tmp_path / "wall" / "sparse" / "0").rename(tmp_path / "model")
    named = prepared(reflight, images, "--colmap", tmp_path / "model", out=tmp_path / "c")
    assert whole.err.replace("/a", "") == beside.err.replace("/b", "") == named.err.replace("/c", "")
    names = {each.relative_to(tmp_path / "a") for each in (tmp_path / "a").rglob("*.png")}
    for other in ("b", "c"):
        assert {each.relative_to(tmp_path / other) for each in (tmp_path / other).rglob("*.png")} == names


@pytest.mark.parametrize(("scale", "counts_as"), [(0.01, "100 m"), (1.0, "1 m"), (8.0, "1 m"), (1000.0, "0.001 m")])
def test_units_that_cannot_be_metres_are_scaled_by_tens(reflight, tmp_path, scale, counts_as):
    moved = Similarity(scale, ON_ITS_SIDE.rotation, np.array([5e5, 5e6, 100.0]) if scale == 8.0 else np.zeros(3))
    true = write_project(tmp_path / "wall", moved=moved)
    done = prepared(reflight, tmp_path / "wall", out=tmp_path / "d")
    assert f"one unit of it counts as {counts_as}" in done.err
    assert ("near zero" in done.err) == (scale == 8.0)
    data = read_photo_set(tmp_path / "d")
    mine, theirs = apart(data.photos, true)
    assert np.allclose(mine, (8.0 if scale == 8.0 else 1.0) * theirs, atol=1e-3)
    assert max(np.abs(photo.pose.position_enu_m).max() for photo in data.photos) < 1000.0


@pytest.mark.parametrize("kind", ["nerfstudio", "rendered"])
def test_transforms_json_is_read(reflight, tmp_path, kind):
    folder = tmp_path / "wall"
    true = write_project(folder)
    shutil.rmtree(folder / "sparse")
    content = transforms(true)
    if kind == "nerfstudio":
        cloud = points_on_glass()
        (folder / "sparse_pc.ply").write_bytes(coloured_ply(cloud.xyz, cloud.rgb))
        content["ply_file_path"] = "sparse_pc.ply"
    else:
        lens = true[0].intrinsics
        frames = [
            {"file_path": f"./images/{photo.path.stem}", "transform_matrix": frame["transform_matrix"]}
            for photo, frame in zip(true, content["frames"], strict=True)
        ]
        content = {"camera_angle_x": 2.0 * math.atan(0.5 * lens.width_px / lens.fx_px), "frames": frames}
    (folder / "transforms.json").write_text(json.dumps(content))
    done = prepared(reflight, folder, out=tmp_path / "d")
    assert ("the model has no points" in done.err) == (kind == "rendered")
    assert "was turned" not in done.err
    for mine, theirs in zip(read_photo_set(tmp_path / "d").photos, true, strict=True):
        assert mine.name == theirs.name
        assert np.allclose(mine.pose.position_enu_m, theirs.pose.position_enu_m)
        assert np.allclose(mine.pose.cam_from_enu, theirs.pose.cam_from_enu)
        assert mine.intrinsics.matrix == pytest.approx(theirs.intrinsics.matrix)
    xyz, _ = read_points(tmp_path / "d" / "points.ply")
    middle = (0.0, 0.0, 3.0)
    assert np.linalg.norm(np.median(xyz, axis=0) - middle) < 2.5


def test_distorted_frames_of_a_transforms_json_keep_their_numbers(tmp_path):
    frame = {"file_path": "a.png", "transform_matrix": np.eye(4).tolist(), "k1": -0.1, "fl_x": 90.0}
    common = {
        "camera_model": "OPENCV",
        "w": 100.0,
        "h": 80.0,
        "fl_x": 70.0,
        "cx": 51.0,
        "p1": 0.01,
        "is_fisheye": False,
    }
    path = tmp_path / "transforms.json"
    path.write_text(json.dumps({**common, "frames": [frame]}))
    model, cloud, masks = read_transforms(path)
    (camera,), (image,) = model.cameras.values(), model.images.values()
    assert (cloud, masks) == (None, {})
    assert (camera.model, camera.width_px, camera.height_px) == ("OPENCV", 100, 80)
    assert camera.parameters == (90.0, 90.0, 51.0, 40.0, -0.1, 0.0, 0.01, 0.0)
    assert image.name == (tmp_path / "a.png").as_posix()
    assert np.allclose(image.cam_from_world, np.diag([1.0, -1.0, -1.0]))


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"camera_model": "EQUIRECTANGULAR"}, "camera model EQUIRECTANGULAR is not supported"),
        ({"is_fisheye": True, "fl_x": None, "camera_angle_x": 3.0}, "says no focal length"),
        ({"k4": 0.1}, "k4: expected 0"),
        ({"fl_x": 0.0}, "says no focal length"),
        ({"frames": []}, "has no frames"),
        (
            {"frames": [{"file_path": "a.png", "transform_matrix": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]}]},
            "rotation",
        ),
        ({"frames": [{"file_path": "a.png", "transform_matrix": [[1, 0, 0]]}]}, "expected 4 x 4 numbers"),
        ({"frames": [{"file_path": "a.png"}]}, "transform_matrix"),
    ],
)
def test_a_transforms_json_that_cannot_be_used_is_refused_in_words(reflight, tmp_path, changed, says):
    frames = [{"file_path": "a.png", "transform_matrix": np.eye(4).tolist()}]
    content = {"w": 8, "h": 8, "fl_x": 9.0, "frames": frames} | changed
    (tmp_path / "transforms.json").write_text(json.dumps(content))
    assert cv2.imwrite(str(tmp_path / "a.png"), np.zeros((8, 8, 3), np.uint8))
    assert says in reflight("prepare", tmp_path, "-o", tmp_path / "d").error


# Masks, and lenses of fisheyes.


def write_masked(folder, way, rng):
    """A wall whose photos show noise that differs with `rng` where they are masked, in the way of another program."""
    photos = write_project(folder, moved=Similarity.identity())
    height, width = photos[0].intrinsics.height_px, photos[0].intrinsics.width_px
    names = []
    for number, photo in enumerate(photos):
        valid = np.ones((height, width), bool)
        valid[5:15, 3 + number : 18 + number] = False
        shown = cv2.imread(str(photo.path))
        shown[~valid] = rng.integers(0, 256, (int((~valid).sum()), 3))
        assert cv2.imwrite(str(photo.path), shown)
        names.append(f"{photo.name if way == 'colmap' else photo.path.stem}.png")
        (folder / "masks").mkdir(exist_ok=True)
        assert cv2.imwrite(str(folder / "masks" / names[-1]), valid.astype(np.uint8) * (1 if number == 1 else 255))
    if way == "nerfstudio":
        cloud = points_on_glass()
        (folder / "points.ply").write_bytes(coloured_ply(cloud.xyz, cloud.rgb))
        content = {**transforms(photos), "ply_file_path": "points.ply"}
        (folder / "masks").rename(folder / "left_out")
        for frame, name in zip(content["frames"], names, strict=True):
            frame["mask_path"] = f"left_out/{name}"
        (folder / "transforms.json").write_text(json.dumps(content))
        shutil.rmtree(folder / "sparse")
    return photos


FEW_STEPS = TrainConfig(method="2dgs", iterations=12, n_splats=150, max_splats=200, score_every_s=1e9)


def trained_on(folder):
    """All that a model has learned, and its scores on photos that it was not shown."""
    trained = train_model(folder, FEW_STEPS)
    scores = score_views(trained, read_photo_set(folder), trained.record.held_out)
    state = {name: value.numpy().copy() for name, value in trained.model.state_dict().items()}
    return state, [(score.whole, score.whole_flip) for score in scores]


@pytest.mark.long
@pytest.mark.parametrize("way", ["colmap", "stems", "nerfstudio"])
def test_what_lies_under_masks_changes_neither_the_model_nor_its_scores(reflight, tmp_path, way):
    found = []
    for seed in (1, 2):
        folder = tmp_path / f"wall{seed}"
        write_masked(folder, way, np.random.default_rng(seed))
        done = prepared(reflight, folder, out=tmp_path / f"d{seed}")
        assert "have no mask" not in done.err
        assert "its mask" not in done.err
        found.append(trained_on(tmp_path / f"d{seed}"))
    (one, scores), (other, other_scores) = found
    assert one.keys() == other.keys()
    assert all(np.array_equal(one[name], other[name]) for name in one)
    assert scores == other_scores
    for seed in (1, 2):
        shutil.rmtree(tmp_path / f"d{seed}" / "valid")
    assert (tmp_path / "d1" / "points.ply").read_bytes() == (tmp_path / "d2" / "points.ply").read_bytes()
    bare, other_bare = (trained_on(tmp_path / f"d{seed}") for seed in (1, 2))
    assert bare[1] != other_bare[1]
    assert not np.array_equal(bare[0]["splats.means"], other_bare[0]["splats.means"])


def test_masks_that_do_not_fit_are_said_and_a_data_set_of_masked_photos_can_be_prepared_again(reflight, tmp_path):
    folder = tmp_path / "wall"
    photos = write_masked(folder, "colmap", np.random.default_rng(0))
    masks = folder / "masks"
    half = cv2.imread(str(masks / "p00.png.png"), 0)[::2, ::2]
    assert cv2.imwrite(str(masks / "p00.png.png"), half)
    assert cv2.imwrite(str(masks / "p02.png.png"), np.full((20, 40), 255, np.uint8))
    assert cv2.imwrite(str(masks / "p03.png.png"), np.zeros((30, 40), np.uint8))
    (masks / "p04.png.png").unlink()
    done = prepared(reflight, folder, out=tmp_path / "d")
    assert "4 photos prepared" in done.out
    assert "its mask cannot be used" in done.err
    assert "has 40 x 20 pixels, and the photo's camera 40 x 30" in done.err
    assert "p03.png.png: is black everywhere" in done.err
    assert "5 of 6 photos have a mask: what it has black does not count" in done.err
    assert "1 of 6 photos have no mask, the first p04.png: all their pixels count" in done.err
    source = read_photo_set(tmp_path / "d")
    assert [photo.name for photo in source.photos if photo.mask is None] == ["p04.png"]
    lost = {photo.name: source.picture(photo).any(axis=2) for photo in source.photos}
    assert not lost["p00.png"][6:14, 4:17].any()  # twice as large a mask
    assert lost["p00.png"][16:].all()
    assert not lost["p01.png"][5:15, 4:19].any()
    assert lost["p04.png"].all()
    again = prepared(reflight, tmp_path / "d", out=tmp_path / "again")
    assert "1 of 4 photos have no mask, the first p04.png" in again.err
    assert "its mask" not in again.err
    for photo in read_photo_set(tmp_path / "again").photos:
        valid = tmp_path / "d" / "valid" / f"{photo.name}.png"
        assert (photo.mask is None) == (not valid.is_file())
        assert photo.mask is None or photo.mask.read_bytes() == valid.read_bytes()
    assert len(photos) == N


FISHEYE = Intrinsics(200, 150, 62.0, 61.0, 103.0, 72.0, fisheye=(0.03, -0.01, 0.002, -0.0003))
"""185 degrees from side to side."""


def waves(directions):
    """Something that can be seen in every direction, shape (n, 3), 0 to 255."""
    return 127.0 + 100.0 * np.sin(5.0 * directions)


@pytest.mark.long
@pytest.mark.parametrize("way", ["colmap", "nerfstudio", "instant-ngp"])
def test_photos_of_a_fisheye_are_made_straight(reflight, tmp_path, way):
    folder = tmp_path / "dome"
    true = [replace(photo, intrinsics=FISHEYE, path=photo.path.with_suffix(".png")) for photo in cameras(folder, 3)]
    (folder / "images").mkdir(parents=True)
    y, x = np.mgrid[:150, :200] + 0.5
    for photo in true:
        _, directions = photo.rays(np.column_stack([x.ravel(), y.ravel()]))
        assert cv2.imwrite(str(photo.path), waves(directions).round().astype(np.uint8).reshape(150, 200, 3)[..., ::-1])
    if way == "colmap":
        write_model(folder / "sparse" / "0", model_of(true), "txt")
        assert "OPENCV_FISHEYE" in (folder / "sparse" / "0" / "cameras.txt").read_text()
    else:
        content = transforms([replace(photo, intrinsics=FISHEYE.straight()) for photo in true])
        numbers = dict(zip(("k1", "k2", "k3", "k4"), FISHEYE.fisheye, strict=True))
        sizes = {"w": 200, "h": 150, "fl_x": 62.0, "fl_y": 61.0, "cx": 103.0, "cy": 72.0}
        model = {"camera_model": "OPENCV_FISHEYE"} if way == "nerfstudio" else {"is_fisheye": True}
        kept = ("file_path", "transform_matrix")
        frames = [{name: frame[name] for name in kept} for frame in content["frames"]]
        (folder / "transforms.json").write_text(json.dumps({**numbers, **sizes, **model, "frames": frames}))
    moved = prepared(reflight, folder, out=tmp_path / "d")
    assert "3 of 3 photos are of a fisheye that shows more than can be told straight" in moved.err
    assert "farther than 55 degrees" in moved.err
    source = read_photo_set(tmp_path / "d")
    described = json.loads((tmp_path / "d" / "dataset.json").read_text())
    turned = np.array(described["enu_from_model"]["rotation"])
    for photo in source.photos:
        lens = photo.intrinsics
        assert lens == FISHEYE.straight()
        y, x = np.mgrid[: lens.height_px, : lens.width_px] + 0.5
        _, directions = photo.rays(np.column_stack([x.ravel(), y.ravel()]))
        wanted = waves(directions @ turned).reshape(lens.height_px, lens.width_px, 3)
        assert photo.mask is None  # the lens shows more on all sides
        assert np.abs(source.picture(photo) - wanted).max() < 8.0
    assert (
        "lens distortion is off"
        in reflight("prepare", folder, "-o", tmp_path / "off", "--lens-distortion", "off").error
    )
    assert not (tmp_path / "off").exists()


def test_what_is_missing_is_said(reflight, tmp_path):
    folder = tmp_path / "wall"
    write_project(folder)
    assert "found nothing" in reflight("prepare", tmp_path / "none", "-o", tmp_path / "d").error
    (tmp_path / "bare").mkdir()
    assert "holds no .jpg photo" in reflight("prepare", tmp_path / "bare", "-o", tmp_path / "d").error
    shutil.copy(folder / "images" / "p00.png", tmp_path / "bare")
    no_model = reflight("prepare", tmp_path / "bare", "-o", tmp_path / "d").error
    assert "no transforms.json" in no_model
    assert "--colmap" in no_model
    in_its_place = reflight("prepare", folder / "images", folder / "sparse" / "0", "-o", tmp_path / "d").error
    assert "no site; name it with --colmap" in in_its_place
    assert "name it, or leave --refine out" in reflight("prepare", folder, "-o", tmp_path / "d", "--refine").error
    (folder / "images" / "p01.png").unlink()
    done = prepared(reflight, folder, out=tmp_path / "d")
    assert "1 of 6 images of the COLMAP model are not in" in done.err
    assert "p01.png" in done.err
    assert "5 photos prepared" in done.out
    assert "not in the model" not in done.err
    assert cv2.imwrite(str(folder / "images" / "more.jpg"), np.zeros((30, 40, 3), np.uint8))
    done = prepared(reflight, folder, out=tmp_path / "more")
    assert "1 of 7 photos are not in the model, the first more.jpg" in done.err
    (folder / "images").rename(folder / "photos")
    error = reflight("prepare", folder, "-o", tmp_path / "e").error
    assert "none of the 6 images of the model is in this folder, the first 'p00.png'" in error


def test_pictures_that_were_made_smaller_get_smaller_cameras(reflight, tmp_path):
    true = write_project(tmp_path / "wall")
    for photo in true:
        assert cv2.imwrite(str(photo.path), cv2.resize(cv2.imread(str(photo.path)), (20, 15)))
    assert "6 of 6 photos have another size" in prepared(reflight, tmp_path / "wall", out=tmp_path / "d").err
    assert read_photo_set(tmp_path / "d").photos[0].intrinsics == true[0].intrinsics.scaled(20, 15)


def test_pictures_of_another_kind_than_their_name_says_are_written_as_it_says(reflight, tmp_path):
    folder = tmp_path / "wall"
    true = write_project(folder)
    model = read_model(folder / "sparse" / "0")
    shutil.rmtree(folder / "sparse")
    images = {number: replace(image, name=f"{image.name[:-4]}.jpg") for number, image in model.images.items()}
    images[1] = replace(images[1], name="p00.png")
    write_model(folder / "sparse" / "0", replace(model, images=images))
    for photo in true[1:]:
        photo.path.rename(photo.path.with_suffix(".jpg"))
    as_jpeg = cv2.imencode(".jpg", cv2.imread(str(true[0].path)))[1].tobytes()
    true[0].path.write_bytes(as_jpeg)
    prepared(reflight, folder, out=tmp_path / "d")
    data = read_photo_set(tmp_path / "d")
    assert [photo.name for photo in data.photos] == ["p00.png", *(f"p{number:02d}.jpg" for number in range(1, N))]
    kinds = [kind_of(photo.path.read_bytes()) for photo in data.photos]
    assert kinds == ["PNG", *["JPEG"] * (N - 1)]
    assert (cv2.imread(str(data.photos[0].path)) == cv2.imdecode(np.frombuffer(as_jpeg, np.uint8), 1)).all()


@pytest.mark.long
def test_photos_that_say_their_pose_place_the_model(reflight, tmp_path):
    write_photos(tmp_path / "photos")
    true = pose_photos(read_photos(tmp_path / "photos").photos, site_model().site, tmp_path / "photos").photos
    write_model(tmp_path / "model", in_enu(model_of(true), Similarity(0.1, ON_ITS_SIDE.rotation, np.ones(3))))
    done = prepared(reflight, tmp_path / "photos", "--colmap", tmp_path / "model", out=tmp_path / "d")
    assert "distortion of the lens is not known" not in done.err  # the model knows it
    assert "one unit of it" not in done.err
    mine, theirs = apart(read_photo_set(tmp_path / "d").photos, sorted(true, key=lambda photo: photo.name))
    assert np.abs(mine - theirs).max() < 0.5
    assert json.loads((tmp_path / "d" / "dataset.json").read_text())["origin"]["lat_deg"] == pytest.approx(
        22.3372, abs=1e-3
    )


@pytest.mark.slow
def test_it_is_trained_scored_and_exported_without_further_ado(reflight, tmp_path):
    write_project(tmp_path / "wall")
    (tmp_path / "quick.toml").write_text("n_splats = 200\nmax_splats = 300\n")
    settings = ("--preset", "smoke", "--settings", tmp_path / "quick.toml", "--iterations", 6)
    model = tmp_path / "wall.model"
    done = reflight("train", tmp_path / "wall", "-o", model, *settings)
    assert done.status == 0, done.err
    assert "unseen view" in done.out
    assert "one unit of it counts as 1 m" in done.err
    assert f"next: app.py score {model} {tmp_path / 'wall.dataset'}" in done.err
    scored = reflight("score", model, tmp_path / "wall.dataset", "--json")
    assert scored.status == 0, scored.err
    assert scored.json["psnr_db"] > 0.0
    assert "facade" not in reflight("score", model, tmp_path / "wall.dataset").out
    for kind, name in (("ply", "a.ply"), ("web", "web")):
        exported = reflight("export", model, "--format", kind, "-o", tmp_path / name)
        assert exported.status == 0, exported.err


def test_folders_of_the_program_that_are_not_finished_are_none_of_another(reflight, tmp_path):
    write_project(tmp_path / "wall")
    (tmp_path / "wall" / "scene.json").write_text("{}")
    assert "has no dataset.json" in reflight("train", tmp_path / "wall", "-o", tmp_path / "m").error
    assert not (tmp_path / "wall.dataset").exists()
