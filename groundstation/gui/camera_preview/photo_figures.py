"""The figures on the camera preview: what the photo covers, and how it sees the nearest panel."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication

from groundstation.gui.camera_preview.flight import CameraPose
from groundstation.gui.camera_preview.seen_panels import NearestPanel, SiteSight, nearest_covered
from groundstation.gui.view3d.pinhole import Pinhole
from groundstation.services.units import UnitSystem, length_unit, sampling_unit
from planning.frames import heading_difference_rad
from planning.plan import Plan, Viewpoint


def figures(
    sight: SiteSight,
    panel_ids: tuple[str, ...],
    plan: Plan,
    view: Pinhole,
    covered: NDArray[np.bool_],
    place: str,
    units: UnitSystem,
) -> str:
    """What a view covers, `covered` of shape (m,), under what its `place` is called."""
    nearest = nearest_covered(sight, plan, view.eye_enu_m, covered)
    if nearest is None:
        return QCoreApplication.translate("CameraPreview", "{0}: covers no panel").format(place)
    return QCoreApplication.translate("CameraPreview", "{0}: covers {1} panels\n{2}").format(
        place, int(covered.sum()), _nearest_text(nearest, panel_ids[nearest.panel], view, units)
    )


def place_text(viewpoint: Viewpoint | None, pose: CameraPose | None) -> str:
    """Where a pose is, by the viewpoint that was photographed last."""
    if viewpoint is None:
        return QCoreApplication.translate("CameraPreview", "before the first photo")
    if pose is not None and _is_at(pose, viewpoint):
        return viewpoint.id
    return QCoreApplication.translate("CameraPreview", "on the way from {0}").format(viewpoint.id)


def _nearest_text(nearest: NearestPanel, panel_id: str, view: Pinhole, units: UnitSystem) -> str:
    length, sampling = length_unit(units), sampling_unit(units)
    width, height = (2.0 * half * nearest.distance_m for half in (view.half_width, view.half_height))
    return QCoreApplication.translate(
        "CameraPreview",
        "nearest panel {0}: {1} away, {2} per pixel, seen at {3:.0f}° from its normal\n"
        "picture at this distance: {4} x {5}",
    ).format(
        panel_id,
        length.text(nearest.distance_m),
        sampling.text(nearest.sampling_m),
        nearest.incidence_deg,
        length.text(width),
        length.text(height),
    )


def _is_at(pose: CameraPose, viewpoint: Viewpoint) -> bool:
    """Whether a pose is that of a viewpoint, to a centimetre and a tenth of a degree."""
    away_m = float(np.linalg.norm(pose.position_enu_m - np.array(viewpoint.position_enu_m)))
    turned = heading_difference_rad(pose.heading_rad, math.radians(viewpoint.heading_deg))
    tilted = pose.pitch_rad - math.radians(viewpoint.gimbal_pitch_deg)
    return away_m < 0.01 and max(abs(float(turned)), abs(tilted)) < math.radians(0.1)
