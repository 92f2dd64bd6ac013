"""The flight brief as one page of HTML 4 with tables: browsers print it, and so does Qt's text document.

The pictures are named, not held: whoever shows the page says where they are (data in the page, or a resource of the
document).
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from groundstation.services.map.shapes import plan_shapes, site_shapes
from groundstation.services.messages import Translate
from groundstation.services.mission.brief import FlightBrief
from groundstation.services.mission.brief_pictures import map_svg, profile_svg
from groundstation.services.mission.finding_texts import duration_text, measured_text
from groundstation.services.mission.profiles import height_limits, plan_profiles
from groundstation.services.mission.readiness import Readiness
from groundstation.services.units import (
    UnitSystem,
    distance_unit,
    length_unit,
    minutes_text,
    per_cent,
    sampling_unit,
    speed_unit,
)
from missions.dji.write import LinkLoss
from missions.formats.encode import TakeoffCheck
from planning.base.findings import Severity
from planning.insight.flight_profile import LOW_M
from planning.plan import Plan
from planning.site.records import SiteModel

MAP = "map"
"""Name of the map's picture; those of the profiles are `profile_name(number)`."""

WIDTH_PX = 680
"""Of the page's content; A4 less margins of 15 mm is 680 px of 1/96 inch."""


def profile_name(number: int) -> str:
    """Name of the picture of a sortie's profile."""
    return f"profile-{number}"


def brief_pictures(site_model: SiteModel, plan: Plan, units: UnitSystem, tr: Translate = str) -> dict[str, str]:
    """All pictures of a brief as SVG, by name."""
    shapes = site_shapes(site_model)
    pictures = {MAP: map_svg(shapes, plan_shapes(plan, site_model.site.origin), units)}
    height = tr("height above take-off [{0}]").format(length_unit(units).symbol)
    limits = height_limits(site_model)
    for curves in plan_profiles(plan):
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
        f"<h2>{escape(tr('Before take-off'))}</h2>",
        _checklist(_steps(brief, units, tr)),
    ]
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
    yield tr("Coverage of what can be covered"), f"{per_cent(brief.covered_share, 1.0):.1f} %"
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
    yield tr("Wind"), wind.format(speed.text(brief.wind_m_s), speed.text(brief.max_wind_m_s))


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
            str(sortie.number),
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
        LinkLoss.CONTINUE: tr("fly the mission to its end"),
        LinkLoss.GO_HOME: tr("return home straight, at the return height"),
    }
    yield tr("Without radio link"), links[brief.link_loss]
    yield tr("Battery reserve at landing"), f"{brief.battery_reserve:.0%}"
    yield tr("Highest speed"), speed_unit(units).text(brief.max_speed_m_s)
    yield tr("Hover before each photo"), f"{brief.settle_s:g} s"


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
    yield tr("Focus, exposure and white balance are fixed on the facade")
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
