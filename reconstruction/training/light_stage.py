"""The first stage of a training, learning light alone: what it needs to go on after it was interrupted."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from torch import Tensor

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.json_file import to_record
from planning.base.messages import say
from reconstruction.light.glass_rays import GlassRays
from reconstruction.light.reflective_panels import ModelName
from reconstruction.training.checkpoints import write_checkpoint
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.record import SiteRecord

STAGE = "light stage"
"""Of a checkpoint's content; the joint training's has none."""


@dataclass(frozen=True, slots=True)
class LightStage:
    """What is settled when light begins to be learned.

    Parameters
    ----------
    name
        Of the model of light.
    decisions
        That led to it.
    time_limit_s
        For learning it.
    rays_sha256
        Checksum of the rays learned from.
    """

    config: TrainConfig
    site: SiteRecord
    name: ModelName
    decisions: tuple[Decision, ...]
    time_limit_s: float | None
    rays_sha256: str


@dataclass(frozen=True, slots=True, eq=False)
class BegunLight:
    """A first stage that was interrupted.

    Parameters
    ----------
    splats
        That were placed before.
    state
        Of `LightTraining`.
    spent_s
        That the whole training had taken until then.
    """

    stage: LightStage
    splats: dict[str, Tensor]
    state: dict[str, Any]
    spent_s: float


def write_light(path: Path, begun: BegunLight) -> None:
    """Write a checkpoint, whole or not at all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    write_checkpoint(
        path,
        {
            STAGE: asdict(begun.stage),
            "splats": begun.splats,
            "training": begun.state,
            "spent_s": begun.spent_s,
        },
    )


def begun_light(content: dict[str, Any], path: Path) -> BegunLight | None:
    """The first stage in the content of a checkpoint; None where it is of the joint training.

    Raises
    ------
    InputError
        It is damaged.
    """
    if STAGE not in content:
        return None
    stage = to_record(content[STAGE], LightStage, path)
    splats, state, spent_s = (content.get(name) for name in ("splats", "training", "spent_s"))
    if not isinstance(splats, dict) or not isinstance(state, dict) or not isinstance(spent_s, float):
        raise InputError(say("holds no state of a training; begin the training anew", place=path))
    return BegunLight(stage, splats, state, spent_s)


def checksum(rays: GlassRays) -> str:
    """SHA-256 of rays: of their pixels, colours, cameras and panels."""
    found = hashlib.sha256()
    for record in (rays, rays.table):
        for each in fields(record):
            value = getattr(record, each.name)
            if isinstance(value, Tensor):
                found.update(value.cpu().contiguous().numpy().data)
    return found.hexdigest()
