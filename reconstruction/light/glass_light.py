"""What panes mirror towards the pixels of photos: a model of light, asked along several rays of each pixel.

A pixel is an area: one ray through its middle tells of something near and detailed what no photo shows. Panes hang a
little out of their plane and are bowed; both turn mirrored rays, twice as far, and are learned with the light. Of the
panes' tilts, that part is taken away which turning all of the surroundings would do as well: it cannot be known, and
would only drift.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.light import ray_table as kernels
from reconstruction.light.config import GlassLearned, ReflectionConfig
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_rays import GlassRays, numbers_in
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.ray_table import PaneHits, RayTable
from reconstruction.light.reflection_mlp import ReflectionMlp
from reconstruction.light.shading import reflected_directions

LightModel = ReflectionMlp | EnvironmentMap | RadianceGrid

REGULARISED = 4
"""Steps from one in which a radiance grid is regularised to the next: it takes as long as a thousand rays."""

SAME_TURN = 1e-6
"""Singular values below, of the largest, belong to turns that tilt no pane: those about the normal of all."""


BOWS_TRIED = 0.5
"""Share of the training of light after which it is decided whether panes stay bowed."""

BOWS_COST_S = 0.0
"""Too little to be measured."""

UNKNOWN = -1.0
"""Of bows that were not measured, or not yet."""


@dataclass(frozen=True, slots=True)
class BowedPanes:
    """Whether panes are so bowed that their edges mirror another place than flat ones would."""

    name: str = say("bows of panes")
    unit: str = "px"
    tolerance: float = 0.25

    def assess(self, scene: float) -> Assessment:
        """By `GlassLight.bowed_px`, or `UNKNOWN`."""
        if scene == UNKNOWN:
            return Assessment(0.0, say("it was not looked for"), BOWS_COST_S)
        reason = say("at the edges of panes mirror images are {:.2f} px from where flat ones would show them", scene)
        return Assessment(scene, reason, BOWS_COST_S)


class GlassLight(nn.Module):
    """Light that panes mirror, on average over the rays of a pixel that meet its pane.

    Parameters
    ----------
    light
        By place, direction and panel.
    planes
        Of the panels.
    learned
        Rays of each pixel, and what is learned.
    n_photos
        Whose poses are corrected while it learns, with the table that counts them; never in evaluation.
    """

    edges: Tensor
    common: Tensor

    def __init__(self, light: LightModel, planes: PanelPlanes, learned: GlassLearned, n_photos: int = 0) -> None:
        super().__init__()
        self.light, self.learned, self.rays = light, learned, learned.rays
        edges = _edges(torch.from_numpy(planes.corners_enu_m))
        self.register_buffer("edges", edges.float(), persistent=False)
        self.register_buffer("common", _common_turns(edges).float(), persistent=False)
        n_panels = len(edges)
        self.tilts = nn.Parameter(torch.zeros(n_panels, 2)) if learned.tilts else None
        self.bows = nn.Parameter(torch.zeros(n_panels, 2)) if learned.bows else None
        self.moves = nn.Parameter(torch.zeros(n_photos, 6)) if learned.poses else None

    def forward(self, rays: GlassRays, generator: torch.Generator | None = None) -> tuple[Tensor, Tensor]:
        """Light, shape (n, 3), and cosines of the angle of incidence, shape (n,), both averages over each pixel.

        Rays that meet no glass within a pixel's panel, but the frame beside it, do not count; where none does, the one
        through the middle is taken, as if the pane went on.

        Parameters
        ----------
        generator
            Of the places within each pixel, one in each square of an even grid of `rays`; the squares' middles where
            there is none.
        """
        n, k = len(rays), self.rays
        offsets = pixel_offsets(n, k, generator).to(rays.panels.device)
        moves = self.moves - self.moves.mean(dim=0) if self.moves is not None and self.training else None
        hits = rays.repeated(k).hits(offsets, moves)
        panels = rays.panels.long().repeat_interleave(k)
        omega_r, cosines = self.mirrored(rays.table, hits, panels)
        light = self.light(rays.table.rescaled(hits.points_m).float(), omega_r, panels)
        if k == 1:
            return light, cosines
        shares = hits.shares.detach()
        counts = ((shares >= 0.0) & (shares <= 1.0)).all(dim=1).float().reshape(n, k)
        counts = torch.where(counts.sum(dim=1, keepdim=True) > 0.0, counts, torch.ones_like(counts))
        weights = counts / counts.sum(dim=1, keepdim=True)
        return (light.reshape(n, k, 3) * weights[..., None]).sum(dim=1), (cosines.reshape(n, k) * weights).sum(dim=1)

    def parameter_groups(self, config: ReflectionConfig) -> list[dict[str, Any]]:
        """For AdamW: parameters, `params`, with their learning rates, `lr`, and `weight_decay` where it is not 0."""
        groups: list[dict[str, Any]]
        if isinstance(self.light, ReflectionMlp):
            hidden = [layer.weight for layer in self.light.hidden]
            others = [*(layer.bias for layer in self.light.hidden), *self.light.last.parameters()]
            groups = [
                {"params": hidden, "lr": config.mlp_rate, "weight_decay": config.mlp_decay},
                {"params": others, "lr": config.mlp_rate},
            ]
        else:
            groups = [{"params": [*self.light.parameters()], "lr": config.table_rate}]
        own = [value for value in (self.tilts, self.bows, self.moves) if value is not None]
        return [*groups, {"params": own, "lr": config.grid.tilt_rate}] if own else groups

    def regulariser(self, config: ReflectionConfig, step: int) -> Tensor | None:
        """What is added to the loss in a step, counted from 0; None for nothing."""
        if not isinstance(self.light, RadianceGrid) or step % REGULARISED:
            return None
        grid = config.grid
        factors = (REGULARISED * factor for factor in (grid.rough_density, grid.rough_light, grid.emptier))
        return self.light.roughness(*factors)

    def after_step(self, config: ReflectionConfig, step: int, progress: float) -> bool:
        """What follows a step, counted from 0, at a progress of 0 to 1.

        Returns
        -------
        bool
            Whether the light has new parameters in the place of old ones, of which an optimiser has to be told.
        """
        if not isinstance(self.light, RadianceGrid):
            return False
        level = config.grid.level(progress)
        has_grown = self.light.level > level
        while self.light.level > level:
            self.light.grow()
        if has_grown or step % config.grid.rest == config.grid.rest - 1:
            self.light.refresh()
        return has_grown

    def finish(self, config: ReflectionConfig) -> None:
        """What follows the last step of all, also of a training that a time limit ended."""
        self.after_step(config, config.grid.rest - 1, 1.0)

    def mirrored(self, table: RayTable, hits: PaneHits, panels: Tensor) -> tuple[Tensor, Tensor]:
        """Where rays go on, unit, shape (n, 3), and cosines of their angles of incidence, shape (n,), float32."""
        if hits.directions.requires_grad or hits.directions.device.type != "cpu":
            normals, directions = self.normals(table, hits, panels), hits.directions.float()
            cosines = (directions * normals).sum(dim=1).abs().clamp(max=1.0)
            return reflected_directions(directions, normals), cosines
        normals = table.normals.float()
        bows = torch.zeros(len(normals), 2) if self.bows is None else self.bows
        found: tuple[Tensor, Tensor] = _Mirror.apply(self.true_tilts(), bows, hits, panels, normals, self.edges)  # type: ignore[no-untyped-call]
        return found

    def normals(self, table: RayTable, hits: PaneHits, panels: Tensor) -> Tensor:
        """Unit, at the places that rays meet, shape (n, 3), float32."""
        normals = table.normals[panels].float()
        if self.tilts is None and self.bows is None:
            return normals
        turns = torch.zeros(len(panels), 2, device=panels.device)
        if self.tilts is not None:
            turns = turns + self.true_tilts()[panels]
        if self.bows is not None:
            turns = turns + self.bows[panels] * (2.0 * hits.shares.float().clamp(0.0, 1.0) - 1.0)
        edges = self.edges[panels]
        return nn.functional.normalize(normals + (turns[..., None] * edges).sum(dim=1), dim=1)

    @torch.no_grad()
    def bowed_px(self, rays: GlassRays) -> float:
        """How far bows move mirror images of what is far away, at the edges of panes, pixels, beyond what chance would.

        Sealed units in the same weather bulge alike, and errors differ from pane to pane (flat ones of photos 192 px
        wide seemed bowed by 0.5 px, in the median): so it is the mean of the panes that rays show, less its standard
        error.
        """
        panes = numbers_in(rays.panels)
        if self.bows is None or len(panes) < 2:
            return 0.0
        # Mirrored rays turn by twice the normal's angle.
        moves_px = 2.0 * float(rays.table.lenses[:, 0].median()) * self.bows[panes].double()
        unsure_px = moves_px.std(dim=0).norm() / math.sqrt(len(panes))
        return float((moves_px.mean(dim=0).norm() - unsure_px).clamp(min=0.0))

    def flatten(self) -> None:
        """Forget bows, and learn none from here on."""
        self.bows, self.learned = None, replace(self.learned, bows=False)

    def true_tilts(self) -> Tensor:
        """Of the panes, radians: how far normals lean along the lower and the left edge, shape (m, 2)."""
        if self.tilts is None:
            return torch.zeros(len(self.edges), 2, device=self.edges.device)
        flat = self.tilts.reshape(-1, 1)
        # Sums of products, as autocast would shorten a matrix product to half precision.
        shares = (self.common * flat).sum(dim=0)
        return (flat[:, 0] - (self.common * shares).sum(dim=1)).reshape(-1, 2)


class _Mirror(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, tilts: Tensor, bows: Tensor, hits: PaneHits, panels: Tensor, normals: Tensor, edges: Tensor
    ) -> tuple[Tensor, Tensor]:
        n = len(panels)
        values = (hits.directions, hits.shares, panels, normals, edges, tilts, bows)
        fixed: Any = tuple(np.ascontiguousarray(value.detach().numpy()) for value in values)
        omega_r, cosines = np.empty((n, 3), np.float32), np.empty(n, np.float32)
        mirror: Any = kernels.mirror
        mirror(*fixed, omega_r, cosines)
        ctx.fixed = fixed
        return torch.from_numpy(omega_r), torch.from_numpy(cosines)

    @staticmethod
    def backward(ctx: Any, by_omega_r: Tensor, by_cosines: Tensor) -> tuple[Tensor | None, ...]:
        fixed: Any = ctx.fixed
        found = np.zeros((2, len(fixed[5]), 2))
        slopes = (np.ascontiguousarray(part.numpy()) for part in (by_omega_r, by_cosines))
        mirror_back: Any = kernels.mirror_back
        mirror_back(*fixed, *slopes, *found)
        by_tilts, by_bows = (torch.from_numpy(part).float() for part in found)
        return by_tilts, by_bows, None, None, None, None


def pixel_offsets(n: int, k: int, generator: torch.Generator | None) -> Tensor:
    """Places within pixels, off their middles, shape (n k, 2), float64: k in each, one in each square of a grid."""
    side = math.isqrt(k)
    number = torch.arange(k)
    corners = torch.stack([number % side, number // side], dim=1).double().repeat(n, 1)
    within = 0.5 if generator is None else torch.rand(n * k, 2, generator=generator).double()
    return (corners + within) / side - 0.5


def _edges(corners: Tensor) -> Tensor:
    """Unit vectors along the lower edges, and up from them in the panels' planes, shape (m, 2, 3)."""
    lower = nn.functional.normalize(corners[:, 1] - corners[:, 0], dim=1)
    normals = nn.functional.normalize(
        torch.linalg.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), dim=1
    )
    return torch.stack([lower, torch.linalg.cross(normals, lower)], dim=1)


def _common_turns(edges: Tensor) -> Tensor:
    """Orthonormal tilts of all panes that turning the surroundings does too, shape (2 m, up to 3).

    A small turn w moves each normal by w x n; along the edges e that is w . (n x e).
    """
    normals = torch.linalg.cross(edges[:, 0], edges[:, 1])
    moved = torch.linalg.cross(normals[:, None].expand_as(edges), edges).reshape(-1, 3)
    turns, sizes, _ = torch.linalg.svd(moved, full_matrices=False)
    is_felt: Tensor = sizes > SAME_TURN * sizes.max()
    return torch.stack([turn for turn, is_one in zip(turns.T, is_felt, strict=True) if is_one], dim=1)
