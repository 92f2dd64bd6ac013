"""Rays of glass pixels against the camera's mirror image, and which pixels count."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from planning.base.errors import OperationCancelled
from reconstruction.light import glass_rays as rays_of_glass
from reconstruction.light.glass_rays import (
    BYTES_PER_RAY,
    COLUMNS,
    CORNERS,
    glass_rays,
    joined,
    rays_of_photo,
    rays_of_pixels,
)
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.ray_table import LEAST_COSINE, RayTable
from tests.reconstruction.light.synthetic_folder import LENS, far, mirror_directions, write_folder

BENT = replace(LENS, distortion=(-0.12, 0.03, 0.002, -0.001, 0.0))


@pytest.fixture(scope="module", params=[LENS, BENT], ids=["straight", "distorted"])
def source(request, tmp_path_factory):
    """A folder of four photos; tests must not change it."""
    folder = tmp_path_factory.mktemp("rays") / "photos"
    write_folder(folder, far, 4, lens=request.param)
    return read_photo_set(folder)


def places_of(source, rays):
    return rays.middle().points.double().numpy() * source.panels.half_side_m + source.panels.middle_enu_m


def test_rays_are_taken_by_numbers_masks_and_ranges(source):
    rays = glass_rays(source, source.photos)
    is_first = rays.photos == 0
    for rows in (torch.nonzero(is_first).squeeze(1), is_first, slice(0, int(is_first.sum()))):
        for name in COLUMNS:
            assert torch.equal(getattr(rays[rows], name), getattr(rays, name)[rows])


def test_rays_are_those_that_plain_torch_makes(source):
    rays = glass_rays(source, source.photos)
    n_photos = len(source.photos)
    found = rays.hits()
    # With corrections, be they none, they are made in torch.
    expected = rays.hits(moves=torch.zeros(n_photos, 6, dtype=torch.float64))
    for name in ("points_m", "directions", "cosines", "shares", "distances_m"):
        assert torch.allclose(getattr(found, name), getattr(expected, name), rtol=1e-12, atol=1e-12)


def test_pixels_that_lie_whole_on_a_panel_are_those_of_plain_torch(source):
    table = RayTable.of(source.photos, source.panels, {})
    rng = np.random.default_rng(3)
    n, n_panels = 4000, len(source.panels.corners_enu_m)
    photos = torch.from_numpy(rng.integers(len(source.photos), size=n))
    panels = torch.from_numpy(rng.integers(n_panels, size=n))
    # Also places outside of the picture, and rays that go away from the panels.
    places = torch.from_numpy(rng.uniform(-0.3, 1.3, (n, 2)) * (LENS.width_px, LENS.height_px))
    found = table.holds(photos, places, panels, np.array(CORNERS))
    expected = torch.ones(n, dtype=torch.bool)
    corners, normals = table.corners_m[panels], table.normals[panels]
    for around in CORNERS:
        hits = table.meet(photos, places + torch.tensor(around, dtype=torch.float64), panels)
        expected &= hits.cosines > LEAST_COSINE
        for number in range(4):
            edge = corners[:, (number + 1) % 4] - corners[:, number]
            left = torch.linalg.cross(edge, hits.points_m - corners[:, number])
            expected &= (left * normals).sum(dim=1) >= 0.0
    assert torch.equal(found, expected)
    assert 0.02 < found.double().mean() < 0.98


def test_rays_meet_the_glass_at_the_middles_of_pixels_and_go_on_from_the_cameras_mirror_image(source):
    for photo in source.photos:
        rays = rays_of_photo(source, photo)
        places = places_of(source, rays)
        pixels = photo.pixels(places) - 0.5
        assert len(rays) > 100
        assert np.abs(pixels - np.rint(pixels)).max() < 2e-4
        assert np.abs(places[:, 1]).max() < 1e-6
        assert np.abs(rays.middle().omega_r.numpy() - mirror_directions(photo, places)).max() < 1e-6
        assert np.abs(rays.middle().cosines.numpy() + rays.middle().omega_r[:, 1].numpy()).max() < 1e-6


def test_colours_and_panels_are_those_of_the_pixels(source):
    photo = source.photos[0]
    rays = rays_of_photo(source, photo)
    column, row = np.rint(photo.pixels(places_of(source, rays)) - 0.5).astype(int).T
    assert np.array_equal(rays.colours.numpy(), source.picture(photo)[row, column])
    assert np.array_equal(rays.panels.numpy(), source.panel_numbers(photo)[row, column])
    away = (np.column_stack([column, row]) + 0.5 - (20.0, 15.0)) / 25.0
    assert np.abs(rays.off_axis.numpy() - (away**2).sum(axis=1)).max() < 1e-5


def test_a_small_memory_keeps_an_even_random_share(source):
    everything = glass_rays(source, source.photos)
    some = glass_rays(source, source.photos, BYTES_PER_RAY * 800)
    again = glass_rays(source, source.photos, BYTES_PER_RAY * 800)
    assert 0.3 * 800 < len(some) <= 1.1 * 800 < len(everything)
    assert all(torch.equal(getattr(some, name), getattr(again, name)) for name in COLUMNS)
    shares = torch.bincount(some.panels, minlength=6) / torch.bincount(everything.panels, minlength=6)
    assert (shares - shares.mean()).abs().max() < 0.6 * shares.mean()
    assert not torch.equal(some.rows, glass_rays(source, source.photos, BYTES_PER_RAY * 800, seed=1).rows)


@pytest.mark.parametrize("side_px", [2, 3])
@pytest.mark.parametrize("which", ["whole", "middle"])
def test_squares_of_pixels_hold_the_rays_that_each_pixel_says(source, which, side_px, monkeypatch):
    looked_at = []
    monkeypatch.setattr(
        RayTable, "holds", lambda *given, plain=RayTable.holds: looked_at.append(given) or plain(*given)
    )
    monkeypatch.setattr(rays_of_glass, "SQUARE_PX", side_px)
    squares = glass_rays(source, source.photos, which=which)
    n_looked_at = sum(len(photos) for _, photos, *_ in looked_at)
    monkeypatch.setattr(rays_of_glass, "SQUARE_PX", 10_000)
    looked_at.clear()
    pixels = glass_rays(source, source.photos, which=which)
    assert all(torch.equal(getattr(squares, name), getattr(pixels, name)) for name in COLUMNS)
    assert n_looked_at < sum(len(photos) for _, photos, *_ in looked_at)


def test_a_ray_takes_as_many_bytes_as_is_said(source):
    rays = glass_rays(source, source.photos)
    taken = sum(getattr(rays, name).nbytes for name in COLUMNS)
    assert taken == BYTES_PER_RAY * len(rays)


def test_photos_that_show_no_glass_and_no_photos_have_no_rays(source):
    assert len(glass_rays(source, ())) == 0
    photo = source.photos[0]
    turned = replace(photo, pose=replace(photo.pose, cam_from_enu=np.diag([-1.0, 1.0, -1.0]) @ photo.pose.cam_from_enu))
    rays = rays_of_photo(source, turned)
    assert len(rays) == 0
    assert rays.colours.shape == (0, 3)


def test_a_camera_in_the_panels_plane_or_behind_them_gives_no_rays_and_no_warnings(source):
    photo = source.photos[0]
    for y in (0.0, -1e-9, 3.0):
        position = np.array([-20.0, y, 3.0])
        assert len(rays_of_photo(source, replace(photo, pose=replace(photo.pose, position_enu_m=position)))) == 0


def test_a_cancelled_reading_says_so(source):
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        glass_rays(source, source.photos, monitor=Cancelling())


def test_joining_keeps_order(source):
    rays = glass_rays(source, source.photos)
    parts = [rays[:100], rays[100:150], rays[150:]]
    whole = joined(parts)
    assert len(whole) == len(rays)
    assert torch.equal(whole[100:150].colours, parts[1].colours)


def test_rays_of_many_photos_are_those_of_each(source):
    whole = glass_rays(source, source.photos)
    for number, photo in enumerate(source.photos):
        alone = rays_of_photo(source, photo)
        part = whole[torch.nonzero(whole.photos == number).squeeze(1)]
        assert torch.equal(part.middle().omega_r, alone.middle().omega_r)
        assert torch.equal(part.colours, alone.colours)


def test_pixels_whose_middle_lies_on_a_panel_are_more_than_whole_ones_and_hold_them(source):
    whole, middle = (glass_rays(source, source.photos, which=which) for which in ("whole", "middle"))
    drawn = sum(int((source.panel_numbers(photo) >= 0).sum()) for photo in source.photos)
    assert len(whole) < len(middle) == pytest.approx(drawn, abs=4)
    found, every = (
        set(zip(rays.photos.tolist(), rays.rows.tolist(), rays.columns.tolist(), strict=True))
        for rays in (whole, middle)
    )
    assert found < every


def test_pixels_that_are_given_meet_the_plane_of_the_panel_that_is_said(source):
    photo = source.photos[0]
    table = RayTable.of([photo], source.panels, {})
    columns, rows, panels = torch.tensor([3, 20]), torch.tensor([4, 15]), torch.tensor([0, 5])
    rays = rays_of_pixels(table, 0, columns, rows, panels)
    pixels = photo.pixels(places_of(source, rays))
    assert np.abs(pixels - [[3.5, 4.5], [20.5, 15.5]]).max() < 1e-4
    assert rays.colours.sum() == 0


def test_whole_pixels_are_those_whose_corners_all_lie_in_the_drawn_panel(tmp_path):
    write_folder(tmp_path / "photos", far, 3)
    source = read_photo_set(tmp_path / "photos")
    for photo in source.photos:
        expected = 0
        numbers = source.panel_numbers(photo)
        for number, corners in enumerate(source.panels.corners_enu_m):
            outline = photo.pixels(corners).astype(np.float32)
            for row, column in zip(*np.nonzero(numbers == number), strict=True):
                ends = [(column + a, row + b) for a in (0.0, 1.0) for b in (0.0, 1.0)]
                expected += all(cv2.pointPolygonTest(outline, end, False) >= 0 for end in ends)
        assert len(rays_of_photo(source, photo)) == pytest.approx(expected, abs=1)
        assert expected < 0.95 * (numbers >= 0).sum()
