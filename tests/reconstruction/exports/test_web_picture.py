"""Web pages in Chromium and Firefox: pictures and picking at every pixel against slow references."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from reconstruction.exports.component_parts import THICKNESS_M, ellipsoids_of_all
from reconstruction.objects.gs_scene import GsComponent, GsElement
from reconstruction.records.entries import global_id_of
from reconstruction.splats.rasterising.projection import areas_of, blurred, blurred_areas2, project
from reconstruction.splats.rasterising.raster_types import steepest
from reconstruction.splats.rasterising.views import View
from tests.reconstruction.exports.hard_scenes import antialiased
from tests.reconstruction.exports.test_ellipsoids import standard_harmonics
from tests.reconstruction.exports.web_browser import axes_of, opened
from tests.reconstruction.objects.synthetic_scene import gaussians, synthetic_scene

ORIGIN_ENU_M = (100.0, -20.0, 5.0)


def light(display):
    c = np.clip(display, 0.0, 1.0)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def display(light_):
    return np.where(light_ <= 0.0031308, 12.92 * light_, 1.055 * np.maximum(light_, 1e-9) ** (1 / 2.4) - 0.055)


def drawn(found, degree, camera, is_antialiased=False, blur=0.3):
    """Slow reference: every Gaussian at every pixel, from far to near.

    Ellipsoids as in Zwicker et al. (2001) and Kerbl et al. (2023), discs where rays meet them (Huang et al., 2024).
    Antialiased as Yu et al. (2024) have it, but for the least opacity.
    """
    width, height, focal = camera["width"], camera["height"], camera["focal"]
    axes = axes_of(camera)
    points = (found.means_m.astype(float) - camera["eye"]) @ axes.T
    towards = found.means_m - np.asarray(camera["eye"])
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    n = (degree + 1) ** 2
    colours = light(0.5 + np.einsum("nk,nkc->nc", standard_harmonics(towards)[:, :n], found.sh[:, :n]))
    picture = np.broadcast_to(light(np.full(3, 128 / 255)), (height, width, 3)).copy()
    ys, xs = np.mgrid[:height, :width] + 0.5
    discs = discs_of(found, camera, blur)
    for i in np.argsort(-points[:, 2], kind="stable"):
        x, y, z = points[i]
        if z < 0.2:
            continue
        d = np.stack([xs - width / 2 - focal * x / z, ys - height / 2 - focal * y / z], axis=-1)
        if found.scales_m[i, 2] <= THICKNESS_M:
            squared, share = meeting(d, z, *(each[i] for each in discs))
        else:
            squared, share = within_ellipse(d, points[i], axes, found, i, camera, blur)
        opacity = found.opacities[i]
        if is_antialiased:
            opacity = min(opacity, max(opacity * share, 2 / 255))
        alpha = opacity * np.exp(-0.5 * squared)
        alpha = np.where(alpha < 1 / 255, 0.0, np.minimum(alpha, 0.99))[..., None]
        picture = picture * (1 - alpha) + colours[i] * alpha
    return display(picture)


def discs_of(found, camera, blur):
    """J', q' and the shares of what is drawn of all Gaussians, taken for discs."""
    view = view_of(camera)
    values = (torch.from_numpy(each.astype(float)) for each in (found.means_m, found.quats, found.scales_m[:, :2]))
    sharp = project(*values, view)
    wide = blurred(sharp, math.sqrt(blur), steepest(camera["focal"]))
    shares = areas_of(sharp.jacobians_px).abs() / blurred_areas2(sharp.jacobians_px, math.sqrt(blur)).sqrt()
    return wide.jacobians_px.numpy(), wide.slopes.numpy(), shares.numpy()


def meeting(d, z, jacobian, slopes, share):
    """Squared distance in standard deviations at which the ray of each pixel meets a disc before the camera."""
    relative = 1.0 - d @ np.linalg.solve(jacobian.T, slopes)
    depth = z / np.where(relative > 0.0, relative, np.nan)
    uv = d @ np.linalg.inv(jacobian).T / relative[..., None]
    return np.where(depth > 0.1, (uv**2).sum(axis=-1), np.inf), share


def within_ellipse(d, point, axes, found, i, camera, blur):
    """Squared distance in standard deviations of each pixel from an ellipsoid's middle, in its picture."""
    width, height, focal = camera["width"], camera["height"], camera["focal"]
    x, y, z = point
    w, a, b, c = found.quats[i].astype(float)
    turn = np.array(
        [
            [1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)],
            [2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)],
            [2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)],
        ]
    )
    spread = turn @ np.diag(found.scales_m[i].astype(float) ** 2) @ turn.T
    limit = 1.3 * np.array([width, height]) / (2 * focal)
    tx, ty = np.clip([x / z, y / z], -limit, limit)
    jacobian = focal / z * np.array([[1, 0, -tx], [0, 1, -ty]])
    sharp = jacobian @ axes @ spread @ axes.T @ jacobian.T
    blurred_ = sharp + blur * np.eye(2)
    squared = np.einsum("hwi,ij,hwj->hw", d, np.linalg.inv(blurred_), d)
    return squared, np.sqrt(max(np.linalg.det(sharp), 0.0) / np.linalg.det(blurred_))


def view_of(camera):
    """The page's camera as the program's own."""
    axes, cam_from_world = axes_of(camera), torch.eye(4, dtype=torch.float64)
    cam_from_world[:3, :3] = torch.from_numpy(axes)
    cam_from_world[:3, 3] = torch.from_numpy(-axes @ np.asarray(camera["eye"], float))
    width, height, focal = camera["width"], camera["height"], camera["focal"]
    return View(width, height, focal, focal, width / 2, height / 2, cam_from_world)


def solid(scene, seed=0):
    """The scene with ellipsoids in the place of discs."""
    rng = np.random.default_rng(seed)
    for component in scene.components:
        values = component.gaussians.values
        third = values["log_scales"][:, :1] + rng.uniform(-1.5, 0.5, (len(values["log_scales"]), 1)).astype(np.float32)
        values["log_scales"] = np.concatenate([values["log_scales"], third], axis=1)
    return scene


@pytest.mark.slow
@pytest.mark.parametrize(
    ("is_on", "blur", "is_flat"), [(True, 0.3, True), (True, 0.1, True), (False, 0.3, True), (True, 0.1, False)]
)
def test_what_is_finer_than_a_pixel_is_as_much_more_transparent_where_it_was_learned_so(
    any_browser, tmp_path, is_on, blur, is_flat
):
    scene = antialiased(synthetic_scene(sizes=((10, 10),), n_background=60, seed=1), is_on, math.sqrt(blur))
    for component in scene.components:
        component.gaussians.values["means"][:] *= 0.8
        component.gaussians.values["log_scales"][:] -= 1.5
        component.gaussians.values["sh"][:] *= 0.4
    scene = scene if is_flat else solid(scene)
    opened(any_browser, tmp_path / "page", scene, size=(260, 330), degree=0)
    any_browser.run("reflight.look(...arguments)", [0, -9, 0], 0, 0)
    any_browser.settled()
    shown, camera = any_browser.pixels() / 255.0, any_browser.run("return reflight.camera()")
    found = ellipsoids_of_all(scene.components)
    expected, other = (drawn(found, 0, camera, each, blur) for each in (is_on, not is_on))
    assert psnr(shown, expected) > 42.0
    assert psnr(shown, other) < psnr(shown, expected) - 3.0
    assert any_browser.errors() == []


def psnr(a, b):
    return -10.0 * np.log10(np.mean((a - b) ** 2))


@pytest.mark.slow
@pytest.mark.parametrize(("degree", "is_flat"), [(0, True), (1, True), (2, True), (3, True), (3, False)])
def test_pictures_are_those_of_the_slow_reference(any_browser, tmp_path, degree, is_flat):
    whole = synthetic_scene(sizes=((10, 10),), n_background=30, seed=degree)
    for component in whole.components:
        component.gaussians.values["means"][:] *= 0.8
        component.gaussians.values["log_scales"][:] += 1.5
        component.gaussians.values["sh"][:] *= 0.4
    whole = whole if is_flat else solid(whole)
    opened(any_browser, tmp_path / "page", whole, size=(260, 330), degree=degree)
    found = ellipsoids_of_all(whole.components)
    for eye, heading, pitch in [((0, -5, 0), 0, 0), ((3, 3, 2), -135, -25), ((0.1, -1.2, 0.3), 40, 15)]:
        any_browser.run("reflight.look(...arguments)", list(eye), heading, pitch)
        any_browser.settled()
        shown = any_browser.pixels() / 255.0
        expected = drawn(found, degree, any_browser.run("return reflight.camera()"))
        assert shown.shape == expected.shape
        assert psnr(shown, expected) > 42.0
        assert np.abs(shown - expected).max() < 0.06
        # There is something in it: a mirrored one is not like it.
        assert psnr(shown[:, ::-1], expected) < 35.0
    assert any_browser.errors() == []


@pytest.mark.slow
def test_the_sky_lies_in_its_directions(any_browser, tmp_path):
    sky = np.zeros((32, 64, 3), np.float16)
    sky[:16, :, 2] = light(200 / 255)
    sky[:, 32:48, 0] = light(220 / 255)  # north, which is in the middle, to east
    opened(any_browser, tmp_path / "page", synthetic_scene(sizes=((0,),), n_background=0), size=(300, 500), sky=sky)
    above, below = {45: (220, 0, 200), -45: (0, 0, 200), 200: (0, 0, 200)}, {45: (220, 0, 0), -45: (0, 0, 0)}
    for pitch, expected in [(60, above), (-45, below)]:
        for heading, colour in expected.items():
            any_browser.run("reflight.look([0, 500, 0], ...arguments)", heading, pitch)
            any_browser.settled()
            shown = any_browser.pixels()
            found = shown[shown.shape[0] // 2, shown.shape[1] // 2].astype(int)
            assert np.abs(found - colour).max() <= 1


def crossing_panes(n=40, seed=3):
    """Quads of all kinds of shapes at all angles, many behind one another, without Gaussians."""
    rng = np.random.default_rng(seed)
    elements = []
    for panel in range(n):
        u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
        angles = np.sort(rng.uniform(0, 2 * np.pi, 4)) if panel % 2 else np.arange(4) * np.pi / 2 + rng.uniform(0, 1)
        middle = rng.uniform(-3, 3, 3) + ORIGIN_ENU_M
        corners = tuple(tuple(middle + 1.2 * (np.cos(angle) * u + np.sin(angle) * v)) for angle in angles)
        name = f"A-{panel:04d}"
        elements.append(GsElement(global_id_of("x", name), name, panel, corners, 0, 0))
    facade = GsComponent(global_id_of("x", "A"), "A", "facade", tuple(elements), gaussians(0, rng))
    scene = synthetic_scene(sizes=((0,),), n_background=0)
    return replace(scene, components=(facade,), origin_enu_m=ORIGIN_ENU_M)


def nearest_panes(elements, eye, directions):
    """Nearest pane of each ray, -1 for none: signed areas in a plane's own coordinates."""
    nearest, found = np.full(len(directions), np.inf), np.full(len(directions), -1)
    for number, element in enumerate(elements):
        corners = np.asarray(element.corners_enu_m) - ORIGIN_ENU_M
        middle = corners.mean(axis=0)
        normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
        u = corners[1] - corners[0]
        plane = np.stack([u, np.cross(normal, u)], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (middle - eye) @ normal / (directions @ normal)
            x, y = ((eye + t[:, None] * directions - middle) @ plane).T
        quad = (corners - middle) @ plane
        is_inside = (t > 0) & (t < nearest)
        for (ax, ay), (bx, by) in zip(quad, np.roll(quad, -1, axis=0), strict=True):
            is_inside &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0
        nearest[is_inside], found[is_inside] = t[is_inside], number
    return found


@pytest.mark.slow
def test_picking_is_right_at_all_pixels_of_a_grid(any_browser, tmp_path):
    scene = crossing_panes()
    opened(any_browser, tmp_path / "page", scene, size=(900, 500))
    elements = scene.components[0].elements
    n_hits = 0
    for eye, heading, pitch in [((0, -9, 0), 0, 0), ((6, 5, 4), -130, -20), ((0.2, 0.1, 0.4), 77, 12)]:
        any_browser.run("reflight.look(...arguments)", list(eye), heading, pitch)
        camera = any_browser.run("return reflight.camera()")
        xs, ys = np.meshgrid(np.arange(2.5, camera["width"], 5), np.arange(2.5, camera["height"], 5))
        places = np.stack([xs.ravel(), ys.ravel()], 1)
        picked = any_browser.run("return arguments[0].map((place) => reflight.at(...place))", places.tolist())
        tangents = (places - [camera["width"] / 2, camera["height"] / 2]) / camera["focal"]
        directions = np.column_stack([tangents, np.ones(len(tangents))]) @ axes_of(camera)
        expected = nearest_panes(elements, np.asarray(eye, float), directions)
        assert picked == [None if number < 0 else elements[number].global_id for number in expected]
        n_hits += int((expected >= 0).sum())
    assert n_hits > 3000
