"""Corrections of photos' poses: those found out while light was learned alone, and those learned with the splats.

A model and the poses of all its photos can move together without any picture changing. So the mean of all corrections
is 0: for those of light it is taken away, for those learned with the splats by a projection after each step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from torch import Tensor, nn

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.messages import say
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.light.glass_light import GlassLight
from reconstruction.splats.rasterising.views import View

Array = NDArray[np.float64]

LEAST_DISTANCE_M = 0.1
"""Between a photo and what it shows."""

Move = tuple[float, float, float, float, float, float]
"""Metres along ENU, and a rotation vector, radians, ENU."""


@torch.no_grad()
def learned_moves(light: GlassLight | None, n_photos: int) -> tuple[Move, ...]:
    """Of each photo learned from, as the rays were moved by them; none where poses were not learned.

    What all photos have in common is taken away: surroundings move and turn with it.
    """
    if light is None or light.moves is None or len(light.moves) != n_photos:
        return ()
    return _rows(light.moves - light.moves.mean(dim=0))


def moved(photos: Sequence[PosedPhoto], moves: Sequence[Move]) -> tuple[PosedPhoto, ...]:
    """Photos where their corrections put them; as they are where there are none."""
    if not moves:
        return tuple(photos)
    return tuple(_moved(photo, move) for photo, move in zip(photos, moves, strict=True))


def _moved(photo: PosedPhoto, move: Move) -> PosedPhoto:
    turn = Rotation.from_rotvec(move[3:]).as_matrix()
    pose = Pose(photo.pose.position_enu_m + np.array(move[:3]), photo.pose.cam_from_enu @ turn.T)
    return replace(photo, pose=pose)


def one_after_other(first: Sequence[Move], then: Sequence[Move]) -> tuple[Move, ...]:
    """Corrections that do what both do; an empty row corrects nothing."""
    if not first or not then:
        return tuple(first or then)
    found = []
    for a, b in zip(first, then, strict=True):
        turn = (Rotation.from_rotvec(b[3:]) * Rotation.from_rotvec(a[3:])).as_rotvec()
        found.append((*(np.array(a[:3]) + b[:3]).tolist(), *turn.tolist()))
    return tuple(found)


def _rows(moves: Tensor) -> tuple[Move, ...]:
    return tuple(tuple(row) for row in moves.double().cpu().tolist())


@dataclass(frozen=True, slots=True)
class OwnPoses:
    """Correct the pose of each photo while splats are learned."""

    name: str = say("pose of each photo")
    unit: str = "px"
    tolerance: float = 1.0

    def assess(self, scene: PoseShift) -> Assessment:
        """How far photos were moved while all were corrected."""
        if scene.shift_px == UNKNOWN:
            return Assessment(0.0, say("it was not looked for"), scene.cost_s)
        return Assessment(
            scene.shift_px,
            say("photos fit the model better where what they show is {:.2f} px elsewhere", scene.shift_px),
            scene.cost_s,
        )


@dataclass(frozen=True, slots=True)
class PoseShift:
    """What the first part of a training found: median shift of photos, or `UNKNOWN`, and what corrections cost."""

    shift_px: float
    cost_s: float


TRIED = 0.25
"""Share of the training after which it is decided whether poses go on being corrected."""

MEAN_FROM = 0.4
"""Of that, from which on corrections are averaged: they wander from look to look."""

EACH_STAYS = 3
"""Of so many photos one stays where it is said to be until then, and the model with it. Else model and photos follow
each other away, ever further: right poses of 1024 px by 1.6 px in a quarter of an hour, which cost 2 dB."""

WANDER = 11.0
"""Steps of Adam that corrections of right poses wander, over the square root of the looks at each photo: with steps
of 0.1 px 0.6 px after 3 to 4 looks (planar, 85 photos of 512 px). To correct right poses cost 2.7 dB there in ten
minutes; poses that are 2 px off are seen to be 1.3 off after three looks."""

UNKNOWN = -1.0
"""Shift of photos that was not measured, or not yet."""

LESS_MOVED = 0.1
"""Share of a pixel that photos move where they would turn by one: turns do nearly the same."""

COST = 0.04
"""Share of a training's time that corrections take."""


class PoseCorrections(nn.Module):
    """A correction of each photo's pose, 0 at first.

    It is learned in units of a pixel: turns by what a pixel sees, moves by as much at the scene's distance. So one rate
    is right for pictures of all sizes. With the setting `auto` most are corrected in the first part of a training, and
    taken back where they moved hardly further than chance would: what they would do then is follow the noise.

    Parameters
    ----------
    photos
        That are learned from.
    middle_enu_m
        Of the scene, shape (3,).
    """

    def __init__(self, photos: Sequence[PosedPhoto], middle_enu_m: Array) -> None:
        super().__init__()
        focal_px = torch.tensor([photo.intrinsics.fx_px for photo in photos])
        ways = np.array([middle_enu_m - photo.pose.position_enu_m for photo in photos])
        axes = np.array([photo.pose.cam_from_enu[2] for photo in photos])
        distances = torch.from_numpy(np.maximum(np.linalg.norm(ways, axis=1), LEAST_DISTANCE_M)).float()
        self.pixels = nn.Parameter(torch.zeros(len(photos), 6))
        self.focal_px: Tensor
        self.register_buffer("focal_px", focal_px.float())
        self.distances_m: Tensor
        self.register_buffer("distances_m", distances)
        self.axes: Tensor
        self.register_buffer("axes", torch.from_numpy(axes).float())
        self.shift_px: Tensor
        self.register_buffer("shift_px", torch.tensor(UNKNOWN))
        self.mean: Tensor
        self.register_buffer("mean", torch.zeros(len(photos), 6))
        self.n_in_mean: Tensor
        self.register_buffer("n_in_mean", torch.tensor(0))

    def forward(self, number: int) -> Tensor:
        """Correction of a photo as `Move` has it, shape (6,)."""
        return self._moves(self.pixels)[number]

    def _moves(self, pixels: Tensor) -> Tensor:
        units = torch.stack([LESS_MOVED * self.distances_m / self.focal_px, 1.0 / self.focal_px], dim=1)
        return pixels * units.repeat_interleave(3, dim=1)

    @torch.no_grad()
    def project(self) -> None:
        """Take away what all have in common; to be called after each step."""
        self.pixels.sub_(self.pixels.mean(dim=0))

    @torch.no_grad()
    def moves(self) -> tuple[Move, ...]:
        """Of all photos."""
        return _rows(self._moves(self.pixels))

    def is_learned(self, setting: EffectSetting, number: int) -> bool:
        """Whether the next step corrects the pose of a photo if it looks at that."""
        shift_px = float(self.shift_px)
        if setting != "auto":
            return setting == "on"
        return number % EACH_STAYS != 1 if shift_px == UNKNOWN else shift_px > OwnPoses().tolerance

    @torch.no_grad()
    def settle(self, setting: EffectSetting, progress: float, n_looks: int, rate_px: float) -> None:
        """Measure how far photos were moved, once; with `auto`, take corrections back that are not worth it.

        To be called before each step.

        Parameters
        ----------
        progress
            Of the training, 0 to 1.
        n_looks
            At all photos together, so far.
        rate_px
            Of a step of Adam; what chance alone moves photos by is taken off, see `WANDER`.
        """
        if progress < MEAN_FROM * TRIED or setting == "off" or float(self.shift_px) != UNKNOWN:
            return
        self.n_in_mean += 1
        self.mean += (self.pixels - self.mean) / self.n_in_mean
        if progress < TRIED:
            return
        shift, turn = self._moves(self.mean).split_with_sizes([3, 3], dim=1)
        seen = shift / self.distances_m[:, None] + torch.linalg.cross(turn, self.axes)
        across = seen - (seen * self.axes).sum(dim=1, keepdim=True) * self.axes
        are_tried = [self.is_learned(setting, number) for number in range(len(self.pixels))]
        moved_px = float((self.focal_px * across.norm(dim=1))[are_tried].median())
        chance_px = WANDER * rate_px * math.sqrt(len(self.pixels) / max(n_looks, 1))
        self.shift_px.fill_(math.sqrt(max(moved_px**2 - chance_px**2, 0.0)))
        if not self.is_learned(setting, 0):
            self.pixels.zero_()

    def decision(self, setting: EffectSetting, seconds: float) -> Decision:
        """About all of it; `seconds` is what the training takes."""
        return decide(OwnPoses(), PoseShift(float(self.shift_px), COST * seconds), setting)


def moved_view(view: View, move: Tensor) -> View:
    """A view from where its correction puts it."""
    values = move.detach().double().cpu()
    turn = torch.from_numpy(Rotation.from_rotvec(values[3:].numpy()).as_matrix())
    matrix = view.cam_from_world.clone()
    rotation = matrix[:3, :3].clone()
    position = values[:3] - rotation.T @ matrix[:3, 3]
    matrix[:3, :3] = rotation @ turn.T
    matrix[:3, 3] = -matrix[:3, :3] @ position
    return replace(view, cam_from_world=matrix)


def pulled(means: Tensor, quats: Tensor, position_m: Tensor, move: Tensor) -> tuple[Tensor, Tensor]:
    """The same splats, bit by bit, whose gradients are those of the camera's correction, too.

    A camera that moves sees what a camera sees that stays while all splats move the other way. The first order of that
    motion is added to the splats with a value of 0.

    Parameters
    ----------
    means, quats
        Places, shape (n, 3), and rotations, w first, shape (n, 4), of splats.
    position_m
        The corrected camera's, shape (3,).
    move
        Its correction, shape (6,). The rotation vector's own derivative is taken for that of the turn, which is right
        to half of the vector's length: 1e-3 of the gradient for a correction of 0.1 degrees.
    """
    still = (move - move.detach()).to(means)
    turn = still[3:]
    away = -still[:3] - torch.linalg.cross(turn.expand_as(means), means.detach() - position_m.to(means))
    w, axis = quats.detach()[:, :1], quats.detach()[:, 1:]
    turned = turn.expand_as(axis)
    spin = torch.cat([(turned * axis).sum(dim=1, keepdim=True), -w * turned - torch.linalg.cross(turned, axis)], dim=1)
    return means + away, quats + 0.5 * spin
