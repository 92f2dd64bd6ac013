"""What a site looks like: glass, profiles, walls, light and surroundings; one frozen record, loadable from TOML."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from planning.base.json_file import check_settings, read_toml, to_record
from reconstruction.scenes.record import Glass, Rgb


@dataclass(frozen=True, slots=True)
class Look:
    """Settings of a scene; everything random about it comes from the seed.

    Parameters
    ----------
    near
        With ground, opposite buildings, trees, cars and people. Without, the building stands alone before a panorama
        that is infinitely far away, its ground included, so that nothing in it shows parallax; only the site's own
        obstacles stay.
    glass
        Of the panes; some are dirtier, and some were replaced by panes of another coating.
    replaced
        Share of the panes that were.
    tilt_deg
        Standard deviation of each pane's tilt about both its axes.
    bow_deg
        How far the normal turns from the middle of a pane to its edges, on average: sealed units bulge with the
        pressure in them. From pane to pane it varies by 30 %.
    curved_glass
        Panes are curved as their facade is, so that side by side they make one smooth surface: bent glass on a round
        tower. Otherwise facades are faceted.
    frame_width_m
        Of profiles where panels meet without a gap, or end. A gap between panels is filled by its profile.
    frame_depth_m
        How far profiles stand out before the glass.
    frame_albedo, wall_albedo
        Share of light that profiles and walls send back.
    blinds
        Share of the rooms with a blind pulled down by a random part.
    spandrel_every
        Every so many rows of each facade, counted from its foot, are spandrels: glass painted behind, which mirrors
        like all other and shows no room. 0 for none.
    street_m
        From a facade to the buildings opposite.
    opposite_height_m
        Lowest and highest of them.
    tree_spacing_m, car_spacing_m, people_spacing_m
        Mean distances along the street; 0 for none.
    sun_heading_deg, sun_elevation_deg
        Where the sun stands, clockwise from north and above the horizon.
    clouds
        Share of the sky that they cover.
    skyline_deg
        Elevation of the highest building on the horizon.
    """

    near: bool = True
    glass: Glass = field(default_factory=lambda: Glass(coating=0.25, dirt=0.02))
    replaced: float = 0.05
    tilt_deg: float = 0.2
    bow_deg: float = 0.15
    curved_glass: bool = False
    frame_width_m: float = 0.06
    frame_depth_m: float = 0.05
    frame_albedo: Rgb = (0.16, 0.16, 0.17)
    wall_albedo: Rgb = (0.62, 0.6, 0.56)
    blinds: float = 0.35
    spandrel_every: int = 0
    street_m: float = 28.0
    opposite_height_m: tuple[float, float] = (14.0, 34.0)
    tree_spacing_m: float = 9.0
    car_spacing_m: float = 8.0
    people_spacing_m: float = 1.7
    sun_heading_deg: float = 200.0
    sun_elevation_deg: float = 50.0
    clouds: float = 0.35
    skyline_deg: float = 7.0

    def __post_init__(self) -> None:
        for name in ("replaced", "blinds", "clouds"):
            _check(name, getattr(self, name), 0.0, 1.0)
        for name in ("tilt_deg", "bow_deg"):
            _check(name, getattr(self, name), 0.0, 5.0)
        for name in ("frame_width_m", "frame_depth_m"):
            _check(name, getattr(self, name), 0.0, 0.5)
        for name in ("frame_albedo", "wall_albedo"):
            for part in getattr(self, name):
                _check(name, part, 0.0, 1.0)
        _check("spandrel_every", self.spandrel_every, 0, 1000)
        _check("street_m", self.street_m, 4.0, 500.0)
        for name in ("tree_spacing_m", "car_spacing_m", "people_spacing_m"):
            _check(name, getattr(self, name), 0.0, 1000.0)
        _check("sun_heading_deg", self.sun_heading_deg, -360.0, 360.0)
        _check("sun_elevation_deg", self.sun_elevation_deg, -90.0, 90.0)
        _check("skyline_deg", self.skyline_deg, 0.0, 45.0)
        low, high = self.opposite_height_m
        if not 3.0 <= low <= high <= 500.0:
            raise ValueError(f"opposite_height_m: expected lowest and highest of 3 to 500, got {low} and {high}")


def _check(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name}: expected {low:g} to {high:g}, got {value}")


def read_look(path: Path) -> Look:
    """Look from a TOML file with any of the fields as keys, `glass` as a table; the others keep their defaults.

    Raises
    ------
    InputError
        The file cannot be read, or a key or value is none of ours; the message names it.
    """
    content = read_toml(path, dict[str, Any])
    check_settings(content, Look, path)
    glass = content.get("glass")
    if isinstance(glass, dict):
        check_settings(glass, Glass, path, "glass.")
    return to_record(content, Look, path)
