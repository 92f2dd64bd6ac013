"""Several rays a pixel, tilts of panes, corrected poses."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from reconstruction.base.cameras import Pose
from reconstruction.light.config import GlassLearned, ReflectionConfig
from reconstruction.light.glass_light import GlassLight, pixel_offsets
from reconstruction.light.glass_rays import glass_rays, rays_of_pixels
from reconstruction.light.photo_set import PanelPlanes, read_photo_set
from reconstruction.light.ray_table import RayTable
from reconstruction.light.training import train_reflections
from tests.reconstruction.light.synthetic_folder import corners_of, far, write_folder


class Detailed(nn.Module):
    """Light that changes quickly with direction."""

    def forward(self, points, omega_r, panels):
        return torch.sin(60.0 * omega_r)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    folder = tmp_path_factory.mktemp("glass") / "photos"
    write_folder(folder, far, 4)
    return read_photo_set(folder)


def light_of(planes, n_photos=0, **learned):
    return GlassLight(Detailed(), planes, GlassLearned(**learned), n_photos)


def round_tower(n=12):
    """Panels all around a tower."""
    angles = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    panels = []
    for a in angles:
        out, along = np.array([math.sin(a), math.cos(a), 0.0]), np.array([-math.cos(a), math.sin(a), 0.0])
        middle, up = 5.0 * out + [0, 0, 5.0], np.array([0.0, 0.0, 1.0])
        panels.append([middle - along - up, middle + along - up, middle + along + up, middle - along + up])
    return PanelPlanes(np.array(panels))


def test_rays_of_a_pixel_lie_one_in_each_square_of_an_even_grid():
    middles = pixel_offsets(2, 4, None)
    assert torch.equal(middles[:4], torch.tensor([[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]]).double())
    assert torch.equal(middles[4:], middles[:4])
    generator = torch.Generator().manual_seed(0)
    moved = pixel_offsets(500, 9, generator)
    assert torch.equal(
        torch.floor((moved + 0.5) * 3).reshape(500, 9, 2),
        torch.floor((pixel_offsets(500, 9, None) + 0.5) * 3).reshape(500, 9, 2),
    )
    assert moved.mean().abs() < 0.01
    assert torch.equal(moved, pixel_offsets(500, 9, torch.Generator().manual_seed(0)))


def test_a_pixel_has_the_mean_light_of_its_rays(source):
    rays = glass_rays(source, source.photos)[:50]
    many = light_of(source.panels, rays=16)(rays)[0]
    one = light_of(source.panels)
    parts = []
    for offset in pixel_offsets(1, 16, None):
        hits = rays.hits(offset)
        normals = one.normals(rays.table, hits, rays.panels.long())
        directions = hits.directions.float()
        mirrored = directions - 2.0 * (directions * normals).sum(dim=1, keepdim=True) * normals
        parts.append(one.light(None, mirrored, None))
    assert torch.allclose(many, torch.stack(parts).mean(dim=0), atol=1e-4)
    assert (one(rays)[0] - many).abs().max() > 0.05


def test_rays_that_meet_the_frame_beside_a_pane_do_not_count(source):
    photo = source.photos[0]
    corner_px = photo.pixels(source.panels.corners_enu_m[4][:1])[0]
    column, row = (torch.tensor([int(value)]) for value in np.floor(corner_px))
    table = RayTable.of([photo], source.panels, {})
    rays = rays_of_pixels(table, 0, column, row, torch.tensor([4]))
    glass = light_of(source.panels, rays=64)
    shares = rays.repeated(64).hits(pixel_offsets(1, 64, None)).shares
    inside = ((shares >= 0.0) & (shares <= 1.0)).all(dim=1)
    assert 0 < inside.sum() < 64
    hits = rays.repeated(64).hits(pixel_offsets(1, 64, None))
    directions = hits.directions.float()[inside]
    mirrored = directions * torch.tensor([1.0, -1.0, 1.0])
    assert torch.allclose(glass(rays)[0][0], torch.sin(60.0 * mirrored).mean(dim=0), atol=1e-3)


@pytest.mark.parametrize(("planes", "n_common"), [(PanelPlanes(corners_of()), 2), (round_tower(), 3)])
def test_tilts_that_turning_the_surroundings_makes_up_for_are_taken_away(planes, n_common):
    glass = light_of(planes, tilts=True)
    assert glass.common.shape[1] == n_common
    normals = torch.from_numpy(planes.normals_enu).float()
    turn = torch.tensor([0.01, -0.02, 0.015])
    moved = torch.linalg.cross(turn.expand_as(normals), normals)
    with torch.no_grad():
        glass.tilts[:] = (glass.edges * moved[:, None]).sum(dim=2)
    assert glass.true_tilts().abs().max() < 1e-6
    with torch.no_grad():
        glass.tilts[0, 0] += 0.01
    assert glass.true_tilts()[0, 0] > 0.005


def test_a_tilted_pane_mirrors_twice_as_far(source):
    rays = glass_rays(source, source.photos)
    glass = light_of(source.panels, tilts=True)
    with torch.no_grad():
        glass.tilts[:3, 1], glass.tilts[3:, 1] = 0.01, -0.01
    hits, panels = rays.hits(), rays.panels.long()
    normals = glass.normals(rays.table, hits, panels)
    expected = torch.where(panels < 3, 0.01, -0.01)
    assert torch.allclose(torch.asin(normals[:, 2]), torch.atan(expected), atol=1e-6)


def test_mirrored_rays_and_what_tilts_and_bows_learn_are_those_of_plain_torch(source):
    rays = glass_rays(source, source.photos)[:200]
    hits, panels = rays.hits(), rays.panels.long()
    generator = torch.Generator().manual_seed(5)
    weights, more = torch.randn(200, 3, generator=generator), torch.randn(200, generator=generator)
    found = []
    for is_plain in (False, True):
        glass = light_of(source.panels, tilts=True, bows=True)
        with torch.no_grad():
            glass.tilts += torch.linspace(-0.02, 0.03, glass.tilts.numel()).reshape(-1, 2)
            glass.bows += torch.linspace(0.02, -0.01, glass.bows.numel()).reshape(-1, 2)
        if is_plain:
            normals, directions = glass.normals(rays.table, hits, panels), hits.directions.float()
            along = (directions * normals).sum(dim=1, keepdim=True)
            omega_r, cosines = directions - 2.0 * along * normals, along[:, 0].abs()
        else:
            omega_r, cosines = glass.mirrored(rays.table, hits, panels)
        ((omega_r * weights).sum() + (cosines * more).sum()).backward()
        found.append([omega_r.detach(), cosines.detach(), glass.tilts.grad, glass.bows.grad])
    for value, truth in zip(*found, strict=True):
        assert (value - truth).norm() < 1e-5 * truth.norm()


@pytest.mark.slow
def test_tilts_of_panes_are_found_from_what_they_mirror(tmp_path):
    leans = np.array([0.012, -0.008, 0.0, 0.01, -0.012, -0.002])

    def tilted(places, omega_r):
        column = np.clip(np.floor((places[:, 0] + 3.0) / 2.0), 0, 2)
        which = (column + 3 * (places[:, 2] > 3.0)).astype(int)
        turned = omega_r.copy()
        turned[:, 2] += 2.0 * leans[which] * -omega_r[:, 1]
        return far(places, turned / np.linalg.norm(turned, axis=1, keepdims=True))

    write_folder(tmp_path / "photos", tilted, 16)
    source = read_photo_set(tmp_path / "photos")
    config = ReflectionConfig(
        environment_rows=32, steps=120, batch=1024, warm_up=10, learned=GlassLearned(tilts=True), diffuse_degree=0
    )
    config = replace(config, grid=replace(config.grid, tilt_rate=1.5e-3))
    trained = train_reflections(glass_rays(source, source.photos), source.panels, "environment-map", config)
    found = trained.panels.light.true_tilts().detach().numpy()
    assert found[:, 1] == pytest.approx(leans - leans.mean(), abs=0.0045)
    assert np.abs(found[:, 0]).max() < 0.005


def test_a_corrected_pose_gives_the_rays_of_the_moved_camera(source):
    photo = source.photos[0]
    shift, turn = np.array([0.02, -0.01, 0.03]), np.array([1e-4, -2e-4, 1.5e-4])
    x, y, z = turn
    moved = replace(photo, pose=Pose(photo.pose.position_enu_m + shift, photo.pose.cam_from_enu))
    rotation = np.eye(3) + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    table, other = (RayTable.of([p], source.panels, {}) for p in (photo, moved))
    other = replace(other, enu_from_cam=torch.from_numpy(rotation) @ table.enu_from_cam)
    args = (torch.zeros(2, dtype=torch.long), torch.tensor([[10.0, 12.0], [30.0, 20.0]]).double(), torch.tensor([1, 3]))
    moves = torch.from_numpy(np.concatenate([shift, turn]))[None]
    found, expected = table.meet(*args, moves), other.meet(*args)
    assert torch.allclose(found.points_m, expected.points_m, atol=1e-6)
    assert torch.allclose(found.directions, expected.directions, atol=1e-6)


def test_poses_are_corrected_while_learning_only_and_not_all_alike(source):
    rays = glass_rays(source, source.photos)[:20]
    glass = light_of(source.panels, len(source.photos), poses=True)
    plain = light_of(source.panels)(rays)[0]
    with torch.no_grad():
        glass.moves += 0.1
    assert torch.allclose(glass(rays)[0], plain, atol=1e-3)
    with torch.no_grad():
        glass.moves[0, 5] += 0.01
    assert not torch.allclose(glass(rays)[0], plain, atol=1e-2)
    assert torch.equal(glass.eval()(rays)[0], plain)


@pytest.mark.parametrize("rays", [0, 3, -4])
def test_numbers_of_rays_that_are_no_squares_are_refused(rays):
    with pytest.raises(ValueError, match="square"):
        GlassLearned(rays=rays)
