"""Exposures of photos: what points tell, what is learned, what cannot drift, and what a fit to one view gives."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from planning.base.effects import decide
from planning.geo.mesh import empty_mesh, from_corners
from reconstruction.dataset.records import coloured_ply
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import PanelPlanes, PhotoSet, read_photo_set
from reconstruction.light.shading import display_from_linear
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.saved import read_model, save_model
from reconstruction.training.photos import exposures
from reconstruction.training.photos.exposures import (
    Exposures,
    OwnExposures,
    fitted_gain,
    gains_from_points,
    told_by_points,
)
from reconstruction.training.train import train_model
from tests.reconstruction.light.synthetic_folder import cameras
from tests.reconstruction.training.synthetic_data_set import write_data_set


def test_they_start_from_what_is_known():
    known = [1.0, 0.5, 4.0]
    for channels in (1, 3):
        exposures = Exposures(np.tile(np.array(known)[:, None], channels))
        exposures.project()
        for number, gain in enumerate(known):
            assert exposures(number).tolist() == pytest.approx([gain] * channels, rel=1e-6)


def test_learning_finds_the_gains_and_the_scene_keeps_its_light():
    generator = torch.Generator().manual_seed(0)
    true_gains = torch.tensor([0.5, 1.0, 1.0, 2.0])
    scene = torch.rand(50, 3, generator=generator)
    photos = [gain * scene for gain in true_gains]
    exposures, light = Exposures([1.0] * 4), torch.full((50, 3), 0.5, requires_grad=True)
    for step in range(600):
        number = step % 4
        for value in (exposures.log_gains, light):
            value.grad = None
        (exposures(number) * light - photos[number]).square().mean().backward()
        with torch.no_grad():
            exposures.log_gains -= 0.3 * exposures.log_gains.grad
            light -= 10.0 * light.grad
        exposures.project()
    found = torch.cat([exposures(number) for number in range(4)]).detach()
    assert found.tolist() == pytest.approx(true_gains.tolist(), rel=0.02)
    assert torch.allclose(light, scene, atol=0.02)


def test_a_cast_that_all_gains_share_is_taken_back():
    exposures = Exposures(np.tile([[1.0], [2.0], [0.5], [1.0]], 3))
    before = exposures.log_gains.detach().clone()
    with torch.no_grad():
        exposures.log_gains += torch.tensor([0.3, -0.2, 0.0])
        exposures.log_gains[0, 0] += 1.0
    exposures.project()
    change = exposures.log_gains.detach() - before
    assert change.mean(dim=0).abs().max() < 1e-7
    assert change[:, 0].tolist() == pytest.approx([0.75, -0.25, -0.25, -0.25], abs=1e-6)


def test_a_thousand_projections_do_not_wander():
    exposures = Exposures([3.0] * 7)
    for _ in range(1000):
        exposures.project()
    assert exposures(3).item() == pytest.approx(3.0, rel=1e-6)


def test_state_keeps_the_mean_that_is_held():
    first, second = Exposures([2.0, 4.0]), Exposures([1.0, 1.0])
    second.load_state_dict(first.state_dict())
    second.project()
    assert second(1).item() == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize("channels", [1, 3])
def test_the_fitted_gain_is_the_photos_own(channels):
    generator = torch.Generator().manual_seed(1)
    light = torch.rand(2000, 3, generator=generator)
    gains = torch.tensor([1.3]) if channels == 1 else torch.tensor([1.1, 0.8, 0.5])
    clean = gains * light
    photo = torch.where(clean > 1.0, 1.0, clean)  # clipped as a camera does
    photo[::7] = 1.0  # a glint that was not rendered
    found = fitted_gain(light, photo, display_from_linear(photo), channels)
    assert found.tolist() == pytest.approx(gains.tolist(), rel=1e-4)


def test_where_nothing_tells_the_gain_is_1():
    black, some = torch.zeros(500, 3), torch.full((500, 3), 0.4)
    display = display_from_linear(some)
    assert fitted_gain(black, some, display).tolist() == [1.0]
    assert fitted_gain(some, some, torch.ones(500, 3), 3).tolist() == [1.0] * 3
    assert fitted_gain(some[:20], 2.0 * some[:20], display[:20]).tolist() == [1.0]
    spoilt = some.clone()
    spoilt[0] = torch.nan
    spoilt[1] = torch.inf
    assert fitted_gain(spoilt, 2.0 * some, display).tolist() == pytest.approx([2.0])


def test_wrong_calls_are_refused():
    for known in ([], [1.0, 0.0], [1.0, float("nan")], np.ones((1, 2)), np.ones((1, 3, 1))):
        with pytest.raises(ValueError, match="expected"):
            Exposures(known)
    with pytest.raises(ValueError, match="expected three"):
        fitted_gain(torch.zeros(4, 3), torch.zeros(5, 3), torch.zeros(4, 3))


# What points tell, of photos of a painted wall at y = 0.

N = 8
POINTS = np.random.default_rng(2).uniform((-4.0, 0.0, 0.0), (4.0, 0.0, 6.0), (4000, 3)) * (1.0, 0.0, 1.0)
BEHIND, BELOW = POINTS + np.array((0.0, 4.0, 0.0)), POINTS - np.array((0.0, 0.0, 4.0))
GAINS = np.exp(np.random.default_rng(3).normal(0.0, (0.3, 0.3, 0.25), (N, 3)))


def paint(places):
    """Linear light of places on the wall, shape (n, 3)."""
    x, z = places[:, 0], places[:, 2]
    return 0.2 + 0.1 * np.column_stack([np.sin(x), np.cos(z), np.sin(x + z)])


def painted(folder, gains):
    """A set of photos of the wall, each with gains of its own."""
    (folder / "images").mkdir(parents=True)
    photos = cameras(folder, N)
    for photo, gain in zip(photos, gains, strict=True):
        lens = photo.intrinsics
        y, x = np.mgrid[: lens.height_px, : lens.width_px] + 0.5
        origins, directions = photo.rays(np.column_stack([x.ravel(), y.ravel()]))
        places = origins - origins[:, 1:2] / directions[:, 1:2] * directions
        display = display_from_linear(torch.from_numpy(np.minimum(gain * paint(places), 1.0))).numpy()
        picture = np.rint(255.0 * display).astype(np.uint8).reshape(lens.height_px, lens.width_px, 3)
        cv2.imwrite(str(photo.path), picture[..., ::-1])
    return PhotoSet(folder, photos, PanelPlanes(np.zeros((0, 4, 3))), 1.0, {})


def exposed(source, *settings):
    """Gains and their decision."""
    told = told_by_points(source, source.photos, POINTS, empty_mesh(), *settings)
    return told.gains, told.own_exposures


@pytest.mark.long
def test_points_tell_gains_where_photos_were_exposed_one_by_one(tmp_path):
    source = painted(tmp_path, GAINS)
    gains, decision = exposed(source)
    assert decision.on
    assert decision.size == pytest.approx(np.log(GAINS).std(axis=0).mean(), rel=0.15)
    true = np.log(GAINS) - np.log(GAINS).mean(axis=0)
    np.testing.assert_allclose(np.log(gains), true, atol=0.03)
    known = {photo.name: float(gain.mean()) for photo, gain in zip(source.photos, GAINS, strict=True)}
    told = replace(source, own_exposures=known)
    _, of_rest = exposed(told)
    assert of_rest.size < decision.size


def test_nothing_is_told_where_photos_were_exposed_alike(tmp_path):
    source = painted(tmp_path, np.ones((N, 3)))
    gains, decision = exposed(source)
    assert not decision.on
    assert decision.size < 0.02
    assert (gains == 1.0).all()
    gains, decision = exposed(source, "on")
    assert decision.on
    np.testing.assert_allclose(gains, 1.0, atol=0.02)


FRAME_M, PANE_M, OFF_PX = 0.2, 0.5, 4.0


def framed(folder, gains):
    """Photos of the wall with panes that mirror something else to each photo, and points on the frames around them."""
    source = painted(folder, np.ones((N, 3)))
    for number, (photo, gain) in enumerate(zip(source.photos, gains, strict=True)):
        lens = photo.intrinsics
        y, x = np.mgrid[: 4 * lens.height_px, : 4 * lens.width_px] / 4.0 + 0.125
        origins, directions = photo.rays(np.column_stack([x.ravel(), y.ravel()]))
        places = origins - origins[:, 1:2] / directions[:, 1:2] * directions
        is_pane = (np.mod(places[:, [0, 2]] + 0.5 * FRAME_M, PANE_M) > FRAME_M).all(axis=1)
        mirrored = patches(photo, number).mean(axis=2) * np.exp(np.random.default_rng(number).normal(0.0, 0.3))
        mirrored = np.repeat(np.repeat(mirrored, 4, axis=0), 4, axis=1).ravel()[:, None]
        light = np.where(is_pane[:, None], mirrored, paint(places)).reshape(*y.shape, 3)
        light = cv2.resize(light, (lens.width_px, lens.height_px), interpolation=cv2.INTER_AREA)
        show_something_else(photo, np.minimum(gain * light, 1.0))
    points = POINTS.copy()
    points[::2, 0] = PANE_M * np.rint(points[::2, 0] / PANE_M)
    points[1::2, 2] = PANE_M * np.rint(points[1::2, 2] / PANE_M)
    return source, points


def turned_by(photo, off_px, seed):
    turn = cv2.Rodrigues(np.random.default_rng(seed).normal(0.0, off_px / photo.intrinsics.fx_px, 3))[0]
    return replace(photo, pose=replace(photo.pose, cam_from_enu=turn @ photo.pose.cam_from_enu))


@pytest.mark.long
@pytest.mark.parametrize("is_exposed", [False, True])
def test_what_frames_show_of_glass_beside_them_is_no_exposure(tmp_path, is_exposed):
    """Beside where poses say, frames look like the panes, which are brighter and darker from photo to photo."""
    source, points = framed(tmp_path, GAINS if is_exposed else np.ones((N, 3)))
    photos = [turned_by(photo, OFF_PX, number) for number, photo in enumerate(source.photos)]
    found = gains_from_points(source, photos, points, empty_mesh())
    assert np.log(found.gains).std(axis=0).mean() > OwnExposures().tolerance, "both halves of the points agree on gains"
    assert decide(OwnExposures(), found).on is is_exposed


def test_off_looks_at_no_photo(tmp_path):
    source = painted(tmp_path, GAINS)
    for photo in source.photos:
        photo.path.unlink()
    gains, decision = exposed(source, "off", "off")
    assert not decision.on
    assert (gains == 1.0).all()


def show_something_else(photo, pictures):
    """Put another picture, linear light from 0 to 1, in the place of a photo's."""
    display = display_from_linear(torch.from_numpy(pictures)).numpy()
    cv2.imwrite(str(photo.path), np.rint(255.0 * display).astype(np.uint8)[..., ::-1])


def patches(photo, seed):
    """Something with as much contrast as the wall."""
    lens = photo.intrinsics
    noise = np.random.default_rng(seed).uniform(0.05, 0.5, (6, 8, 3))
    return cv2.resize(noise, (lens.width_px, lens.height_px), interpolation=cv2.INTER_LINEAR)


@pytest.mark.long
@pytest.mark.parametrize("what", ["even", "patches"])
def test_a_photo_of_something_else_tells_no_gain_and_is_named(tmp_path, what):
    """As one taken by accident, or from inside a building that the site does not know."""
    source = painted(tmp_path, np.ones((N, 3)))
    lens, other = source.photos[2].intrinsics, source.photos[2]
    even = np.full((lens.height_px, lens.width_px, 3), 0.02)
    show_something_else(other, even if what == "even" else 0.3 * patches(other, 5))
    told = told_by_points(source, source.photos, POINTS, empty_mesh())
    assert told.outliers == (2,)
    assert told.outlier_photos.on
    assert other.name in told.outlier_photos.reason
    assert told.outlier_photos.size == pytest.approx(1 / N)
    assert not told.own_exposures.on, "the others are exposed alike"
    kept = told_by_points(source, source.photos, POINTS, empty_mesh(), outlier_photos="off")
    assert kept.outliers == ()
    assert not kept.own_exposures.on


@pytest.mark.long
def test_what_few_photos_leave_open_all_decide(tmp_path, monkeypatch):
    source = painted(tmp_path, np.ones((N, 3)))
    show_something_else(source.photos[2], 0.3 * patches(source.photos[2], 5))
    few = gains_from_points(source, source.photos[::2], POINTS, empty_mesh())
    assert few.spread > OwnExposures().tolerance, "four photos cannot tell which of them is the odd one"
    monkeypatch.setattr(exposures, "LOOKED_AT", 4)
    told = told_by_points(source, source.photos, POINTS, empty_mesh())
    assert told.outliers == (2,)
    assert not told.own_exposures.on


def test_where_many_photos_disagree_rather_the_points_are_wrong(tmp_path):
    source = painted(tmp_path, np.ones((N, 3)))
    for number in range(N):
        show_something_else(source.photos[number], patches(source.photos[number], number))
    assert told_by_points(source, source.photos, POINTS, empty_mesh()).outliers == ()


def test_photos_of_the_place_are_no_outliers_however_they_were_exposed(tmp_path):
    told = told_by_points(painted(tmp_path, GAINS**3), cameras(tmp_path, N), POINTS, empty_mesh())
    assert told.outliers == ()
    assert not told.outlier_photos.on
    even = PhotoSet(tmp_path, cameras(tmp_path, N), PanelPlanes(np.zeros((0, 4, 3))), 1.0, {})
    for number, photo in enumerate(even.photos):
        lens = photo.intrinsics
        noise = np.random.default_rng(number).normal(0.3, 0.01, (lens.height_px, lens.width_px, 3))
        show_something_else(photo, noise.clip(0.0, 1.0))
    assert told_by_points(even, even.photos, POINTS, empty_mesh()).outliers == (), "an even wall has nothing to tell by"


@pytest.mark.long
def test_hidden_points_and_clipped_pixels_tell_nothing(tmp_path):
    bright = GAINS.copy()
    bright[0] = 2.6  # half of the photo is white
    source = painted(tmp_path, bright)
    before, true = (
        gains_from_points(source, source.photos, POINTS, empty_mesh()),
        np.log(bright) - np.log(bright).mean(axis=0),
    )
    np.testing.assert_allclose(np.log(before.gains), true, atol=0.05)
    # As many points behind the wall, where photos show the wall's other places.
    wall = from_corners(np.array([[(-9, 0, -9), (9, 0, -9), (9, 0, 9)], [(-9, 0, -9), (9, 0, 9), (-9, 0, 9)]], float))
    behind = np.concatenate([POINTS, BEHIND])
    hidden = gains_from_points(source, source.photos, behind, wall)
    np.testing.assert_allclose(np.log(hidden.gains), true, atol=0.05)
    assert gains_from_points(source, source.photos, BEHIND, wall).n_told == 0
    # Without a mesh nearer points say which may be hidden, however many these are.
    behind = np.concatenate([POINTS, *(BEHIND + np.array((0.0, off_m, 0.1 * off_m)) for off_m in range(4))])
    hidden = gains_from_points(source, source.photos, behind, empty_mesh())
    np.testing.assert_allclose(np.log(hidden.gains), true, atol=0.05)


@pytest.mark.long
def test_training_begins_with_what_points_tell_and_keeps_it(tmp_path):
    tiny = ReflectionConfig(environment_rows=8, steps=2, batch=64)
    config = TrainConfig(iterations=2, n_splats=100, max_splats=100, light="harmonics", reflections=tiny)
    folder = tmp_path / "glass"
    photos = write_data_set(folder, n=6)
    (folder / "points.ply").write_bytes(coloured_ply(BELOW, np.full(POINTS.shape, 99, np.uint8)))
    alike = train_model(folder, config)
    assert (alike.record.config.own_exposures, alike.exposures.log_gains.shape[1]) == ("off", 1)
    assert (alike.exposures.log_gains == 0.0).all()
    for number, photo in enumerate(photos):
        cv2.imwrite(str(photo.path), np.rint((0.6 + 0.08 * number) * cv2.imread(str(photo.path))))
    own = train_model(folder, config)
    names = [photo.name for photo in read_photo_set(folder).photos]
    order = [names.index(name) for name in own.record.learned]
    gains = own.exposures.log_gains.detach().mean(dim=1)
    assert own.record.config.own_exposures == "on"
    assert [int(k) for k in torch.argsort(gains)] == np.argsort(order).tolist()
    save_model(own, tmp_path / "model")
    back = read_model(tmp_path / "model")
    assert torch.equal(back.exposures.log_gains, own.exposures.log_gains)
    off = train_model(folder, replace(config, own_exposures="off"))
    assert (off.exposures.log_gains == 0.0).all()


@pytest.mark.parametrize("n_seen", [40, 0])
def test_points_that_no_photo_shows_any_more_say_nothing_of_what_gains_explain(n_seen):
    light = np.random.default_rng(0).normal(size=(1, 60, 3))
    gains = np.array([0.3, 0.0, -0.3])[:, None] + np.zeros((3, 3))
    seen = light + gains[:, None]
    seen[:, n_seen:] = np.nan
    assert exposures._explained(seen, gains) == pytest.approx(1.0 if n_seen else 0.0)
