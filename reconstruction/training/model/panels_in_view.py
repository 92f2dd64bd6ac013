"""Which panel's plane mirrors at each pixel of a view, wherever the view is: no photo's layer is asked.

What stands in front of a panel is not looked at here: splats that are no glass have no reflectivity.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.dataset.panel_images import draw_panels, facing
from reconstruction.splats.rasterising.views import View

Array = NDArray[np.float64]


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
