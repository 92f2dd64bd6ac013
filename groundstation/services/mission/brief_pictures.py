"""Pictures of the flight brief as SVG: the map of the site with the routes, and the height profile of each sortie.

SVG Tiny 1.2 only (no style sheets, no clipping), which browsers and Qt draw alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.shapes import PlanShapes, SiteShapes, round_length
from groundstation.services.map.web_mercator import geodetic_from_world, metres_per_point
from groundstation.services.mission.profiles import HeightLimits, ProfileCurves
from groundstation.services.units import UnitSystem, length_unit

Floats = NDArray[np.float64]

MAP_SIZE = 720.0, 520.0
PROFILE_SIZE = 720.0, 170.0

SORTIES = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#8a6800", "#3a8fc0")
"""Of Okabe and Ito (2008), the light ones darker: they stand on white paper."""

DASHES = ("", "7 3", "2 3", "9 3 2 3", "12 4", "4 4")
"""Sorties differ on black-and-white printers, too."""

INK, GREY = "#202020", "#8d96a0"


def map_svg(site: SiteShapes, plan: PlanShapes, units: UnitSystem) -> str:
    """The site from above with the plan's routes and viewpoints, north up, with a scale bar."""
    width, height = MAP_SIZE
    extent = site.extent()
    low, high = extent.min(axis=0), extent.max(axis=0)
    scale = float(min((width - 40.0) / max(high[0] - low[0], 1e-12), (height - 60.0) / max(high[1] - low[1], 1e-12)))
    middle = (low + high) / 2.0

    def place(world: Floats) -> Floats:
        return np.asarray((world - middle) * scale + (width / 2.0, height / 2.0 - 10.0))

    parts = [_rings([place(ring) for ring in site.airspace.rings], "none", GREY, 'stroke-dasharray="6 4"')]
    parts += [_rings([place(ring) for ring in area.rings], "#d5dade", INK) for area in site.solids]
    for zone in site.no_fly:
        rings = [place(ring) for ring in zone.rings]
        parts.append(_rings(rings, "#f4c7c3", "#b3261e", 'stroke-width="2"'))
        parts.append(_text(rings[0].mean(axis=0), zone.item.id, "#b3261e"))
    for _, panels in site.facades:
        outlines = place(panels.reshape(-1, 2)).reshape(-1, 4, 2)
        parts.append(_rings(list(outlines), "none", "#0072b2", 'stroke-width="3"'))
    for number, route in enumerate(plan.routes):
        look = f'stroke="{SORTIES[number % 6]}" stroke-width="1.2"'
        if DASHES[number % 6]:
            look += f' stroke-dasharray="{DASHES[number % 6]}"'
        parts.append(f'<polyline points="{_points(place(route))}" fill="none" {look}/>')
    for spot, heading_deg, sortie in zip(place(plan.viewpoints), plan.headings_deg, plan.sortie_of, strict=True):
        colour = SORTIES[(int(sortie) - 1) % 6] if sortie else GREY
        turn = math.radians(float(heading_deg))
        tip = spot + 6.0 * np.array([math.sin(turn), -math.cos(turn)])
        parts.append(f'<polyline points="{_points(np.array([spot, tip]))}" fill="none" stroke="{colour}"/>')
        parts.append(f'<circle cx="{spot[0]:.1f}" cy="{spot[1]:.1f}" r="1.8" fill="{colour}"/>')
    for number, (x, y) in enumerate(place(site.landings())):
        colour, letter = ("#7a4fa3", "R") if number else ("#1b6e3c", "H")
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="9" fill="{colour}"/>')
        parts.append(_text((x, y + 4.5), letter, "#ffffff"))
    lat_deg, _ = geodetic_from_world(float(middle[0]), float(middle[1]))
    parts += _scale_bar(256.0 * metres_per_point(lat_deg, 0.0) / scale, units, height)
    parts += [_north(width)]
    return _svg(MAP_SIZE, parts)


def profile_svg(curves: ProfileCurves, limits: HeightLimits, units: UnitSystem, labels: tuple[str, str]) -> str:
    """Height above take-off over time of one sortie; `labels` name the height axis and the time axis."""
    width, height = PROFILE_SIZE
    left, right, top, bottom = 52.0, 12.0, 20.0, 34.0
    unit = length_unit(units)
    high_m = max(float(curves.height_m.max()), limits.floor_m, 1.0)
    low_m = min(float(curves.height_m.min()), limits.ground_m, 0.0)
    room = 0.08 * (high_m - low_m)
    low_m, high_m = low_m - room, high_m + room
    end_s = max(float(curves.t_s[-1]), 1.0)

    def place(t_s: Floats, height_m: Floats) -> Floats:
        x = left + t_s / end_s * (width - left - right)
        return np.stack([x, top + (high_m - height_m) / (high_m - low_m) * (height - top - bottom)], axis=-1)

    parts = [
        f'<rect x="{left}" y="{top}" width="{width - left - right}" height="{height - top - bottom}" fill="none" '
        f'stroke="{GREY}"/>'
    ]
    for value in _ticks(unit.shown(low_m), unit.shown(high_m), 4):
        y = float(place(np.zeros(1), np.array([unit.metric(value)]))[0, 1])
        parts.append(f'<line x1="{left}" y1="{y:.1f}" x2="{width - right}" y2="{y:.1f}" stroke="#d5dade"/>')
        parts.append(_text((left - 6.0, y + 4.0), f"{value:g}", INK, "end"))
    for minute in _ticks(0.0, end_s / 60.0, 8):
        x = float(place(np.array([minute * 60.0]), np.zeros(1))[0, 0])
        parts.append(_text((x, height - bottom + 14.0), f"{minute:g}", INK))
    for limit_m in (limits.ground_m, limits.floor_m, limits.ceiling_m):
        if low_m <= limit_m <= high_m:
            line = place(np.array([0.0, end_s]), np.array([limit_m, limit_m]))
            parts.append(f'<polyline points="{_points(line)}" fill="none" stroke="#8a5300" stroke-dasharray="6 3"/>')
    colour = SORTIES[(curves.sortie - 1) % 6]
    line = place(curves.t_s, curves.height_m)
    parts.append(f'<polyline points="{_points(line)}" fill="none" stroke="{colour}" stroke-width="1.4"/>')
    for x, y in place(curves.photo_t_s, curves.photo_height_m):
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.6" fill="{colour}"/>')
    parts.append(_text((left, top - 6.0), labels[0], INK, "start"))
    parts.append(_text((width / 2.0, height - 6.0), labels[1], INK))
    return _svg(PROFILE_SIZE, parts)


def _ticks(low: float, high: float, n_most: int) -> list[float]:
    """Round values from `low` to `high`, at most about `n_most`."""
    step = round_length(max(high - low, 1e-9) / n_most * 2.0)
    return [step * i for i in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _svg(size: tuple[float, float], parts: Iterable[str]) -> str:
    width, height = size
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" version="1.2" baseProfile="tiny" width="{width:g}" '
        f'height="{height:g}" viewBox="0 0 {width:g} {height:g}" font-family="sans-serif" font-size="12">'
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>{"".join(parts)}</svg>'
    )


def _rings(rings: list[Floats], fill: str, stroke: str, more: str = "") -> str:
    data = " ".join(f"M{_points(ring)}Z" for ring in rings)
    return f'<path d="{data}" fill="{fill}" fill-rule="evenodd" stroke="{stroke}" {more}/>'


def _points(points: Floats) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _text(at: Floats | tuple[float, float], text: str, colour: str, anchor: str = "middle") -> str:
    return f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'


def _scale_bar(metres_per_unit: float, units: UnitSystem, height: float) -> list[str]:
    unit = length_unit(units)
    length = round_length(unit.shown(150.0 * metres_per_unit))
    end = 12.0 + unit.metric(length) / metres_per_unit
    y = height - 10.0
    return [
        f'<polyline points="12,{y - 6:g} 12,{y:g} {end:.1f},{y:g} {end:.1f},{y - 6:g}" fill="none" stroke="{INK}"/>',
        _text(((12.0 + end) / 2.0, y - 5.0), f"{length:g} {unit.symbol}", INK),
    ]


def _north(width: float) -> str:
    x = width - 22.0
    arrow = f'<path d="M{x:g},8 L{x + 6:g},26 L{x - 6:g},26 Z" fill="{INK}"/>'
    return arrow + _text((x, 40.0), "N", INK)
