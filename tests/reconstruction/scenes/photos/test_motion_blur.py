"""Motion blur: pictures taken from where the camera is during the exposure, of things and of their mirror images."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base import jit
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import MOTION_BLUR, RenderSettings
from reconstruction.scenes.photos.camera_model import CameraModel, Moment
from reconstruction.scenes.photos.motion_blur import MOST_TIMES, moved_px, n_times, times, windows
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Layer, Scene, Sky
from tests.reconstruction.scenes.small_scenes import facing_south, photo, quad, scene

FROM_NORTH = Sky(
    sun=(1.0, 1.0, 1.0), zenith=(0.0, 0.0, 0.0), horizon=(0.0, 0.0, 0.0), sun_heading_deg=0.0, sun_elevation_deg=30.0
)
"""Light on what faces the panes; all else is black."""

PLAIN = RenderSettings(effects={"shadow": "off", "sky occlusion": "off"})
SMALL = {"width_px": 128, "height_px": 24, "focal_px": 300.0}
DIRECT_M, MIRRORED_M = 10.0, 30.0
"""From the camera to the board, and to its mirror image."""


def half_board() -> Scene:
    """A pane in the north of the camera and a light board in its south that ends above the origin."""
    board = quad([(0, -20, 0), (-12, -20, 0), (-12, -20, 24), (0, -20, 24)], "board", Layer.NEAR)
    return scene(board, sky=FROM_NORTH, room=0.0, corners=facing_south(60.0, 20.0))


def taken(heading_deg: float, moved_m: float, settings: RenderSettings = PLAIN) -> RenderedPhoto:
    """From between pane and board, moving to the east."""
    return Renderer(half_board(), settings).render(
        photo(heading_deg=heading_deg, **SMALL), moved_enu_m=np.array([moved_m, 0.0, 0.0])
    )


def profile(light: NDArray[np.float32]) -> NDArray[np.float64]:
    """Of the middle row around the board's edge, 0 to 1, dark first."""
    row = light[12, 28:100, 0].astype(float)
    row = row[::-1] if row[0] > row[-1] else row
    return row / row[-1]


PLACES_PX = np.arange(-36, 36) + 0.5


def ramp(wide_px: float) -> NDArray[np.float64]:
    """An edge in the middle that moves by a width, as pixels see it: its mean over each."""

    def area(upto: NDArray[np.float64]) -> NDArray[np.float64]:
        inside = np.clip(upto + 0.5 * wide_px, 0.0, wide_px)
        return inside**2 / (2.0 * wide_px) + np.maximum(upto - 0.5 * wide_px, 0.0)

    return area(PLACES_PX + 0.5) - area(PLACES_PX - 0.5)


def width_px(edge: NDArray[np.float64]) -> float:
    """Width of the ramp that is most like an edge."""
    widths = np.arange(0.05, 30.0, 0.05)
    return float(widths[np.argmin([((ramp(width) - edge) ** 2).sum() for width in widths])])


@pytest.mark.few(2)
@pytest.mark.parametrize("wide_px", [1.0, 3.0, 7.3, 20.0])
@pytest.mark.parametrize(
    ("heading_deg", "away_m", "layer"), [(180.0, DIRECT_M, "diffuse"), (0.0, MIRRORED_M, "reflection")]
)
def test_an_edge_becomes_a_ramp_as_wide_as_the_picture_moves(
    heading_deg: float, away_m: float, layer: str, wide_px: float
) -> None:
    edge = profile(getattr(taken(heading_deg, wide_px * away_m / SMALL["focal_px"]), layer))
    # Of nine rays and more: a pixel is off by a step or so, and the ramp by a third of a pixel.
    assert np.abs(edge - ramp(wide_px)).max() < 0.13
    assert width_px(edge) == pytest.approx(wide_px, rel=0.05, abs=0.4)


def test_a_mirror_image_moves_less_than_its_mirror() -> None:
    # The pane itself would move 9 px.
    assert width_px(profile(taken(0.0, 0.3).reflection)) == pytest.approx(3.0, abs=0.15)


@pytest.mark.parametrize("moved_m", [0.02, 0.1, 0.4])
def test_light_is_kept(moved_m: float) -> None:
    still, moving = taken(180.0, 0.0), taken(180.0, moved_m)
    inside = np.s_[:, 20:108]
    assert moving.linear[inside].sum() == pytest.approx(still.linear[inside].sum(), rel=4e-3)
    assert moving.linear.max() <= still.linear.max() + 1e-6


def test_a_camera_that_is_held_still_costs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    still = taken(0.0, 0.0)
    monkeypatch.setattr(Renderer, "_blur", None)
    off = taken(0.0, 0.3, replace(PLAIN, effects={**PLAIN.effects, MOTION_BLUR: "off"}))
    without = Renderer(half_board(), PLAIN).render(photo(heading_deg=0.0, **SMALL))
    for other in (off, without):
        assert (other.linear == still.linear).all()


def test_what_is_true_is_that_of_the_exposures_middle() -> None:
    still, moving = taken(0.0, 0.0), taken(0.0, 0.3)
    for name in ("depth_m", "normal_enu", "panel", "is_glass"):
        assert (getattr(still, name) == getattr(moving, name)).all()
    assert np.abs(moving.linear - moving.diffuse - moving.reflection).max() < 1e-6


@pytest.mark.parametrize("samples", ["auto", 2])
def test_the_same_picture_for_any_number_of_threads(samples: object, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = replace(PLAIN, samples=samples)
    pictures = []
    for n in (1, 3):
        monkeypatch.setattr(jit, "n_threads", lambda n=n: n)
        pictures.append(taken(180.0, 0.1, settings).linear)
    assert (pictures[0] == pictures[1]).all()


def test_moments_are_spread_evenly_and_no_side_of_a_pixel_comes_first() -> None:
    for side, n in ((1, 1), (1, 4), (2, 3), (3, 1), (3, 8), (5, 2)):
        all_times = times(side, n)
        assert all_times.shape == (side * side, n)
        assert np.sort(all_times.ravel()) == pytest.approx((np.arange(side * side * n) + 0.5) / (side * side * n) - 0.5)
        if side % 2:
            square = all_times.mean(axis=1).reshape(side, side)
            assert square.mean(axis=0) == pytest.approx(0.0, abs=1e-12)
            assert square.mean(axis=1) == pytest.approx(0.0, abs=1e-12)


def test_what_is_near_or_beside_the_way_moves_as_the_camera_projects_it() -> None:
    camera = photo((0.0, -10.0, 10.0), 20.0, -10.0)
    rng = np.random.default_rng(0)
    way = np.array([0.03, -0.02, 0.01])
    depth = rng.uniform(3.0, 50.0, (192, 256)).astype(np.float32)
    right, down = moved_px(camera, way, depth)
    for y, x in rng.integers(0, 192, (20, 2)):
        ray = camera.intrinsics.rays(np.array([[x + 0.5, y + 0.5]]))
        point = camera.pose.position_enu_m + depth[y, x] * camera.pose.directions_enu(ray)
        ends = [
            replace(camera, pose=replace(camera.pose, position_enu_m=camera.pose.position_enu_m + s * way)).pixels(
                point
            )
            for s in (-0.5, 0.5)
        ]
        assert (right[y, x], down[y, x]) == pytest.approx(tuple((ends[1] - ends[0])[0]), abs=2e-3)


@pytest.mark.parametrize(("speed_m_s", "used"), [(0.0, False), (1.0, False), (20.0, True)])
def test_the_scene_decides_by_how_far_the_picture_moves(speed_m_s: float, used: bool) -> None:
    made, camera = half_board(), photo(heading_deg=180.0, **SMALL)
    moment = Moment(0, (speed_m_s, 0.0, 0.0), 0.002)
    decided = decide_effects(made, [camera], RenderSettings(), CameraModel(), [moment])[MOTION_BLUR]
    size_px = moment.moved_m * SMALL["focal_px"] / DIRECT_M
    # Off the picture's middle things are further away.
    assert decided.size == pytest.approx(size_px, rel=0.15, abs=1e-9)
    assert decided.on == used
    assert used == (width_px(profile(taken(180.0, moment.moved_m).diffuse)) > decided.tolerance)
    if not speed_m_s:
        assert (decided.cost_s, decided.reason) == (0.0, "the camera is held still for every photo")


def test_no_speed_or_exposure_breaks_a_picture() -> None:
    tiny = {"width_px": 24, "height_px": 16, "focal_px": 30.0}
    made = half_board()
    for way in ([3000.0, 0.0, 0.0], [0.0, 40.0, 0.0], [1e-12, 0.0, 0.0], [0.0, 0.0, -15.0]):
        for place in ((0.0, -10.0, 10.0), (0.0, -0.001, 10.0)):
            light = Renderer(made, PLAIN).render(photo(place, **tiny), moved_enu_m=np.array(way)).linear
            assert np.isfinite(light).all()
            assert light.min() >= 0.0
    assert n_times(*(2 * [np.full((4, 4), 1e30, np.float32)]), window=(4, 4)).max() == MOST_TIMES
    assert windows(*(2 * [np.full((4, 6), 1e30, np.float32)])) == (6, 4)
