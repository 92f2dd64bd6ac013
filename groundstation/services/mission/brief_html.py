"""The flight brief as one page of HTML 4 with tables: browsers print it, and so does Qt's text document.

The pictures are named, not held: whoever shows the page says where they are (data in the page, or a resource of the
document).
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.shapes import PlanShapes, SiteShapes, plan_shapes, round_length, site_shapes
from groundstation.services.map.web_mercator import geodetic_from_world, metres_per_point
from groundstation.services.messages import Translate
from groundstation.services.mission.brief import FlightBrief
from groundstation.services.mission.readiness import Readiness, duration_text, measured_text
from groundstation.services.mission.sunlight import HEIGHTS, Look, SunReport, day_rows, hour_marks
from groundstation.services.mission.waypoints import HeightLimits, ProfileCurves, height_limits, plan_profiles
from groundstation.services.units import (
    UnitSystem,
    distance_unit,
    length_unit,
    minutes_text,
    per_cent,
    sampling_unit,
    speed_unit,
)
from missions.formats.encode import TakeoffCheck
from missions.mission.export_choices import LinkLoss
from planning.base.findings import Severity
from planning.insight.flight_profile import LOW_M
from planning.insight.ground_risk import GroundRisk
from planning.insight.ground_risk_class import ground_risk_tables
from planning.plan import Plan
from planning.site.ground import ground_of
from planning.site.records import SiteModel

# Pictures of the flight brief as SVG: the map of the site with the routes, and the height profile of each sortie.
#
# SVG Tiny 1.2 only (no style sheets, no clipping), which browsers and Qt draw alike.

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

    parts = [
        _rings([place(ring) for ring in zone.rings], "#fbe3d6" if zone.is_kept else "none", "#c2570c")
        for zone in reversed(site.zones)
    ]
    parts.append(_rings([place(ring) for ring in site.airspace.rings], "none", GREY, 'stroke-dasharray="6 4"'))
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
    terrain = curves.ground
    lowest_m = limits.ground_m if terrain is None else float(np.nanmin(terrain.height_m, initial=0.0))
    low_m = min(float(curves.height_m.min()), lowest_m, 0.0)
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
    if terrain is not None:
        for part in _known_parts(terrain.height_m):
            line = place(terrain.t_s[part], terrain.height_m[part])
            parts.append(f'<polyline points="{_points(line)}" fill="none" stroke="#8a5300" stroke-width="1.4"/>')
    level = (limits.ground_m,) if terrain is None else ()
    for limit_m in (*level, limits.floor_m, limits.ceiling_m):
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


SUN_ROW, SUN_LABEL, SUN_FOOT = 24.0, 110.0, 44.0
"""Height of a row of the bar over the day, and room for names beside it and for hours and a legend below."""

SUN_LOOKS = {
    Look.NIGHT: "#5b6570",
    Look.SKY: "#cfe3f5",
    Look.SUN: "#f0b400",
    Look.PARTLY: "#d55e00",
    Look.SHADE: "#7f8b96",
    Look.GOOD: "#009e73",
    Look.FAIR: "#e0c23c",
    Look.BAD: "#d55e00",
}


def sun_svg(report: SunReport, tr: Translate, localize: Callable[[str], str]) -> str:
    """The day of a site as rows: when the sun is up, light on facades, take-offs of sorties; hours below."""
    rows = day_rows(report)
    width, height = MAP_SIZE[0], SUN_ROW * len(rows) + SUN_FOOT
    left, wide = SUN_LABEL, MAP_SIZE[0] - SUN_LABEL - 24.0
    parts = []
    for number, row in enumerate(rows):
        top, tall = number * SUN_ROW + 3.0, SUN_ROW - 6.0
        parts.append(_text((left - 6.0, top + tall - 4.0), localize(row.name), INK, "end"))
        for stretch in row.stretches:
            share = HEIGHTS[stretch.look]
            x, long = left + wide * stretch.first, wide * (stretch.last - stretch.first)
            box = f'x="{x:.1f}" y="{top + (1.0 - share) * tall:.1f}" width="{long:.1f}" height="{share * tall:.1f}"'
            if stretch.look is Look.FLIGHT:
                parts.append(f'<rect {box} fill="none" stroke="{INK}" stroke-width="2"/>')
            else:
                parts.append(f'<rect {box} fill="{SUN_LOOKS[stretch.look]}"/>')
        parts.append(f'<rect x="{left}" y="{top}" width="{wide}" height="{tall}" fill="none" stroke="{GREY}"/>')
    for at, text in hour_marks(report.day.track):
        x = left + wide * at
        parts.append(f'<line x1="{x:.1f}" y1="0" x2="{x:.1f}" y2="{height - SUN_FOOT + 3.0:g}" stroke="{GREY}"/>')
        parts.append(_text((x, height - SUN_FOOT + 16.0), text, INK))
    legend = tr("Tall, half, low: facades in the sun, in part, in shade; take-offs that spoil no, few, many photos")
    parts.append(_text((left, height - 6.0), legend, INK, "start"))
    return _svg((width, height), parts)


def _known_parts(values: Floats) -> list[slice]:
    """Stretches of values that are known, of two and more."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    starts, ends = np.flatnonzero(known[1:] & ~known[:-1]), np.flatnonzero(known[:-1] & ~known[1:])
    return [slice(start, end) for start, end in zip(starts.tolist(), ends.tolist(), strict=True) if end - start > 1]


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
    escaped = escape(text, quote=False)
    return f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}" fill="{colour}">{escaped}</text>'


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


MAP, SUN = "map", "sun"
"""Names of the pictures of map and day; those of the profiles are `profile_name(number)`."""

WIDTH_PX = 680
"""Of the page's content; A4 less margins of 15 mm is 680 px of 1/96 inch."""


def profile_name(number: int) -> str:
    """Name of the picture of a sortie's profile."""
    return f"profile-{number}"


def brief_pictures(
    site_model: SiteModel,
    plan: Plan,
    units: UnitSystem,
    tr: Translate = str,
    sun: SunReport | None = None,
    localize: Callable[[str], str] = str,
) -> dict[str, str]:
    """All pictures of a brief as SVG, by name; `localize` says messages in the user's language."""
    shapes = site_shapes(site_model)
    pictures = {MAP: map_svg(shapes, plan_shapes(plan, site_model.site.origin), units)}
    if sun is not None:
        pictures[SUN] = sun_svg(sun, tr, localize)
    height = tr("height above take-off [{0}]").format(length_unit(units).symbol)
    limits = height_limits(site_model)
    for curves in plan_profiles(plan, ground_of(site_model.site)):
        svg = profile_svg(curves, limits, units, (height, tr("time [min]")))
        pictures[profile_name(curves.sortie)] = svg
    return pictures


def sources_in_page(pictures: Mapping[str, str]) -> dict[str, str]:
    """Sources that carry the pictures inside the page, so that it is one file."""
    return {
        name: "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode() for name, svg in pictures.items()
    }


def brief_html(
    brief: FlightBrief,
    units: UnitSystem,
    sources: Mapping[str, str],
    tr: Translate = str,
    is_letter: bool | None = None,
) -> str:
    """The page.

    Parameters
    ----------
    sources
        Where each picture is found, by its name; those without one are left out.
    tr
        Brings the page's own words into the user's language; findings stay as they are.
    is_letter
        Paper: US Letter, else A4; by the units where None.
    """
    is_letter = units is UnitSystem.IMPERIAL if is_letter is None else is_letter
    title = tr("Flight brief: {0}").format(brief.site)
    body = [
        f"<h1>{escape(title)}</h1>",
        _verdict(brief, tr),
        _table(_overview(brief, units, tr)),
        f"<h2>{escape(tr('Take-off and landing'))}</h2>",
        _table(_takeoff(brief, units, tr)),
        f"<h2>{escape(tr('Sorties'))}</h2>",
        _sorties(brief, units, tr),
        f"<h2>{escape(tr('Set on the remote controller'))}</h2>",
        _table(_settings(brief, units, tr)),
        f"<h2>{escape(tr('Findings'))}</h2>",
        _findings(brief, units, tr),
        *_zones(brief, tr),
        f"<h2>{escape(tr('Before take-off'))}</h2>",
        _checklist(_steps(brief, units, tr)),
    ]
    if brief.sun:
        body.append(f"<h2>{escape(tr('Sun'))}</h2>")
        body += [f"<p>{escape(line)}</p>" for line in brief.sun]
    if SUN in sources:
        body.append(f'<p><img src="{sources[SUN]}" width="{WIDTH_PX}" alt="{escape(tr("Sun"))}"></p>')
    if MAP in sources:
        body.append(f'<h2 style="page-break-before: always">{escape(tr("Map"))}</h2>')
        body.append(f'<p><img src="{sources[MAP]}" width="{WIDTH_PX}" alt="{escape(tr("Map"))}"></p>')
    for sortie in brief.sorties:
        source = sources.get(profile_name(sortie.number))
        if source is not None:
            heading = escape(tr("Height of sortie {0}").format(sortie.number))
            body.append(f'<h3>{heading}</h3><p><img src="{source}" width="{WIDTH_PX}" alt="{heading}"></p>')
    return _PAGE.format(title=escape(title), size="letter" if is_letter else "A4", body="\n".join(body))


_PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>{title}</title>
<style>
@page {{ size: {size}; margin: 15mm; }}
body {{ font-family: sans-serif; font-size: 9pt; color: #000000; }}
h1 {{ font-size: 15pt; margin: 0px 0px 4px 0px; }}
h2 {{ font-size: 11pt; margin: 6px 0px 1px 0px; }}
h3 {{ font-size: 10pt; margin: 8px 0px 0px 0px; }}
p {{ margin: 2px 0px; }}
th {{ text-align: left; background-color: #e6e9ec; }}
</style></head><body>
{body}
</body></html>
"""

_TABLE = '<table width="100%" border="1" cellspacing="0" cellpadding="2" style="border-collapse: collapse">'


def _verdict(brief: FlightBrief, tr: Translate) -> str:
    if brief.readiness is not Readiness.NOT_READY:
        kept, warned = "All pre-flight rules are kept: ready to fly.", "Ready to fly, but read the warnings."
        return f"<p><b>{escape(tr(kept if brief.readiness is Readiness.READY else warned))}</b></p>"
    return f'<p><b><span style="color: #b3261e">{escape(tr("NOT ready to fly: see the findings."))}</span></b></p>'


def _overview(brief: FlightBrief, units: UnitSystem, tr: Translate) -> Iterable[tuple[str, str]]:
    length, speed = length_unit(units), speed_unit(units)
    yield tr("Date"), brief.planned_on
    if brief.day.at is not None:
        yield tr("Planned for"), f"{brief.day.at:%Y-%m-%d %H:%M}"
    if brief.day.temperature_c is not None:
        yield tr("Temperature"), f"{brief.day.temperature_c:g} \u00b0C"
    yield tr("Plan"), brief.plan_title
    yield tr("Aircraft and camera"), ", ".join(dict.fromkeys((brief.aircraft, brief.camera)))
    yield tr("Photos"), str(brief.n_photos)
    yield tr("Batteries needed"), str(brief.n_batteries)
    total_s = sum(sortie.duration_s for sortie in brief.sorties)
    yield tr("Flight time, all sorties"), duration_text(total_s)
    if brief.worth is not None:
        each = (
            f"{b.n_batteries} ({duration_text(60.0 * b.minutes)}): {b.psnr_db:.1f} dB" for b in brief.worth.batteries
        )
        deviation = f" (\u00b1 {brief.worth.deviation_db:.1f} dB)"
        yield tr("Unseen views of the model, expected, by batteries"), "; ".join(each) + deviation
        yield tr("Another battery would bring"), f"{brief.worth.gain_db:+.1f} dB"
    if brief.proof:
        yield tr("Independent check"), brief.proof
    yield tr("Directions of view seen, of those possible"), f"{per_cent(brief.covered_share, 1.0):.1f} %"
    if brief.sharp_share is not None and brief.wanted_gsd_mm and brief.coarsest_gsd_mm is not None:
        pixel = sampling_unit(units)
        yield (
            tr("Pixel on the panel"),
            tr("{0} of what is covered with up to {1}, the coarsest with {2}").format(
                f"{per_cent(brief.sharp_share, 1.0):.1f} %",
                pixel.text(brief.wanted_gsd_mm / 1000.0),
                pixel.text(brief.coarsest_gsd_mm / 1000.0),
            ),
        )
    yield tr("Height above ground"), _heights(brief, units, tr)
    near = [s.smallest_clearance_m for s in brief.sorties if s.smallest_clearance_m is not None]
    kept = tr("{0} along the paths, {1} to be kept").format(
        length.text(min(near)) if near else tr("not measured"), length.text(brief.min_distance_m)
    )
    yield tr("Smallest distance to building and obstacles"), kept
    wind = tr("planned for {0}, the aircraft may fly below {1}")
    if brief.ground_risk is not None:
        yield tr("Ground risk (SORA 2.5, a draft)"), _ground_risk(brief.ground_risk, units, tr)
        yield from _classes(brief.ground_risk, tr)
        yield tr("Uninvolved people inside the buffer"), _people(brief.ground_risk, tr)
    yield tr("Wind"), wind.format(speed.text(brief.wind_m_s), speed.text(brief.max_wind_m_s))


def _ground_risk(risk: GroundRisk, units: UnitSystem, tr: Translate) -> str:
    length = length_unit(units)
    return tr("contingency volume {0} to each side, up to {1} above ground; ground-risk buffer {2} beyond").format(
        length.text(risk.value_of("S_CV")), length.text(risk.contingency_top_m), length.text(risk.value_of("S_GRB"))
    )


def _classes(risk: GroundRisk, tr: Translate) -> Iterable[tuple[str, str]]:
    """Ground risk classes, what went into each, and which table it is from."""
    tables, of = ground_risk_tables(), tr("{0}: {1} [{2}]")
    if risk.intrinsic_class is not None:
        said = of.format(risk.intrinsic_class, risk.how_intrinsic, tables.source)
        yield tr("Intrinsic ground risk class"), said
    if risk.final_class is not None:
        yield tr("Final ground risk class"), of.format(risk.final_class, risk.how_final, tables.mitigation_source)


def _people(risk: GroundRisk, tr: Translate) -> str:
    if risk.band is None:
        return tr("not stated how many: keep everybody out")
    if risk.band.word == "controlled":
        return tr("none: controlled ground area")
    if math.isinf(risk.band.below_per_km2):
        return tr("an assembly of people")
    return tr("fewer than {0} per square kilometre").format(f"{risk.band.below_per_km2:g}")


def _heights(brief: FlightBrief, units: UnitSystem, tr: Translate) -> str:
    length, low, greatest = length_unit(units), brief.low, length_unit(units).text(brief.max_above_ground_m)
    if low is None:
        return tr("at most {0}").format(greatest)
    heights = tr("{0} to {1}, at least {2} to be kept but at take-off").format(
        length.text(low.lowest_m), greatest, length.text(brief.min_height_m)
    )
    if low.below_s is None or low.lowest_m >= LOW_M:
        return heights
    return tr("{0}; {1} below {2}").format(heights, duration_text(low.below_s), length.text(LOW_M))


def _takeoff(brief: FlightBrief, units: UnitSystem, tr: Translate) -> Iterable[tuple[str, str]]:
    place, length = brief.takeoff, length_unit(units)
    yield tr("Position (WGS 84)"), f"{place.lat_deg:.7f}°, {place.lon_deg:.7f}°"
    yield tr("Height above sea level (EGM96)"), length.text(place.altitude_amsl_m)
    yield tr("Height above the ellipsoid (WGS 84)"), length.text(place.height_ellipsoid_m)
    yield tr("Height above ground"), length.text(place.above_ground_m)


def _sorties(brief: FlightBrief, units: UnitSystem, tr: Translate) -> str:
    length, distance = length_unit(units), distance_unit(units)
    titles = (
        tr("Sortie"),
        tr("Photos"),
        tr("Time [min]"),
        tr("Length"),
        tr("Battery used"),
        tr("Highest above take-off"),
        tr("Highest above sea (EGM96)"),
        tr("Smallest distance"),
    )
    rows = [
        (
            str(sortie.number)
            if sortie.start_s is None
            else tr("{0}: aircraft {1}, starts at {2}").format(
                sortie.number, sortie.aircraft, minutes_text(sortie.start_s)
            ),
            str(sortie.n_photos),
            minutes_text(sortie.duration_s),
            distance.text(sortie.length_m),
            f"{sortie.battery_share:.0%}",
            length.text(sortie.max_above_takeoff_m),
            length.text(sortie.max_altitude_amsl_m),
            "–" if sortie.smallest_clearance_m is None else length.text(sortie.smallest_clearance_m),
        )
        for sortie in brief.sorties
    ]
    return _grid(titles, rows) if rows else f"<p>{escape(tr('The plan has no sorties.'))}</p>"


def _settings(brief: FlightBrief, units: UnitSystem, tr: Translate) -> Iterable[tuple[str, str]]:
    height_m = brief.return_height_m
    yield (
        tr("Return height, above take-off"),
        tr("not known") if height_m is None else length_unit(units).text(height_m),
    )
    links = {
        LinkLoss.CONTINUE: tr("continue mission"),
        LinkLoss.GO_HOME: tr("return home straight, at the return height"),
    }
    yield tr("Without radio link"), links[brief.link_loss]
    yield tr("Battery reserve at landing"), f"{brief.battery_reserve:.0%}"
    yield tr("Highest speed"), speed_unit(units).text(brief.max_speed_m_s)
    yield tr("Hover before each photo"), f"{brief.settle_s:g} s"
    if brief.camera_by_hand:
        yield tr("Camera, by hand"), "; ".join(brief.camera_by_hand)
    if brief.camera_by_mission:
        yield tr("Camera, by the mission"), "; ".join(brief.camera_by_mission)


def _findings(brief: FlightBrief, units: UnitSystem, tr: Translate) -> str:
    if not brief.findings:
        return f"<p>{escape(tr('None: every rule is kept.'))}</p>"
    words = {
        Severity.ERROR: tr("ERROR"),
        Severity.WARNING: tr("Warning"),
        Severity.NOTE: tr("Note"),
    }
    rows = [
        (
            words[found.severity],
            found.message,
            "" if found.value is None else measured_text(found.value, found.unit, units),
            found.place,
        )
        for found in brief.findings
    ]
    return _grid((tr("Severity"), tr("Finding"), tr("Measured"), tr("Place")), rows)


def _zones(brief: FlightBrief, tr: Translate) -> Iterable[str]:
    """What the check says of geo-zones and their sources, kept or not."""
    if brief.zones:
        yield f"<h2>{escape(tr('Geo-zones'))}</h2>"
        yield f"<ul>{''.join(f'<li>{escape(found.message)}</li>' for found in brief.zones)}</ul>"


def _steps(brief: FlightBrief, units: UnitSystem, tr: Translate) -> Iterable[str]:
    length, speed = length_unit(units), speed_unit(units)
    yield tr("Permission for this place and height is at hand; nobody is below the paths")
    if brief.low is not None and brief.low.lowest_m < LOW_M:
        yield tr("Nobody walks and nothing stands or hangs where the paths come down to {0} above the ground").format(
            length.text(brief.low.lowest_m)
        )
    if brief.no_fly:
        yield tr("No-fly zones known to everybody: {0}").format(", ".join(brief.no_fly))
    known = ", ".join(brief.obstacles) if brief.obstacles else tr("none")
    yield tr("Nothing stands within {0} of the paths but what the site knows (building; obstacles: {1})").format(
        length.text(brief.min_distance_m), known
    )
    yield tr("Fully charged batteries: {0}; free space for photos: {1}").format(brief.n_batteries, brief.n_photos)
    yield tr("Aircraft stands on the take-off point; GNSS (RTK where there is one) has a fix, compass is calibrated")
    if brief.return_height_m is not None:
        yield tr("Return height on the remote controller is at least {0} above take-off").format(
            length.text(brief.return_height_m)
        )
    yield tr("Wind at flight height is below {0}").format(speed.text(brief.max_wind_m_s))
    yield tr("The mission on the remote controller is this plan (photos: {0})").format(brief.n_photos)
    yield tr("The camera is set as listed, its focus on the facade")
    for sortie in brief.sorties:
        if sortie.takeoff_check is not None:
            yield _takeoff_check(sortie.takeoff_check, units, tr)


def _takeoff_check(check: TakeoffCheck, units: UnitSystem, tr: Translate) -> str:
    length = length_unit(units)
    seen = tr("{0} above take-off").format(length.text(check.above_takeoff_m))
    if check.facade:
        edge = tr("the upper edge of facade {0}") if check.is_upper_edge else tr("the lower edge of facade {0}")
        side = tr("{0} above {1}") if check.above_edge_m >= 0.0 else tr("{0} below {1}")
        seen += ", " + side.format(length.text(abs(check.above_edge_m)), edge.format(check.facade))
    return tr(
        "Sortie {0}: before any photo the aircraft stops {1}. Where it does not, land: it took off from another height "
        "than planned"
    ).format(check.sortie, seen)


def _table(rows: Iterable[tuple[str, str]]) -> str:
    lines = [f'<tr><th width="40%">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in rows]
    return f"{_TABLE}{''.join(lines)}</table>"


def _grid(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(title)}</th>" for title in titles)
    lines = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    return f"{_TABLE}<tr>{head}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _checklist(steps: Iterable[str]) -> str:
    lines = [f'<tr><td width="24">&#9744;</td><td>{escape(step)}</td></tr>' for step in steps]
    return f'<table width="100%" cellpadding="0">{"".join(lines)}</table>'
