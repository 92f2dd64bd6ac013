"""Coverage growing photo by photo: each photo is counted as it was really taken, not as its view was planned."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.services.fly.events import ViewState
from missions.flight.matching import DEFAULT_GATES, Gates, pose_of_photo
from missions.flight.record import TakenPhoto
from missions.flight.report_rules import DEFAULT_LIMITS, Limits
from planning.checks.case import Case, pose_of
from planning.coverage.evaluate import sights
from planning.geo.frames import heading_difference_rad
from planning.plan import Viewpoint


@dataclass(frozen=True, slots=True, eq=False)
class Counted:
    """A photo, the view that it is of (None for none), and what it added."""

    photo: TakenPhoto
    view: Viewpoint | None
    n_new: int
    position_error_m: float | None
    heading_error_deg: float | None
    gimbal_pitch_error_deg: float | None


class LiveCoverage:
    """Counts the photos of one or more sorties of a plan.

    Parameters
    ----------
    case
        The plan, measured.
    """

    def __init__(self, case: Case) -> None:
        self._case = case
        self._by_id = {view.id: view for view in case.plan.viewpoints}
        self._planned = np.zeros(case.model.n_elements, np.bool_)
        self._counts = np.zeros(case.model.n_elements, np.int64)
        self.photo_of: dict[str, Counted] = {}

    @property
    def covered(self) -> int:
        """Sections that at least one photo shows."""
        return int(np.count_nonzero(self._counts))

    @property
    def covered_planned(self) -> int:
        """Sections that the sorties so far cover as they were planned."""
        return int(np.count_nonzero(self._planned))

    def planned(self) -> NDArray[np.bool_]:
        """Whether the sorties so far cover each section as they were planned, shape (m, n_sections)."""
        return self._planned.copy().reshape(len(self._case.model.frames), -1)

    def counts(self) -> NDArray[np.int64]:
        """Photos that show each section, shape (m, n_sections); a copy."""
        return self._counts.copy().reshape(len(self._case.model.frames), -1)

    def add_sortie(self, viewpoint_ids: Sequence[str]) -> None:
        """Another sortie is flown; what it covers as planned counts from now on."""
        for viewpoint_id in viewpoint_ids:
            self._planned[self._case.measures.seen[pose_of(self._by_id[viewpoint_id])].elements] = True

    def add(self, photo: TakenPhoto, viewpoint_ids: Sequence[str], gates: Gates = DEFAULT_GATES) -> Counted:
        """Count a photo, as the view of these that it fits best and that has none yet.

        A photo whose direction its source does not say is taken to look where its view does; without a view it counts
        for no section.
        """
        views = [self._by_id[viewpoint_id] for viewpoint_id in viewpoint_ids if viewpoint_id not in self.photo_of]
        view = matching_view(photo, views, gates)
        pose = pose_of_photo(photo, view)
        n_new = 0
        if pose is not None:
            (sight,) = sights(self._case.model, (pose,))
            n_new = int(np.count_nonzero(self._counts[sight.elements] == 0))
            self._counts[sight.elements] += 1
        counted = Counted(photo, view, n_new, *_errors(photo, view))
        if view is not None:
            self.photo_of[view.id] = counted
        return counted

    def states(
        self, viewpoint_ids: Sequence[str], missing: Sequence[str], limits: Limits = DEFAULT_LIMITS
    ) -> tuple[tuple[str, ViewState], ...]:
        """How each view of a sortie stands, in the order of flight; `missing` were passed without a photo."""
        states: list[tuple[str, ViewState]] = []
        has_next = False
        for viewpoint_id in viewpoint_ids:
            counted = self.photo_of.get(viewpoint_id)
            if counted is not None:
                error_m = counted.position_error_m or 0.0
                state = ViewState.OFF if error_m > limits.position_m else ViewState.TAKEN
            elif viewpoint_id in missing:
                state = ViewState.MISSING
            else:
                state = ViewState.TO_COME if has_next else ViewState.NEXT
                has_next = True
            states.append((viewpoint_id, state))
        return tuple(states)


def matching_view(photo: TakenPhoto, views: Sequence[Viewpoint], gates: Gates) -> Viewpoint | None:
    """The view that a photo fits best: the largest of its errors, in parts of the gates, is least and within them."""
    best, least = None, 1.0
    for view in views:
        position_m, heading_deg, pitch_deg = _errors(photo, view)
        misfit = max(
            (position_m or 0.0) / gates.position_m,
            abs(heading_deg or 0.0) / gates.angle_deg,
            abs(pitch_deg or 0.0) / gates.angle_deg,
        )
        if misfit < least:
            best, least = view, misfit
    return best


def _errors(photo: TakenPhoto, view: Viewpoint | None) -> tuple[float | None, float | None, float | None]:
    """Distance in metres, heading and pitch in degrees, taken less planned; None where not known."""
    if view is None:
        return None, None, None
    heading = pitch = None
    if photo.heading_deg is not None:
        turned = heading_difference_rad(math.radians(view.heading_deg), math.radians(photo.heading_deg))
        heading = math.degrees(float(turned))
    if photo.gimbal_pitch_deg is not None:
        pitch = photo.gimbal_pitch_deg - view.gimbal_pitch_deg
    return math.dist(photo.position_enu_m, view.position_enu_m), heading, pitch
