"""What a picture is rendered from: a straight (pinhole) camera in the model's frame.

The model's frame is the site's ENU less the model's origin, so that float32 is good to 1e-5 m; camera axes are x right,
y down, z forward. The middle of the first pixel is at (0.5, 0.5), as in `reconstruction.base.cameras`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A straight camera.

    Parameters
    ----------
    width_px, height_px
        Size of the picture.
    fx_px, fy_px, cx_px, cy_px
        Focal lengths and principal point, which may lie outside the picture.
    cam_from_world
        Rigid motion from the model's frame to camera axes, shape (4, 4), float64, in main memory.
    whole_px
        Of the picture that this is a window of, counted from the window's first pixel: left, right, top, bottom. None
        where it is all there is.
    """

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    cam_from_world: Tensor
    whole_px: tuple[int, int, int, int] | None = None

    def __post_init__(self) -> None:
        if self.width_px < 1 or self.height_px < 1:
            raise ValueError(f"expected a picture of at least one pixel, got {self.width_px} x {self.height_px}")
        if not all(math.isfinite(f) and f > 0.0 for f in (self.fx_px, self.fy_px)):
            raise ValueError(f"fx_px, fy_px: expected positive focal lengths, got {self.fx_px}, {self.fy_px}")
        if not (math.isfinite(self.cx_px) and math.isfinite(self.cy_px)):
            raise ValueError("cx_px, cy_px: expected finite numbers")
        matrix = self.cam_from_world
        if matrix.shape != (4, 4) or matrix.dtype != torch.float64 or matrix.device.type != "cpu":
            raise ValueError(
                f"cam_from_world: expected shape (4, 4), float64, in main memory, got {tuple(matrix.shape)}, "
                f"{matrix.dtype}, {matrix.device}"
            )

    @staticmethod
    def of(photo: PosedPhoto, origin_enu_m: NDArray[np.float64]) -> View:
        """Camera of a photo, in the frame whose origin is `origin_enu_m`, shape (3,).

        Raises
        ------
        InputError
            The photo is distorted.
        """
        lens = photo.intrinsics
        if not lens.is_straight:
            raise InputError(
                say(
                    "the picture is distorted, and splats are rendered without distortion; make it straight with "
                    "`prepare`",
                    place=photo.name,
                )
            )
        rotation = photo.pose.cam_from_enu
        matrix = np.eye(4)
        matrix[:3, :3] = rotation
        matrix[:3, 3] = rotation @ (np.asarray(origin_enu_m, float) - photo.pose.position_enu_m)
        return View(
            lens.width_px, lens.height_px, lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, torch.from_numpy(matrix)
        )

    @property
    def position_m(self) -> Tensor:
        """Optical centre in the model's frame, shape (3,), float32."""
        rotation, shift = self.cam_from_world[:3, :3], self.cam_from_world[:3, 3]
        return (-rotation.T @ shift).to(torch.float32)

    def cropped(self, x_px: int, y_px: int, width_px: int, height_px: int) -> View:
        """The window of the picture whose first pixel is column `x_px`, row `y_px`; it may reach beyond the picture."""
        left, right, top, bottom = self.of_picture_px
        return replace(
            self,
            width_px=width_px,
            height_px=height_px,
            cx_px=self.cx_px - x_px,
            cy_px=self.cy_px - y_px,
            whole_px=(left - x_px, right - x_px, top - y_px, bottom - y_px),
        )

    @property
    def of_picture_px(self) -> tuple[int, int, int, int]:
        """Left, right, top and bottom of the whole picture, counted from the window's first pixel."""
        return self.whole_px or (0, self.width_px, 0, self.height_px)

    def directions(self, dtype: torch.dtype = torch.float32) -> Tensor:
        """Unit rays through the pixels' middles in the model's frame, shape (h, w, 3)."""
        x = (torch.arange(self.width_px, dtype=torch.float64) + 0.5 - self.cx_px) / self.fx_px
        y = (torch.arange(self.height_px, dtype=torch.float64) + 0.5 - self.cy_px) / self.fy_px
        rows, columns = torch.meshgrid(y, x, indexing="ij")
        rays_cam = torch.stack([columns, rows, torch.ones_like(rows)], dim=-1)
        rays = rays_cam / rays_cam.norm(dim=-1, keepdim=True) @ self.cam_from_world[:3, :3]
        return torch.as_tensor(rays, dtype=dtype)
