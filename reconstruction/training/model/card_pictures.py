"""Pictures of a model by a graphics card on which it stays: splats, what panes mirror, sky, lens, all by its kernels.

The kernels are those of `rasterising.wgpu_backend` and of web pages (`gpu/data/mirrored.wgsl`). Splats, harmonics and
light are brought to the card once; for each picture go the camera there and bytes of colours and depths come back, and
which panel is where, which the processor says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from reconstruction.gpu.device import TEXELS_A_ROW, Commands, Device, Piece, rounded_up, uniform
from reconstruction.gpu.sorting import groups_of
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import Bins, SplatsOnCard, check_number
from reconstruction.training.methods.shader import Shader
from reconstruction.training.model.joint_model import MOST_LOST, SceneModel, panels_in_view
from reconstruction.training.model.pane_mirrors import PaneMirrors, mirrors_of
from reconstruction.training.model.render import Rendered

QUADS = 2
"""Of channels: (1 - R) c and R, and R F0."""
LOOK_QUADS = 13
"""Of what splats look like: F0 and R, and 48 coefficients."""

RAYS_AT_ONCE = 1 << 19
"""Mirrored rays that a network is asked about; a window with more is shaded in strips: 16 MB of lists."""


def can_stay(model: SceneModel) -> bool:
    """Whether the card's kernels know all that a model shows."""
    if len(model.splats) == 0 or type(model.shader) is not Shader or model.splats.means.device.type != "cpu":
        return False
    return model.light is None or mirrors_of(model) is not None


class CardPictures:
    """Renders one model.

    Parameters
    ----------
    model
        That `can_stay`.

    Raises
    ------
    DeviceFailed
        The card fails, or has too little memory.
    """

    def __init__(self, model: SceneModel, device: Device) -> None:
        self._model, self._device = model, device
        with device.errors_said(), torch.no_grad():
            splats = model.splats
            check_number(len(splats), device.most_texels // LOOK_QUADS)
            self._splats = SplatsOnCard(device, splats.means, splats.quats, splats.scales, splats.opacities)
            self._looks = device.table(LOOK_QUADS * self._splats.n)
            device.write_table(self._looks, _looks(model))
            self._features = device.table(QUADS * self._splats.n)
            self._sky = device.picture([_with_alpha(model.sky.picture())])
            mirrors = None if model.light is None else mirrors_of(model)
            self._mirrors = _MirrorsOnCard(device, mirrors, model.corners_m)

    def picture(self, view: View, gain: Tensor | float, settings: RasterSettings) -> Rendered:
        """A view with its layer `depth`; see `render.render_view`.

        Raises
        ------
        DeviceFailed
            The card fails, or has too little memory.
        """
        device, size = self._device, (view.height_px, view.width_px)
        n_pixels = size[0] * size[1]
        numbers = np.zeros(size, np.uint32)
        if self._mirrors.has_panes:
            numbers[:] = panels_in_view(view, self._model.corners_m) + 1
        with device.errors_said():
            panes, shown, depths = (device.buffer(4 * n_pixels) for _ in range(3))
            device.write(panes, numbers)
            commands = device.commands()
            eye = [float(each) for each in view.position_m]
            commands.run(
                *("colour_splats", {"TEXELS_A_ROW": TEXELS_A_ROW}, groups_of(self._splats.n)),
                *(uniform(*eye, float(self._splats.n)), self._splats.parameters, self._looks, self._features),
            )
            commands.submit()
            for bins, channels, states in self._splats.blended(view, settings, self._features, QUADS):
                given = _Given(channels, states, panes, shown, depths)
                self._shade(view, gain, bins, given)
            bytes_, far = device.read((shown, 4 * n_pixels), (depths, 4 * n_pixels))
        display = bytes_.reshape(*size, 4)[..., :3] * np.float32(1.0 / 255.0)
        depth = far.view(np.float32).reshape(size)
        return Rendered(display, {"depth": np.where(depth < 0.0, np.float32(np.inf), depth)})

    def _shade(self, view: View, gain: Tensor | float, bins: Bins, given: _Given) -> None:
        """From the sums of a window's splats to its part of the picture."""
        device, mirrors = self._device, self._mirrors
        rows, columns = bins.pixels(view)
        size = columns.stop - columns.start, rows.stop - rows.start
        n_pixels, at_once = size[0] * size[1], size[0] * size[1]
        is_network = mirrors.network is not None
        if is_network:
            at_once = max(RAYS_AT_ONCE // mirrors.rays**2, 1)
        n_rays = min(at_once, n_pixels) * mirrors.rays**2 if is_network else 1
        firsts = device.buffer(4 * n_pixels if is_network else 4)
        rays, answers, counter = device.buffer(32 * n_rays), device.buffer(16 * n_rays), device.buffer(4)
        for start in range(0, n_pixels, at_once):
            count = min(at_once, n_pixels - start)
            looking = self._looking(view, gain, (columns.start, rows.start, *size, start, count))
            shared = looking, given.channels, given.panes, *mirrors.bindings, answers
            commands = device.commands()
            if mirrors.network is not None:
                commands.clear(counter, 4)
                commands.run("list_rays", {}, groups_of(count), *shared, rays, counter, firsts)
                mirrors.ask(commands, rays, counter, answers, count * mirrors.rays**2)
            own = self._sky, given.states, firsts, given.shown, given.depths
            commands.run("shade", {}, groups_of(count), *shared, *own)
            commands.submit()

    def _looking(self, view: View, gain: Tensor | float, window: tuple[int, ...]) -> bytes:
        """`Shading` of shading.wgsl."""
        right, down, forward = view.cam_from_world[:3, :3].tolist()
        eye, gains = view.position_m.tolist(), torch.as_tensor(gain, dtype=torch.float32).detach().expand(3).tolist()
        model = self._model
        lens = view.fx_px, view.fy_px, view.cx_px, view.cy_px
        return uniform(
            *(float(each) for each in (*eye, self._mirrors.rays, *right, model.corner_square)),
            *(float(each) for each in (*down, float(model.corner_loss.detach()), *forward, MOST_LOST, *lens, *gains)),
            *(view.width_px, *window),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Given:
    """Buffers of one picture."""

    channels: Piece
    states: Piece
    panes: Piece
    shown: Piece
    depths: Piece


class _MirrorsOnCard:
    """What `mirrored.wgsl` reads of a model; of one without mirrors, nothing that is looked at."""

    def __init__(self, device: Device, mirrors: PaneMirrors | None, corners_m: NDArray[np.float64]) -> None:
        self.has_panes = mirrors is not None and len(corners_m) > 0
        self.rays = 1 if mirrors is None else mirrors.rays
        self.network = None if mirrors is None else mirrors.network
        nothing = np.zeros((2, 2, 2, 4), np.float16)
        numbers = np.zeros(24, np.float32) if mirrors is None else mirrors.light_numbers()
        panes = np.zeros((1, 4, 4), np.float32)
        if mirrors is not None and self.has_panes:
            panes = mirrors.pane_numbers(corners_m)
        of_panes = device.buffer(panes.nbytes)
        device.write(of_panes, panes)
        self.bindings = (
            numbers.tobytes(),
            of_panes,
            device.picture([nothing if mirrors is None else mirrors.cells]),
            device.picture([nothing[..., 0].astype(np.uint8) if mirrors is None else mirrors.skips]),
            device.picture([nothing[0]] if mirrors is None else mirrors.far),
            device.sampler(is_round=False),
            device.sampler(is_round=True),
        )
        self._weights: Piece | None = None
        if self.network is not None:
            self._weights = device.buffer(self.network.words.nbytes)
            device.write(self._weights, self.network.words)

    def ask(self, commands: Commands, rays: Piece, counter: Piece, answers: Piece, most: int) -> None:
        """Ask the network about a list of rays, which has so many at most."""
        assert self.network is not None
        assert self._weights is not None
        groups = rounded_up(most, self.network.rays_a_group)
        commands.run("ask_network", {}, groups, uniform(*self.network.numbers), self._weights, rays, counter, answers)


def _looks(model: SceneModel) -> NDArray[np.float32]:
    """What `colour_splats.wgsl` reads of splats, shape (13 n, 4); what is on no panel mirrors nothing."""
    splats = model.splats
    shares = torch.sigmoid(splats.reflectivity_logits) * (splats.panels >= 0) * (model.light is not None)
    own = torch.cat([torch.sigmoid(splats.f0_logits), shares[:, None], splats.sh.flatten(1)], dim=1)
    return np.ascontiguousarray(own.numpy(), np.float32).reshape(-1, 4)


def _with_alpha(colours: Tensor) -> NDArray[np.float16]:
    return np.pad(colours.detach().cpu().numpy().astype(np.float16), ((0, 0), (0, 0), (0, 1)))
