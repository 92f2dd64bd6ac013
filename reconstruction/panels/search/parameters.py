"""How panels are looked for: one frozen record, loadable from TOML."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from planning.base.effects import EffectSetting
from planning.base.parameters import Choice, check, like, parameter
from planning.parameters import PlanParameters

Detector = Literal["gradient", "hough", "lsd", "edlines", "fld"]
"""What finds line segments: our own along the axes of the picture, OpenCV's probabilistic Hough transform (the
paper's), LSD, EDLines and the fast line detector."""

DETECTORS: tuple[Detector, ...] = ("gradient", "hough", "lsd", "edlines", "fld")


@dataclass(frozen=True, slots=True)
class SegmentationParameters:
    """Settings of the search for panels; those up to `n_samples` trade quality for time.

    Parameters
    ----------
    refined_long_side_px
        The edges of found lines are measured again in a picture of this size, at most.
    min_segment_px
        Shortest segment, for detectors of segments.
    beta
        Sharpness of the softmax (Eq. 8); 20 in the paper.
    n_bands
        Parts of a line whose support is counted for itself, so that a reflection strong in one place weighs little.
    min_panel_px, max_frame_px
        Shortest panel and widest frame profile, in pixels of the picture that is searched.
    max_frame_share
        Widest frame profile as a share of the usual panel beside it; above 1 for windows in walls.
    least_seen
        Share of a line that is seen at least; profiles of a curtain wall run through, and 0.35 of the worst one stands
        out from what is mirrored beside it. 0.2 for grids of concrete, whose edges are blunt.
    straighten
        Take remaining rotation and perspective out of the rectified view, up to `max_tilt_deg`.
    use_posterior
        Let lines borrow evidence from lines that look alike (Eqs. 5 and 6). Off: it takes as long as everything else
        and changes no result for the better (docs/concepts/segmentation.md).
    use_spacing
        Prefer spacings that repeat, infer lines that are missing from them and drop those that do not fit.
    use_stillness
        Count that profiles keep their brightness where glass mirrors something else from place to place.
    find_extent
        Look for the first and last line; off where the picture shows nothing but the facade.
    inclined
        Look for inclined lines, which cut panels: where the picture shows edges enough for one, always, or never.
    seed
        Of everything random.
    """

    long_side_px: int = parameter(
        1600,
        "shrink photos to this size, at most, before lines are looked for; shorter is faster and finds coarser edges",
        unit="px",
        least=16,
        option="--long-side",
        metavar="PX",
    )
    refined_long_side_px: int = parameter(5280, unit="px", least=16)
    n_samples: int = parameter(
        512,
        "pixels of a row or column that are compared in Eqs. 3 and 4, with use_posterior; 0 for all",
        least=0,
        expected="0 (all) or more",
        option="--samples",
        metavar="N",
    )
    detector: Detector = parameter(
        "gradient",
        "what finds lines in the rectified view: gradient, hough, lsd, edlines or fld",
        choices=tuple(Choice(name) for name in DETECTORS),
        expected=f"one of {', '.join(DETECTORS)}",
        option="--detector",
        metavar="NAME",
    )
    min_segment_px: float = parameter(12.0, unit="px", above=0.0)
    beta: float = parameter(20.0, above=0.0)
    n_bands: int = parameter(48, least=16)
    min_panel_px: float = parameter(10.0, unit="px", above=0.0)
    max_frame_px: float = parameter(40.0, unit="px", above=0.0)
    max_frame_share: float = parameter(0.5, unit="share", above=0.0)
    least_seen: float = parameter(0.35, unit="share", least=0.05, most=0.9)
    straighten: bool = parameter(True)
    max_tilt_deg: float = parameter(
        6.0, "how much rotation and perspective `straighten` takes out", unit="deg", above=0.0, most=20.0
    )
    use_posterior: bool = parameter(False)
    use_spacing: bool = parameter(True)
    use_stillness: bool = parameter(True)
    find_extent: bool = parameter(True)
    network: EffectSetting = parameter(
        "auto",
        "panes by the network in place of lines: where it contradicts them (auto), on or off",
        choices=(Choice("auto"), Choice("on"), Choice("off")),
        expected="one of auto, on, off",
        option="--network",
        metavar="WHEN",
    )
    inclined: EffectSetting = parameter("auto", choices=(Choice("auto"), Choice("on"), Choice("off")))
    seed: int = like(PlanParameters, "seed", 0, help="", option="", row="")

    def __post_init__(self) -> None:
        check(self)


def read_parameters(path: Path) -> SegmentationParameters:
    """Settings from a TOML file with any of the fields as keys; the others keep their defaults.

    Raises
    ------
    InputError
        The file cannot be read, or a key or value is none of ours; the message names it.
    """
    from planning.base.json_file import read_toml, settings_over  # not at the top: the command line describes itself

    return settings_over(SegmentationParameters(), read_toml(path, dict[str, Any]), path)
