"""The joint model: splats, the light that glass mirrors, the sky, and the camera's part (paper Eqs. 15 to 21).

A view is rasterised once; where a panel mirrors, colour c, reflectivity R and base reflectance F0 are shaded with the
light L from where the mirrored ray goes: I = (1 - R) c + R F L. All of it is linear light in the model's frame (ENU
less `origin_enu_m`); gain, vignetting and the sRGB curve come last.

The paper blends c, R and F0 each for itself, which are then those of no surface where a pixel shares glass and frame:
with half of each, R = 0.8 of the glass would take 0.4 of the frame's light. I is linear in (1 - R) c, R and R F0, so
these are what is blended here: one mirrored ray for each pixel, and the sum over surfaces that each is shaded for
itself. Where all splats of a pixel are alike both are the same.

With the panels' planes, light is mirrored only where there is one to mirror: elsewhere a pixel that some glass splat
reaches into shows (1 - R) c alone. With the splats' own, it is wherever some glass splat is: a pixel that a frame's
splat weighs most in still mirrors by the share of the glass in it, and has a gradient that can bring the frame's weight
down.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.dataset.layers import draw_panels, facing
from reconstruction.light.config import Precision, ReflectionConfig
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import rays_of_pixels
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.ray_table import RayTable
from reconstruction.light.shading import display_from_linear, incidence_cosines, reflected_directions, schlick
from reconstruction.splats.rasterising.raster_types import Raster, RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import FEATURES, Splats
from reconstruction.training.config import GeometrySource
from reconstruction.training.losses import unit
from reconstruction.training.methods.shader import Shaded, Shader
from reconstruction.training.photos.poses import moved_view, pulled

Array = NDArray[np.float64]


# Which panel's plane mirrors at each pixel of a view, wherever the view is: no photo's layer is asked.
#
# What stands in front of a panel is not looked at here: splats that are no glass have no reflectivity.

HERE = np.zeros(3)


def photo_of(view: View, origin_enu_m: Array = HERE) -> PosedPhoto:
    """The camera of a view as `reconstruction.base.cameras` has it, ENU; without an origin, in the model's frame."""
    lens = Intrinsics(view.width_px, view.height_px, view.fx_px, view.fy_px, view.cx_px, view.cy_px)
    rotation = view.cam_from_world[:3, :3].numpy()
    position = origin_enu_m - rotation.T @ view.cam_from_world[:3, 3].numpy()
    return PosedPhoto("", Path(), lens, Pose(position, rotation))


def panels_in_view(view: View, corners_m: Array) -> NDArray[np.int32]:
    """Panels by pixel, from 0, shape (h, w); -1 where there is none.

    A panel's pixels are those whose middle ray meets it, and those beside them that meet none: of a pixel that glass
    and frame share, the splats say how much mirrors, but not where to.

    Parameters
    ----------
    corners_m
        In the view's frame, shape (m, 4, 3), as `PanelPlanes` has them; panels seen from behind are left out.
    """
    photo = photo_of(view)
    seen = np.flatnonzero(facing(photo, corners_m))
    index = draw_panels(photo, corners_m[seen]).index.astype(np.int32)
    numbers = np.concatenate([[-1], seen]).astype(np.int32)
    return numbers[_grown(index)]


def _grown(index: NDArray[np.int32]) -> NDArray[np.int32]:
    """Index image whose zeros became the largest of their four neighbours."""
    around = np.pad(index, 1)
    beside = np.maximum(
        np.maximum(around[1:-1, :-2], around[1:-1, 2:]), np.maximum(around[:-2, 1:-1], around[2:, 1:-1])
    )
    return np.where(index > 0, index, beside)


LEAST_REFLECTIVITY = 1e-3
"""Of a pixel that the model of mirrored light is asked for: less cannot be seen in 8 bits."""

LEAST_COSINE = 1e-3
"""Between a ray and a plane that it meets: at 89.94 degrees a pixel is as long as a hundred panels."""

SHORTEST_NORMAL = 1e-6
"""Of blended normals: less than `LEAST_REFLECTIVITY`, so that it is never needed but for rounding."""

OF_SPLATS = "splats."
"""Before the names of what splats have, in a model's state."""

N_FEATURES = FEATURES["offset"].stop
"""Of `Splats.features`."""

MOST_LOST = 0.9
"""Light that vignetting takes at most."""

USUAL = RasterSettings()


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """What a model shows in a view, and what it is made of. Light is linear, before gain and vignetting.

    Parameters
    ----------
    display
        sRGB values, shape (h, w, 3), above 1 where a photo would be overexposed.
    light
        Shape (h, w, 3).
    diffuse, reflection
        Its parts, shape (h, w, 3): (1 - R) c with the sky behind, and R F L.
    mirrored
        L, shape (h, w, 3); 0 where nothing mirrors.
    reflectivity
        R, shape (h, w).
    normals
        Sum of w n, turned to the camera, shape (h, w, 3).
    panels
        Whose plane mirrors, from 0, shape (h, w); -1 for none.
    raster
        Of the splats, with all their features.
    penalty
        That the method's shading adds to the loss.
    """

    display: Tensor
    light: Tensor
    diffuse: Tensor
    reflection: Tensor
    mirrored: Tensor
    reflectivity: Tensor
    normals: Tensor
    panels: Tensor
    raster: Raster
    penalty: Tensor | None = None


class SceneModel(nn.Module):
    """Splats with a sky behind them and, for glass, a model of mirrored light.

    Parameters
    ----------
    light
        Mirrored by panels; None where panels are not known, and `shader` makes all light.
    planes
        Of the panels, ENU.
    origin_enu_m
        Of the model's frame, shape (3,).
    corner_square
        Squared tangent of the angle between the optical axis and the corners of the photos, where vignetting is full.
    geometry
        Where X and n of mirroring pixels come from.
    precision
        Of the matrix products in the model of mirrored light.
    shader
        None for spherical harmonics.
    """

    def __init__(
        self,
        splats: Splats,
        sky: Sky,
        light: GlassLight | None,
        planes: PanelPlanes,
        origin_enu_m: Array,
        corner_square: float,
        geometry: GeometrySource = "panels",
        precision: Precision = "float32",
        shader: Shader | None = None,
    ) -> None:
        super().__init__()
        self.splats = splats
        self.sky = sky
        self.light = light
        self.planes = planes
        self.origin_enu_m = np.asarray(origin_enu_m, float)
        self.corner_square = corner_square
        self.geometry = geometry
        self.precision = precision
        self.shader = shader or Shader()
        self.corner_loss = nn.Parameter(torch.zeros(()))
        self.corners_m = planes.corners_enu_m - self.origin_enu_m

    def forward(
        self,
        view: View,
        gain: Tensor | float = 1.0,
        degree: int = 3,
        *,
        settings: RasterSettings = USUAL,
        screen_offsets: Tensor | None = None,
        generator: torch.Generator | None = None,
        move: Tensor | None = None,
    ) -> Picture:
        """Render a view.

        Parameters
        ----------
        gain
            Exposure of the picture, one number or one for each channel.
        degree
            Of spherical harmonics.
        screen_offsets
            See `rasterise`.
        generator
            Of the places within each pixel that mirrored rays go through; evenly spread ones where there is none.
        move
            Correction of the view's pose, shape (6,), see `poses`. Its gradient is that of what is rasterised; where
            mirrored rays go to counts as fixed.
        """
        splats, device = self.splats, self.splats.means.device
        means: Tensor = splats.means
        quats: Tensor = splats.quats
        if move is not None:
            view = moved_view(view, move)
            means, quats = pulled(means, quats, view.position_m, move)
        raster = rasterise(
            means,
            quats,
            splats.scales,
            splats.opacities,
            self._features(view, degree),
            view,
            screen_offsets=screen_offsets,
            labels=splats.panels if self._asks_splats else None,
            settings=settings,
        )
        directions = view.directions(splats.means.dtype).to(device)
        if self.light is not None:
            panels = self._panels(view, raster)
            shaded = self._shaded(view, raster, directions, panels, generator)
        else:
            panels = torch.full(raster.alphas.shape, -1, dtype=torch.int32, device=device)
            shaded = self.shader(view, raster, directions, raster.features[..., N_FEATURES:], splats)
        diffuse = shaded.own + self.sky.behind(directions, raster.alphas)
        light = diffuse + shaded.reflection
        display = display_from_linear(self._vignetting(view)[..., None] * gain * light)
        normals = raster.features[..., FEATURES["normal"]]
        return Picture(
            display,
            light,
            diffuse,
            shaded.reflection,
            shaded.mirrored,
            shaded.reflectivity,
            normals,
            panels,
            raster,
            shaded.penalty,
        )

    def train(self, mode: bool = True) -> SceneModel:
        """As of any module; corrections of poses, learned with light alone, are in the views already."""
        super().train(mode)
        if self.light is not None:
            self.light.training = False
        return self

    def finish(self, config: ReflectionConfig) -> None:
        """What follows the last step; the same model, read back, is in the same state."""
        if self.light is not None:
            self.light.finish(config)
        self.eval()

    def with_splats(self, splats: Splats) -> SceneModel:
        """A model of other splats, which shares all else with it."""
        found = SceneModel(
            splats,
            self.sky,
            self.light,
            self.planes,
            self.origin_enu_m,
            self.corner_square,
            self.geometry,
            self.precision,
            self.shader,
        )
        found.corner_loss = self.corner_loss
        return found.train(self.training)

    def empty_places(self) -> Tensor | None:
        """Of a radiance grid, where rays may leap: found out from its weights now and then, so part of its state."""
        if self.light is None or not isinstance(self.light.light, RadianceGrid):
            return None
        return torch.from_numpy(self.light.light.skips.copy())

    def load(self, state: Mapping[str, Tensor], empty_places: Tensor | None = None) -> None:
        """Take over the state of a model of the same kind, which may have more splats or fewer.

        The splats' parameters are new ones afterwards, so an optimiser has to be made anew.

        Parameters
        ----------
        empty_places
            Of `empty_places`; found out anew where they are not given.

        Raises
        ------
        KeyError, RuntimeError
            It is of another kind.
        """
        device = self.corner_loss.device
        values = {name.removeprefix(OF_SPLATS): value for name, value in state.items() if name.startswith(OF_SPLATS)}
        panels = values.pop("panels")
        if set(values) != set(self.splats.names):
            raise KeyError("splats of another method")
        self.splats = Splats(values, panels).to(device)
        self.load_state_dict(dict(state))
        if self.light is not None and isinstance(self.light.light, RadianceGrid):
            self.light.light.refresh()
            if empty_places is not None:
                if tuple(empty_places.shape) != self.light.light.skips.shape or empty_places.dtype != torch.uint8:
                    raise KeyError("empty places of another grid")
                self.light.light.skips = empty_places.numpy().copy()

    @property
    def _asks_splats(self) -> bool:
        return self.light is not None and self.geometry == "splats"

    def _features(self, view: View, degree: int) -> Tensor:
        """Of the splats, shape (n, c); where they are asked for X and n, those of glass have both once more."""
        splats = self.splats
        position = view.position_m.to(splats.means.device)
        if self.light is None:
            features = splats.features(position, degree, self.shader.colours(splats, position, degree))
            channels = self.shader.channels(splats, position)
            return features if channels is None else torch.cat([features, channels], dim=1)
        features = _shares(splats.features(position, degree))
        if not self._asks_splats:
            return features
        planes = torch.cat([features[:, FEATURES["normal"]], features[:, FEATURES["offset"]]], dim=1)
        return torch.cat([features, planes * (splats.panels >= 0)[:, None]], dim=1)

    def _panels(self, view: View, raster: Raster) -> Tensor:
        """Which panel's plane mirrors: by the panels' edges, or by the heaviest splats (Eq. 17)."""
        if raster.labels is not None:
            return raster.labels
        return torch.from_numpy(panels_in_view(view, self.corners_m)).to(raster.alphas.device)

    def _shaded(
        self, view: View, raster: Raster, directions: Tensor, panels: Tensor, generator: torch.Generator | None
    ) -> Shaded:
        """(1 - R) c, R F L, L and R as pictures."""
        blended = raster.features[..., FEATURES["reflectivity"]].squeeze(-1)
        mirrors = blended > LEAST_REFLECTIVITY
        if not self._asks_splats:
            mirrors &= panels >= 0
        rows, columns = torch.nonzero(mirrors, as_tuple=True)
        features = raster.features[rows, columns]
        if self._asks_splats:
            with self._autocast(panels.device):
                light, cosines = self._mirrored_by_splats(view, raster, directions[rows, columns], rows, columns)
        else:
            light, cosines = self.mirrored_by_planes(view, rows, columns, panels[rows, columns], generator)
        light, cosines = light.to(features), cosines.to(features)
        reflectivity = features[:, FEATURES["reflectivity"]]
        added = schlick(features[:, FEATURES["f0"]], cosines, reflectivity) * light
        place, own = (rows, columns), raster.features[..., FEATURES["colour"]]
        black = torch.zeros_like(own)
        return Shaded(
            own,
            black.index_put(place, added),
            black.index_put(place, light),
            torch.zeros_like(blended).index_put(place, reflectivity.squeeze(-1)),
        )

    def _autocast(self, device: torch.device) -> torch.autocast:
        return torch.autocast(device.type, torch.bfloat16, enabled=self.precision == "bfloat16")

    def mirrored_by_planes(
        self, view: View, rows: Tensor, columns: Tensor, panels: Tensor, generator: torch.Generator | None
    ) -> tuple[Tensor, Tensor]:
        """L, shape (n, 3), and cosines of incidence, shape (n,), of pixels, by the panels' planes."""
        assert self.light is not None
        table = RayTable.of([photo_of(view, self.origin_enu_m)], self.planes, {}).to(panels.device)
        with self._autocast(panels.device):
            light, cosines = self.light(rays_of_pixels(table, 0, columns, rows, panels), generator)
        return light.float(), cosines

    def _mirrored_by_splats(
        self, view: View, raster: Raster, omega_o: Tensor, rows: Tensor, columns: Tensor
    ) -> tuple[Tensor, Tensor]:
        """The same by where rays meet the blended plane of the splats on glass.

        Depth of all splats would not do: what lies behind panes and shines through a little is far behind them (1 m of
        error in the middle of a training's start, and 1e-6 m of the panes' own splats).
        """
        assert self.light is not None
        blended = raster.features[rows, columns, N_FEATURES:]
        lengths = blended[:, :3].norm(dim=-1).clamp(min=SHORTEST_NORMAL)
        normals = unit(blended[:, :3])
        along = (omega_o * normals).sum(dim=-1).clamp(max=-LEAST_COSINE)
        points = view.position_m.to(omega_o) + (blended[:, 3] / lengths / along)[:, None] * omega_o
        middle = torch.from_numpy(self.planes.middle_enu_m - self.origin_enu_m).to(points)
        rescaled = (points - middle) / self.planes.half_side_m
        light = self.light.light(rescaled, reflected_directions(omega_o, normals))
        return light, incidence_cosines(omega_o, normals)

    def _vignetting(self, view: View) -> Tensor:
        """Share of the light that vignetting leaves, shape (h, w)."""
        x = (torch.arange(view.width_px) + 0.5 - view.cx_px) / view.fx_px
        y = (torch.arange(view.height_px) + 0.5 - view.cy_px) / view.fy_px
        off_axis = (x * x + (y * y)[:, None]) / self.corner_square
        return 1.0 - torch.clamp(self.corner_loss * off_axis.to(self.corner_loss), max=MOST_LOST)


def _shares(features: Tensor) -> Tensor:
    """`Splats.features` with (1 - R) c and R F0 in the place of c and F0: what may be blended."""
    reflectivity = features[:, FEATURES["reflectivity"]]
    own = (1.0 - reflectivity) * features[:, FEATURES["colour"]]
    mirrored = reflectivity * features[:, FEATURES["f0"]]
    return torch.cat([own, reflectivity, mirrored, features[:, FEATURES["f0"].stop :]], dim=1)
