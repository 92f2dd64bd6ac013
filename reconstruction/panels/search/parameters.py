"""How panels are looked for: one frozen record, loadable from TOML."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from planning.base.effects import Wish
from planning.base.json_file import check_settings, read_toml, to_record

Detector = Literal["gradient", "hough", "lsd", "edlines", "fld"]
"""What finds line segments: our own along the axes of the picture, OpenCV's probabilistic Hough transform (the
paper's), LSD, EDLines and the fast line detector."""

DETECTORS: tuple[Detector, ...] = ("gradient", "hough", "lsd", "edlines", "fld")


@dataclass(frozen=True, slots=True)
class SegmentationParameters:
    """Settings of the search for panels; those up to `n_samples` trade quality for time.

    Parameters
    ----------
    long_side_px
        Pictures are made this long, at most, before lines are looked for. Shorter is faster and finds coarser edges.
    refined_long_side_px
        The edges of found lines are measured again in a picture of this size, at most.
    n_samples
        Pixels of a row or column that are compared in Eqs. 3 and 4, with `use_posterior`; 0 for all.
    detector
        Of lines in the rectified view.
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

    long_side_px: int = 1600
    refined_long_side_px: int = 5280
    n_samples: int = 512
    detector: Detector = "gradient"
    min_segment_px: float = 12.0
    beta: float = 20.0
    n_bands: int = 48
    min_panel_px: float = 10.0
    max_frame_px: float = 40.0
    max_frame_share: float = 0.5
    least_seen: float = 0.35
    straighten: bool = True
    max_tilt_deg: float = 6.0
    use_posterior: bool = False
    use_spacing: bool = True
    use_stillness: bool = True
    find_extent: bool = True
    inclined: Wish = "auto"
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("long_side_px", "refined_long_side_px", "n_bands"):
            if getattr(self, name) < 16:
                raise ValueError(f"{name}: expected 16 or more, got {getattr(self, name)}")
        if self.n_samples < 0:
            raise ValueError(f"n_samples: expected 0 (all) or more, got {self.n_samples}")
        if self.detector not in DETECTORS:
            raise ValueError(f"detector: expected one of {', '.join(DETECTORS)}, got {self.detector}")
        if self.inclined not in ("auto", "on", "off"):
            raise ValueError(f"inclined: expected auto, on or off, got {self.inclined}")
        for name in ("min_segment_px", "beta", "min_panel_px", "max_frame_px", "max_frame_share", "max_tilt_deg"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name}: expected more than 0, got {getattr(self, name)}")
        if not 0.05 <= self.least_seen <= 0.9:
            raise ValueError(f"least_seen: expected 0.05 to 0.9, got {self.least_seen}")
        if self.max_tilt_deg > 20.0:
            raise ValueError(f"max_tilt_deg: expected 20 at most, got {self.max_tilt_deg}")


def read_parameters(path: Path) -> SegmentationParameters:
    """Settings from a TOML file with any of the fields as keys; the others keep their defaults.

    Raises
    ------
    InputError
        The file cannot be read, or a key or value is none of ours; the message names it.
    """
    content = read_toml(path, dict[str, Any])
    check_settings(content, SegmentationParameters, path)
    return to_record(content, SegmentationParameters, path)
