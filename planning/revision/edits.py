"""Edits of a plan by hand. Each makes a new revision; the old one stays as it was, which is what undo goes back to.

An edit that breaks a rule is carried out all the same: the findings of the new revision name what is wrong.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np

from planning.errors import InputError
from planning.frames import Vec3, wrap_heading_deg
from planning.plan import ANGLE_DECIMALS, POSITION_DECIMALS, Plan, Sortie, Viewpoint
from planning.positions import aimed_views
from planning.revision.insertion import with_stop
from planning.revision.revision import Revision, with_route
from planning.revision.route import redrawn


def move(
    revision: Revision,
    viewpoint_id: str,
    position_enu_m: Vec3 | None = None,
    heading_deg: float | None = None,
    gimbal_pitch_deg: float | None = None,
) -> Revision:
    """Move or turn a viewpoint; what is None or as before stays. Any heading will do, it is wrapped into (-180, 180].

    Raises
    ------
    InputError
        The viewpoint is locked.
    ValueError
        There is no such viewpoint, or it cannot be where or look where it should (not finite, out of range).
    """
    old = revision.viewpoint(viewpoint_id)
    _check_unlocked([old], "moved")
    new = old
    if position_enu_m is not None and tuple(position_enu_m) != old.position_enu_m:
        new = replace(new, position_enu_m=_rounded_m(position_enu_m))
    if heading_deg is not None:
        is_same = heading_deg == old.heading_deg
        new = replace(new, heading_deg=wrap_heading_deg(heading_deg) if is_same else _rounded_heading_deg(heading_deg))
    if gimbal_pitch_deg is not None and gimbal_pitch_deg != old.gimbal_pitch_deg:
        new = replace(new, gimbal_pitch_deg=round(float(gimbal_pitch_deg), ANGLE_DECIMALS))
    before = {viewpoint.id: viewpoint for viewpoint in revision.plan.viewpoints}
    after = {**before, viewpoint_id: new}
    sorties = [
        redrawn(sortie, before, sortie.viewpoint_ids, after, revision.ways)
        if viewpoint_id in sortie.viewpoint_ids
        else sortie
        for sortie in revision.plan.sorties
    ]
    return with_route(revision, after.values(), sorties)


def add(revision: Revision, position_enu_m: Vec3, heading_deg: float, gimbal_pitch_deg: float) -> Revision:
    """Add a viewpoint, the last of the new plan's, where it costs least time in a sortie that has room for it.

    Where none has, it gets a sortie of its own. Its identifier is `next_id` of the plan.

    Raises
    ------
    ValueError
        A viewpoint cannot be there or look there (not finite, out of range).
    """
    pitch_deg = round(float(gimbal_pitch_deg), ANGLE_DECIMALS)
    heading_deg = _rounded_heading_deg(heading_deg)
    new = Viewpoint(next_id(revision.plan), _rounded_m(position_enu_m), heading_deg, pitch_deg)
    return with_route(revision, (*revision.plan.viewpoints, new), with_stop(revision, new))


def delete(revision: Revision, viewpoint_ids: Collection[str]) -> Revision:
    """Delete viewpoints, and the sorties that have none left.

    Raises
    ------
    InputError
        One of them is locked.
    ValueError
        There is no such viewpoint.
    """
    gone = set(viewpoint_ids)
    _check_unlocked([revision.viewpoint(viewpoint_id) for viewpoint_id in viewpoint_ids], "deleted")
    before = {viewpoint.id: viewpoint for viewpoint in revision.plan.viewpoints}
    after = {viewpoint_id: viewpoint for viewpoint_id, viewpoint in before.items() if viewpoint_id not in gone}
    sorties: list[Sortie] = []
    for sortie in revision.plan.sorties:
        left = tuple(viewpoint_id for viewpoint_id in sortie.viewpoint_ids if viewpoint_id not in gone)
        if left == sortie.viewpoint_ids:
            sorties.append(sortie)
        elif left:
            sorties.append(redrawn(sortie, before, left, after, revision.ways))
    return with_route(revision, after.values(), sorties)


def lock(revision: Revision, viewpoint_ids: Collection[str], locked: bool = True) -> Revision:
    """Lock viewpoints, so that planning again keeps them, or unlock them.

    Raises
    ------
    ValueError
        There is no such viewpoint.
    """
    changed = {viewpoint_id: replace(revision.viewpoint(viewpoint_id), locked=locked) for viewpoint_id in viewpoint_ids}
    viewpoints = [changed.get(viewpoint.id, viewpoint) for viewpoint in revision.plan.viewpoints]
    return with_route(revision, viewpoints, revision.plan.sorties)


def unlock(revision: Revision, viewpoint_ids: Collection[str]) -> Revision:
    """Unlock viewpoints; see `lock`."""
    return lock(revision, viewpoint_ids, locked=False)


def aim_at(revision: Revision, position_enu_m: Vec3, panel_id: str) -> tuple[float, float]:
    """Heading and gimbal pitch, degrees, that look from a position at a panel's middle, as far as the gimbal turns.

    Raises
    ------
    ValueError
        There is no such panel.
    """
    model = revision.case.model
    ids = [panel.id for panel in revision.prepared.site_model.site.panels]
    if panel_id not in ids:
        raise ValueError(f"panel_id: there is no panel '{panel_id}'")
    target = model.frames.centroids[ids.index(panel_id)]
    aimed = aimed_views(np.array([position_enu_m], np.float64), target[None], model.camera)
    low, high = model.camera.gimbal_pitch_deg
    heading_deg = _rounded_heading_deg(float(np.degrees(aimed.heading_rad[0])))
    return heading_deg, min(max(round(float(np.degrees(aimed.pitch_rad[0])), ANGLE_DECIMALS), low), high)


def next_id(plan: Plan) -> str:
    """Identifier for a new viewpoint: one higher than the highest of the form v0000."""
    numbers = (re.fullmatch(r"v(\d+)", viewpoint.id) for viewpoint in plan.viewpoints)
    highest = max((int(number[1]) for number in numbers if number is not None), default=-1)
    return f"v{highest + 1:04d}"


def _rounded_m(position_enu_m: Vec3) -> Vec3:
    """As plan files hold positions."""
    x, y, z = (round(float(value), POSITION_DECIMALS) for value in position_enu_m)
    return x, y, z


def _rounded_heading_deg(heading_deg: float) -> float:
    if not math.isfinite(heading_deg):
        raise ValueError(f"heading_deg: expected a finite number, got {heading_deg}")
    return wrap_heading_deg(round(wrap_heading_deg(heading_deg), ANGLE_DECIMALS))


def _check_unlocked(viewpoints: Iterable[Viewpoint], verb: str) -> None:
    for viewpoint in viewpoints:
        if viewpoint.locked:
            raise InputError(f"viewpoint '{viewpoint.id}' is locked and stays as it is; unlock it before it is {verb}")
