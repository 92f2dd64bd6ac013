"""Ground risk of a plan by SORA 2.5, as files for an application: table, volumes for maps, and what was simulated.

`sora.md`, `sora.html` and `sora.csv` hold each number with its formula and source; `sora.kml` and `sora.geojson` the
volumes. It is a draft that the operator checks; nothing here says that a flight is allowed.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.web_mercator import world_from_geodetic
from groundstation.services.mission.brief import return_height
from missions.formats.options import ExportOptions
from missions.simulator.fly_away import FlyAways, simulate_fly_aways
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.findings import Finding, Severity
from planning.base.json_file import check_output, plain_values, write_atomically
from planning.base.messages import Message, say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from planning.insight.ground_risk import (
    GroundRisk,
    Quantity,
    assess_ground_risk,
    raster_text,
    scope_text,
    source_texts,
)
from planning.insight.ground_risk_class import ground_risk_tables
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.plan import Plan
from planning.site.file import is_planned_on
from planning.site.records import Site, SiteModel

Floats = NDArray[np.float64]

Words = Callable[[str], str]
"""Brings a message into the user's language."""

N_FLY_AWAYS = 300
"""Simulated for the table: about a second."""

STEM = "sora"
ENDINGS = (".md", ".html", ".csv", ".kml", ".geojson")


@dataclass(frozen=True, slots=True, eq=False)
class SoraDraft:
    """An assessment, the fly-aways that were simulated against it, and what the operator has to decide or check."""

    risk: GroundRisk
    fly_aways: FlyAways
    origin: Origin
    name: str
    findings: tuple[Finding, ...]


def sora_draft(
    plan: Plan,
    site_model: SiteModel,
    request: GroundRiskRequest,
    name: str,
    options: ExportOptions | None = None,
    n_fly_aways: int = N_FLY_AWAYS,
    monitor: Monitor = QUIET,
) -> SoraDraft:
    """Assess a plan on its site, and try the buffer with simulated fly-aways.

    Parameters
    ----------
    options
        Those of the export, for the height of a return.

    Raises
    ------
    InfeasibleError
        As `assess_ground_risk`.
    InputError
        As there, or the plan was made for another site.
    """
    changed = _site_findings(plan, site_model)
    site = site_model.site
    if request.terrain_raster is not None:
        site, notes = _on_raster(site_model, Path(request.terrain_raster), monitor)
        changed = (*changed, *notes)
    height_m = None
    if request.geography == "hull":
        height_m, _objections = return_height(plan, site_model, options or ExportOptions(site=site_model))
    risk = assess_ground_risk(plan, site, request, height_m)
    fly_aways = simulate_fly_aways(plan, risk, n_fly_aways, monitor=monitor)
    return SoraDraft(risk, fly_aways, site.origin, name, (*changed, *risk.findings))


RASTER_BEYOND_M = 1000.0
"""Beyond the airspace, for the terrain below the buffer."""


def _on_raster(site_model: SiteModel, path: Path, monitor: Monitor) -> tuple[Site, tuple[Finding, ...]]:
    """The site with the ground of a raster beside it, for the assessment alone: the site itself stays as it is."""
    from planning.site.importing.attach_terrain import TerrainRequest, attach_terrain

    space = site_model.site.airspace
    (x, y, z), (far_x, far_y, far_z) = space.min_enu_m, space.max_enu_m
    wide = replace(
        space,
        min_enu_m=(x - RASTER_BEYOND_M, y - RASTER_BEYOND_M, z),
        max_enu_m=(far_x + RASTER_BEYOND_M, far_y + RASTER_BEYOND_M, far_z),
    )
    model = replace(site_model, site=replace(site_model.site, airspace=wide))
    try:
        attached = attach_terrain(model, TerrainRequest((path,), use="on"), STEM, monitor)
    except InputError as error:
        raise InputError.say(
            "{}; or attach it to the site as its terrain, where what it leaves open can be stated", error
        ) from error
    notes = tuple(Finding(Severity.NOTE, "sora-terrain", text, path.name) for text in attached.notes)
    return replace(site_model.site, terrain=attached.model.site.terrain), notes


def _site_findings(plan: Plan, site_model: SiteModel) -> tuple[Finding, ...]:
    """Refuse a plan of another site, whose paths would lie elsewhere; say where its site has changed since."""
    site = site_model.site
    if plan.origin is not None and plan.origin != site.origin and plan.site == site.name:
        raise InputError.say("the site has another origin than when the plan was made; plan again on the site as it is")
    if plan.site != site.name:
        raise InputError.say(
            "the plan was made for site '{}', this is '{}'; take its own site file", plan.site, site.name
        )
    if is_planned_on(plan.site_sha256, site_model):
        return ()
    text = say("the site file has changed since this plan was made; what follows is measured on the file as it is now")
    return (Finding(Severity.WARNING, "site", text),)


def rounded_up(value_m: float) -> str:
    """Metres to a tenth, never less."""
    return f"{math.ceil(10.0 * value_m - 1e-6) / 10.0:.1f}"


def buffer_text(risk: GroundRisk) -> Message:
    """Sizes of the volumes in one line, rounded up."""
    return say(
        "flight geography up to {} m above ground, contingency volume {} m to each side and up to {} m, ground-risk "
        "buffer {} m beyond",
        rounded_up(risk.geography_top_m),
        rounded_up(risk.value_of("S_CV")),
        rounded_up(risk.contingency_top_m),
        rounded_up(risk.value_of("S_GRB")),
    )


def class_text(risk: GroundRisk) -> Message:
    """Ground risk class before and after mitigations, in one line."""
    if risk.intrinsic_class is None or risk.final_class is None:
        return say("ground risk class: not known")
    return say("ground risk class: {} intrinsic, {} final", risk.intrinsic_class, risk.final_class)


def simulated_text(fly_aways: FlyAways) -> Message:
    """What the simulation of fly-aways came to, in one line."""
    inside = sum(margin >= 0.0 for margin in fly_aways.margins_m.tolist())
    return say(
        "simulated fly-aways: {} of {} ended inside; smallest distance to the border {:.1f} m",
        inside,
        len(fly_aways.endings),
        float(fly_aways.margins_m.min()),
    )


def sora_summary(draft: SoraDraft) -> dict[str, Any]:
    """The assessment as JSON."""
    risk, flown = draft.risk, draft.fly_aways
    return {
        "quantities": [plain_values(each) for each in risk.quantities],
        "population": None if risk.band is None else risk.band.word,
        "raster": None if risk.people is None else plain_values(risk.people),
        "intrinsic_grc": risk.intrinsic_class,
        "final_grc": risk.final_class,
        "people": str(risk.people_allowed),
        "areas_m2": {name: float(area.area) for name, area, _ in volumes_of(risk)},
        "fly_aways": {
            "flown": len(flown.endings),
            "share_inside": flown.share_inside,
            "smallest_margin_m": float(flown.margins_m.min()),
            "longest_fall_m": float(flown.reach_m.max()),
        },
        "findings": [plain_values(each) for each in draft.findings],
        "not_assessed": str(scope_text()),
    }


def write_sora(draft: SoraDraft, folder: Path, words: Words = str, sources: Iterable[Path] = ()) -> tuple[Path, ...]:
    """Write all files of a draft into a folder, which is made; returns their paths.

    Raises
    ------
    InputError
        The folder cannot be made or written, or one of `sources` would be replaced.
    """
    make_folder(folder)
    sources = tuple(sources)
    contents = (
        sora_markdown(draft, words),
        sora_html(draft, words),
        sora_csv(draft, words),
        sora_kml(draft, words),
        json.dumps(sora_geojson(draft, words), indent=1, allow_nan=False),
    )
    paths = tuple(folder / f"{STEM}{ending}" for ending in ENDINGS)
    for path in paths:
        check_output(path, sources)
    for path, content in zip(paths, contents, strict=True):
        write_atomically(path, content.encode())
    return paths


# The table.


def table_titles(words: Words = str) -> tuple[str, ...]:
    """Heads of its columns."""
    return tuple(
        words(text) for text in (say("symbol"), say("what it is"), say("value"), say("formula"), say("source"))
    )


def table_rows(risk: GroundRisk, words: Words = str) -> Iterator[tuple[str, ...]]:
    """Each number with its formula and source."""
    for each in risk.quantities:
        yield each.symbol, words(each.name), value_text(each), each.formula, _source_text(each, words)
    tables, request = ground_risk_tables(), risk.request
    if risk.band is not None:
        below = "∞" if risk.band.below_per_km2 == math.inf else f"{risk.band.below_per_km2:g}"
        people = words(say("people below: {}", risk.band.word))
        is_counted = request.population is None and risk.people is not None
        source = raster_text(risk.people) if is_counted and risk.people is not None else say("stated by the pilot")
        yield "D_pop", people, f"< {below} /km²", "", words(source)
    if risk.intrinsic_class is not None and risk.final_class is not None:
        name, how = words(say("intrinsic ground risk class")), words(risk.how_intrinsic)
        yield "iGRC", name, str(risk.intrinsic_class), how, tables.source
        name, how = words(say("final ground risk class")), words(risk.how_final)
        yield "GRC", name, str(risk.final_class), how, tables.mitigation_source


def value_text(quantity: Quantity) -> str:
    """A value with its unit; small ones with more digits."""
    digits = 4 if abs(quantity.value) < 0.1 and quantity.value else 2
    return f"{quantity.value:.{digits}f} {quantity.unit}".strip()


def _source_text(quantity: Quantity, words: Words) -> str:
    source = words(quantity.source)
    return words(say("assumed: {}", source)) if quantity.is_assumed else source


def summary_lines(draft: SoraDraft, words: Words = str) -> Iterator[str]:
    """What stands above the table."""
    risk = draft.risk
    yield words(say("A filled draft: the operator checks every number before it is used. It is no permission."))
    yield words(buffer_text(risk))
    yield words(class_text(risk))
    yield words(say("uninvolved people inside: {}", risk.people_allowed))
    yield words(simulated_text(draft.fly_aways))
    yield words(scope_text())


def _title(draft: SoraDraft, words: Words) -> str:
    return words(say("Ground risk by SORA 2.5: {}", draft.name))


def sora_markdown(draft: SoraDraft, words: Words = str) -> str:
    """The table as Markdown."""

    def row(cells: Sequence[str]) -> str:
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"

    titles = table_titles(words)
    lines = [f"# {_title(draft, words)}", ""]
    for line in summary_lines(draft, words):
        lines += [line, ""]
    lines += [row(titles), row(["---"] * len(titles)), *map(row, table_rows(draft.risk, words)), ""]
    lines += [f"- {words(found.severity.value)}: {words(found.message)}" for found in draft.findings]
    lines += ["", *(f"- {words(text)}" for text in source_texts(draft.risk))]
    return "\n".join([*lines, ""])


def sora_html(draft: SoraDraft, words: Words = str) -> str:
    """The table as a page that any browser prints."""
    title = escape(_title(draft, words))
    head = "".join(f"<th>{escape(text)}</th>" for text in table_titles(words))
    body = "\n".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in table_rows(draft.risk, words)
    )
    lines = "\n".join(f"<p>{escape(line)}</p>" for line in summary_lines(draft, words))
    notes = [f"{words(found.severity.value)}: {words(found.message)}" for found in draft.findings]
    notes += [words(text) for text in source_texts(draft.risk)]
    findings = "\n".join(f"<li>{escape(note)}</li>" for note in notes)
    return _PAGE.format(title=title, head=head, body=body, lines=lines, findings=findings)


_PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>{title}</title>
<style>
body {{ font-family: sans-serif; font-size: 9pt; margin: 15mm; }}
h1 {{ font-size: 14pt; }}
table {{ border-collapse: collapse; }}
th, td {{ border: 1px solid #999999; padding: 2px 6px; text-align: left; vertical-align: top; }}
th {{ background: #e6e9ec; }}
</style></head><body>
<h1>{title}</h1>
{lines}
<table>
<tr>{head}</tr>
{body}
</table>
<ul>
{findings}
</ul>
</body></html>
"""


def sora_csv(draft: SoraDraft, words: Words = str) -> str:
    """The numbers alone, value and unit apart."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["symbol", "name", "value", "unit", "formula", "source", "assumed"])
    for each in draft.risk.quantities:
        row = each.symbol, words(each.name), f"{each.value:.6g}", each.unit, each.formula, words(each.source)
        table.writerow([*row, int(each.is_assumed)])
    risk, tables = draft.risk, ground_risk_tables()
    for symbol, number, how, source in (
        ("iGRC", risk.intrinsic_class, risk.how_intrinsic, tables.source),
        ("GRC", risk.final_class, risk.how_final, tables.mitigation_source),
    ):
        table.writerow([symbol, "", "" if number is None else number, "", words(how), source, 0])
    return out.getvalue()


# The volumes.


BUFFER, CONTINGENCY, GEOGRAPHY = say("ground-risk buffer"), say("contingency volume"), say("flight geography")


def volumes_of(risk: GroundRisk) -> Iterator[tuple[Message, Any, float | None]]:
    """Name, area and top above the ground, from the widest on; the buffer has no height of its own."""
    yield BUFFER, risk.buffer, None
    yield CONTINGENCY, risk.contingency, risk.contingency_top_m
    yield GEOGRAPHY, risk.geography, risk.geography_top_m


def area_rings(area: Any, origin: Origin, ground_z_m: float) -> Iterator[list[Floats]]:
    """Rings of each part in longitude and latitude, the outer one first and counter-clockwise, holes clockwise."""
    import shapely

    from planning.geo.enu import geodetic_from_enu

    for part in shapely.get_parts(shapely.orient_polygons(area)):
        found = []
        for ring in (part.exterior, *part.interiors):
            points = shapely.get_coordinates(ring)
            lat, lon, _ = geodetic_from_enu(origin, np.c_[points, np.full(len(points), ground_z_m)])
            found.append(np.c_[lon, lat])
        yield found


def volume_shapes(draft: SoraDraft) -> list[tuple[str, tuple[Floats, ...]]]:
    """Colour and rings of each volume for a map, in its world coordinates, the widest first."""
    found = []
    for name, area, _top in volumes_of(draft.risk):
        parts = area_rings(area, draft.origin, draft.risk.ground_z_m)
        rings = tuple(world_from_geodetic(ring[:, 1], ring[:, 0]) for part in parts for ring in part)
        found.append((COLOURS[name], rings))
    return found


def sora_geojson(draft: SoraDraft, words: Words = str) -> dict[str, Any]:
    """The volumes as GeoJSON (RFC 7946): areas on WGS 84, heights above the ground as properties."""
    risk = draft.risk
    features = []
    for name, area, top_m in volumes_of(risk):
        parts = area_rings(area, draft.origin, risk.ground_z_m)
        rings = [[np.round(ring, 9).tolist() for ring in part] for part in parts]
        properties: dict[str, Any] = {"name": words(name), "kind": str(name)}
        if top_m is not None:
            properties["top_above_ground_m"] = round(top_m, 2)
        geometry = {"type": "MultiPolygon", "coordinates": rings}
        features.append({"type": "Feature", "properties": properties, "geometry": geometry})
    return {"type": "FeatureCollection", "features": features}


COLOURS = {GEOGRAPHY: "#00a650", CONTINGENCY: "#ffc800", BUFFER: "#e02020"}
"""Green, yellow and red, as authorities draw them."""


def sora_kml(draft: SoraDraft, words: Words = str) -> str:
    """The volumes as KML: as high as they are above the ground, the buffer on it."""
    risk = draft.risk
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<kml xmlns="http://www.opengis.net/kml/2.2">',
        " <Document>",
        f"  <name>{escape(_title(draft, words), quote=False)}</name>",
    ]
    for name, colour in COLOURS.items():
        # KML has alpha, blue, green, red.
        bgr = colour[5:7] + colour[3:5] + colour[1:3]
        line, fill = f"<color>ff{bgr}</color><width>2</width>", f"<color>40{bgr}</color>"
        style = f"<LineStyle>{line}</LineStyle><PolyStyle>{fill}</PolyStyle>"
        lines.append(f'  <Style id="{_style(name)}">{style}</Style>')
    for name, area, top_m in volumes_of(risk):
        mode = "clampToGround" if top_m is None else "relativeToGround"
        title = escape(words(name), quote=False)
        lines += ["  <Placemark>", f"   <name>{title}</name><styleUrl>#{_style(name)}</styleUrl>", "   <MultiGeometry>"]
        for part in area_rings(area, draft.origin, risk.ground_z_m):
            tops_m = [_tops_m(draft, ring, top_m) for ring in part]
            rings = "".join(
                _kml_ring(ring, n == 0, top) for n, (ring, top) in enumerate(zip(part, tops_m, strict=True))
            )
            extrude = f"<extrude>{int(top_m is not None)}</extrude><altitudeMode>{mode}</altitudeMode>"
            lines.append(f"    <Polygon>{extrude}{rings}</Polygon>")
        lines += ["   </MultiGeometry>", "  </Placemark>"]
    return "\n".join([*lines, " </Document>", "</kml>", ""])


def _style(name: str) -> str:
    return name.replace(" ", "-")


def _tops_m(draft: SoraDraft, ring: Floats, top_m: float | None) -> Floats:
    """Heights of a volume's level top above the ground below each corner of a ring."""
    from planning.geo.enu import enu_from_geodetic

    if top_m is None:
        return np.zeros(len(ring))
    risk, height_m = draft.risk, draft.origin.ellipsoid_height_m
    if risk.ground.terrain is None:
        return np.full(len(ring), top_m)
    places = enu_from_geodetic(draft.origin, ring[:, 1], ring[:, 0], np.full(len(ring), height_m))
    ground_m = risk.ground.heights_m(np.asarray(places))
    above_m = np.maximum(risk.ground_z_m + top_m - ground_m, 0.0)
    return np.where(np.isfinite(ground_m), above_m, top_m)


def _kml_ring(ring: Floats, is_outer: bool, tops_m: Floats) -> str:
    kind = "outerBoundaryIs" if is_outer else "innerBoundaryIs"
    places = zip(ring.tolist(), tops_m.tolist(), strict=True)
    points = " ".join(f"{lon:.9f},{lat:.9f},{top_m:.2f}" for (lon, lat), top_m in places)
    return f"<{kind}><LinearRing><coordinates>{points}</coordinates></LinearRing></{kind}>"
