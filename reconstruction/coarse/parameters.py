"""What can be asked of a coarse model; it loads nothing that makes one, for lists and `-h`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from planning.base.effects import EffectSetting
from planning.base.parameters import Choice, check, parameter
from planning.parameters import LARGEST_SEED

if TYPE_CHECKING:
    from planning.geo.frames import Origin
    from planning.photos.places import PhotoHeights

CameraWord = Literal["wide", "zoom", "thermal", "band"]
"""`reconstruction.photos.lens.CameraKind`, as it is typed."""


@dataclass(frozen=True, slots=True)
class CoarseRequest:
    """What is to be made.

    Parameters
    ----------
    photos, out
        Folder of photos, and of what is made of them.
    camera, control
        Files of the camera's numbers and of ground control points.
    distances
        Names of two photos, and the metres between where they were taken.
    origin
        Where this is, if the photos do not say so.
    """

    photos: Path
    out: Path
    camera: Path | None = None
    control: Path | None = None
    distances: tuple[tuple[str, str, float], ...] = ()
    origin: Origin | None = None
    heights: PhotoHeights = parameter(
        "auto",
        "which heights of photos count",
        choices=(Choice("auto"), Choice("takeoff"), Choice("absolute")),
        option="--heights",
    )
    lens: CameraWord | None = parameter(
        None,
        "which of several cameras",
        choices=(Choice("wide"), Choice("zoom"), Choice("thermal"), Choice("band")),
        option="--lens",
        unset="the wide one",
    )
    size_px: int = parameter(
        1600, "longer side that photos are reduced to", unit="px", least=1, option="--size", metavar="PX"
    )
    seed: int = parameter(0, "of random choices", least=0, most=LARGEST_SEED, option="--seed", metavar="N")
    dense: EffectSetting = parameter(
        "auto",
        "look in the photos for walls that have too few points; auto: where that is a tenth of them",
        choices=(Choice("auto"), Choice("on"), Choice("off")),
        option="--dense",
    )
    find_lens: EffectSetting = parameter(
        "auto",
        "find the lens from the photos; auto: a calibration stays unless they contradict it",
        choices=(Choice("auto"), Choice("on"), Choice("off")),
        option="--find-lens",
    )

    def __post_init__(self) -> None:
        check(self)
