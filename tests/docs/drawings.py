"""The drawings of docs/drawings as SVG."""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

INK, PALE, BLUE, GREEN, ORANGE, RED = "#1f2933", "#eef2f6", "#2f6fb0", "#2e8b57", "#d9822b", "#b3372f"
STEP_DEG = 30


@dataclass(slots=True)
class Drawing:
    """Shapes of one picture, in pixels with y down.

    Parameters
    ----------
    width_px, height_px
        Size.
    title
        Read aloud in its place.
    """

    width_px: int
    height_px: int
    title: str
    shapes: list[str] = field(default_factory=list)

    def box(self, x: float, y: float, w: float, h: float, text: str, fill: str = PALE, edge: str = INK) -> None:
        """Rectangle with lines of text in its middle; the first one is bold."""
        self.shapes.append(
            f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" rx="6" fill="{fill}" stroke="{edge}"/>'
        )
        lines = text.split("\n")
        for index, line in enumerate(lines):
            at = y + h / 2 + 5 + (index - (len(lines) - 1) / 2) * 17
            self.text(x + w / 2, at, line, "middle", is_bold=index == 0, size=14 if index == 0 else 12)

    def text(
        self, x: float, y: float, text: str, anchor: str = "start", *, is_bold: bool = False, size: int = 13,
        colour: str = INK,
    ) -> None:  # fmt: skip
        """One line of text."""
        weight = ' font-weight="bold"' if is_bold else ""
        self.shapes.append(
            f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" font-size="{size}" fill="{colour}"{weight}>'
            f"{escape(text)}</text>"
        )

    def arrow(self, points: Sequence[tuple[float, float]], colour: str = INK, *, is_dashed: bool = False) -> None:
        """Polyline with a head at its end."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        dashes = ' stroke-dasharray="5 4"' if is_dashed else ""
        (x0, y0), (x1, y1) = points[-2], points[-1]
        angle = math.atan2(y1 - y0, x1 - x0)
        wings = [(x1 - 10 * math.cos(angle + turn), y1 - 10 * math.sin(angle + turn)) for turn in (0.4, -0.4)]
        head = " ".join(f"{x:.1f},{y:.1f}" for x, y in [wings[0], (x1, y1), wings[1]])
        self.shapes.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"{dashes}/>')
        self.shapes.append(f'<polygon points="{head}" fill="{colour}"/>')

    def polygon(self, points: NDArray[np.float64], fill: str, edge: str = INK, opacity: float = 1.0) -> None:
        """Filled outline, points of shape (n, 2)."""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.shapes.append(
            f'<polygon points="{path}" fill="{fill}" stroke="{edge}" stroke-width="0.9" fill-opacity="{opacity:g}"/>'
        )

    def svg(self) -> str:
        """Text of the file."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width_px} {self.height_px}" '
            f'width="{self.width_px}" height="{self.height_px}" font-family="sans-serif" role="img">\n'
            "<!-- Made by tests/docs/drawings.py; do not edit by hand. -->\n"
            f"<title>{escape(self.title)}</title>\n"
            f'<rect width="{self.width_px}" height="{self.height_px}" fill="#ffffff"/>\n'
        )
        return head + "\n".join(self.shapes) + "\n</svg>\n"


def drawings(pyproject: Path) -> dict[str, str]:
    """Text of each drawing by the name of its file."""
    return {
        "data-flow.svg": data_flow(),
        "hemisphere-sections.svg": hemisphere_sections(),
        "house.svg": house(pyproject),
        "flight-phases.svg": flight_phases(),
        "proof.svg": proof(),
        "worth.svg": worth(),
    }


def data_flow() -> str:
    """From the building model and the first photos to the model with its records."""
    drawing = Drawing(940, 470, "Data flow from the first photos to the model with its records")
    rows = [(40, "before the second flight"), (190, "the second flight"), (340, "after it")]
    for y, text in rows:
        drawing.text(20, y - 12, text, is_bold=True, colour=BLUE)
    first = [
        "Building model\nIFC, CityGML, mesh",
        "Site\nsite.json",
        "Plan\nplan.json, bound",
        "Checks\nverdict, brief",
    ]
    second = [
        "Mission files\nKMZ, .plan, ...",
        "Flight\nreal or simulated",
        "Report\nflight.json",
        "Top-up\na shorter plan",
    ]
    third = [
        "Photos\npose, quality",
        "Data set\npanels drawn in",
        "Model\nsplats and light",
        "Objects\nrecords, exports",
    ]
    colours = ["#e7f0fa", "#fdf0e2", "#e6f4ec"]
    for (y, _), texts, fill in zip(rows, (first, second, third), colours, strict=True):
        for column, text in enumerate(texts):
            drawing.box(20 + column * 235, y, 175, 70, text, fill)
    for y, _ in rows:
        for column in range(3):
            x = 20 + column * 235 + 175
            drawing.arrow([(x, y + 35), (x + 58, y + 35)])
    # The plan is exported; what the top-up plans is exported, too; photos come from the flight.
    drawing.arrow([(577, 110), (577, 148), (165, 148), (165, 188)], BLUE)
    drawing.text(330, 143, "export", colour=BLUE, size=12)
    drawing.arrow([(812, 260), (812, 290), (130, 290), (130, 262)], ORANGE, is_dashed=True)
    drawing.text(590, 285, "fly what is missing", colour=ORANGE, size=12)
    drawing.arrow([(300, 260), (300, 312), (107, 312), (107, 338)], BLUE)
    drawing.text(180, 307, "card", colour=BLUE, size=12)
    # Panels are found in photos of the first flight, and go back into the site.
    drawing.arrow([(60, 410), (60, 450), (925, 450), (925, 20), (330, 20), (330, 38)], GREEN, is_dashed=True)
    drawing.text(
        480, 444, "panels found in the first flight's photos become the site's", "middle", colour=GREEN, size=12
    )
    return drawing.svg()


def hemisphere_sections() -> str:
    """A panel, the hemisphere before it in sections, and a viewpoint in one of them."""
    drawing = Drawing(760, 470, "The hemisphere of a panel, cut into 36 sections, and a viewpoint that covers one")
    centre, radius_px = np.array([270.0, 330.0]), 205.0
    right, up, view = _camera(35.0, 28.0)

    def project(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return centre + radius_px * np.stack([points @ right, -(points @ up)], axis=-1)

    seen = (1, 11)  # ring and sector of the viewpoint
    cells = []
    for ring in range(90 // STEP_DEG):
        for sector in range(360 // STEP_DEG):
            outline = _section(ring, sector)
            cells.append((float((outline @ view).mean()), ring, sector, outline))
    for _, ring, sector, outline in sorted(cells, key=lambda cell: cell[0]):
        fill = ORANGE if (ring, sector) == seen else "#cfe0f2"
        drawing.polygon(project(outline), fill, BLUE, 0.75 if (ring, sector) == seen else 0.35)
    panel = np.array([[-0.3, -0.22, 0], [0.3, -0.22, 0], [0.3, 0.22, 0], [-0.3, 0.22, 0]], dtype=np.float64)
    drawing.polygon(project(panel), "#9fb8c8", INK, 0.95)
    theta, phi = math.radians((seen[0] + 0.5) * STEP_DEG), math.radians((seen[1] + 0.5) * STEP_DEG)
    toward = np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])
    start, camera = project(np.zeros(3)), project(1.75 * toward)
    drawing.arrow([(camera[0], camera[1]), (start[0], start[1])], ORANGE)
    drawing.box(camera[0] - 42, camera[1] - 34, 84, 28, "viewpoint", "#fdf0e2", ORANGE)
    tip = project(np.array([0.0, 0.0, 1.25]))
    drawing.arrow([(start[0], start[1]), (tip[0], tip[1])], GREEN)
    drawing.text(tip[0] + 8, tip[1] + 4, "normal n", colour=GREEN)
    tip = project(np.array([1.2, 0.0, 0.0]))
    drawing.arrow([(start[0], start[1]), (tip[0], tip[1])], RED)
    drawing.text(tip[0] - 6, tip[1] + 20, "t, where phi is 0", colour=RED)
    for index, line in enumerate([
        "theta: from the normal, 0 to 90 deg",
        "phi: around it, 0 to 360 deg",
        "step 30 deg: 3 rings of 12",
        "= 36 sections",
        "",
        "A viewpoint covers a section when",
        "the camera stands in it and the",
        "panel's centroid is in the picture.",
    ]):  # fmt: skip
        drawing.text(545, 120 + 24 * index, line)
    return drawing.svg()


def _camera(turn_deg: float, height_deg: float) -> tuple[NDArray[np.float64], ...]:
    """Right, up and towards the onlooker, for a panel that lies level with its normal up."""
    turn, height = math.radians(turn_deg), math.radians(height_deg)
    view = np.array([math.sin(turn) * math.cos(height), -math.cos(turn) * math.cos(height), math.sin(height)])
    right = np.array([math.cos(turn), math.sin(turn), 0.0])
    return right, np.cross(view, right), view


def _section(ring: int, sector: int) -> NDArray[np.float64]:
    """Outline of a section on the unit sphere, shape (n, 3)."""
    thetas = np.radians(STEP_DEG * (ring + np.linspace(0, 1, 7)))
    phis = np.radians(STEP_DEG * (sector + np.linspace(0, 1, 7)))
    edge = [(thetas[0], phi) for phi in phis] + [(theta, phis[-1]) for theta in thetas]
    edge += [(thetas[-1], phi) for phi in phis[::-1]] + [(theta, phis[0]) for theta in thetas[::-1]]
    return np.array([[math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)] for a, b in edge])


HOUSES = {
    "groundstation.gui": "the window",
    "groundstation.api": "for other programs",
    "groundstation.cli": "the command line",
    "groundstation.services": "use cases without Qt: a room for each task",
    "groundstation.vehicle": "one vehicle on a link: telemetry, setup, list before take-off, sortie",
    "missions": "what an aircraft is told: files, MAVLink, simulator, flight records",
    "reconstruction": "photos to panels, data set, model, objects, exports",
    "planning": "the ground floor: base, geo, site, coverage, viewpoints, routing, checks",
}


def house(pyproject: Path) -> str:
    """The floors of the import contracts, from the top: what lies higher may import what lies lower."""
    contracts = tomllib.loads(pyproject.read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    layers = next(each for each in contracts if each["name"] == "Imports point one way")["layers"]
    floors = [layer for layer in layers if "__main__" not in layer]
    rooms = {each["containers"][0]: each["layers"] for each in contracts if each.get("containers")}
    drawing = Drawing(900, 130 + sum(_height(floor, rooms) + 16 for floor in floors), "The house with its floors")
    drawing.polygon(np.array([[450, 12], [880, 84], [20, 84]], dtype=np.float64), "#f3e3d3", INK)
    drawing.text(450, 66, "app.py: command line, or without a command the window", "middle", is_bold=True)
    y = 96.0
    for floor in floors:
        names = [name.strip() for name in floor.split("|")]
        width, height = (860 - 14 * (len(names) - 1)) / len(names), _height(floor, rooms)
        for index, name in enumerate(names):
            _storey(drawing, (20 + index * (width + 14), y, width, height), name, rooms)
        y += height + 16
    drawing.text(450, y + 14, "Imports go down only, between the floors and between the rows of rooms.", "middle")
    return drawing.svg()


def _rows(name: str, rooms: Mapping[str, Sequence[str]]) -> list[str]:
    return [" · ".join(room.strip(" ()") for room in layer.split("|")) for layer in rooms.get(name, [])]


def _height(floor: str, rooms: Mapping[str, Sequence[str]]) -> float:
    return 52 + 16 * max(len(_rows(name.strip(), rooms)) for name in floor.split("|"))


def _storey(
    drawing: Drawing, place: tuple[float, float, float, float], name: str, rooms: Mapping[str, Sequence[str]]
) -> None:
    x, y, width, height = place
    fill = {"groundstation": "#e7f0fa", "missions": "#fdf0e2", "reconstruction": "#e6f4ec"}.get(
        name.split(".", 1)[0], "#f0ecf7"
    )
    drawing.shapes.append(
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" fill="{fill}" stroke="{INK}"/>'
    )
    drawing.text(x + 12, y + 22, name, is_bold=True, size=15)
    drawing.text(x + 12, y + 42, HOUSES.get(name, ""), size=12)
    for index, row in enumerate(_rows(name, rooms)):
        drawing.text(x + 24, y + 61 + 16 * index, row, size=12, colour=BLUE)


PHASES = (
    ("connecting", "a vehicle is heard", "silence"),
    ("preparing", "its parameters are read", "one-way link"),
    ("uploading", "read back, equal", "refused, not equal"),
    ("checking", "nothing is missing", "not well in 3 min"),
    ("ready", "the pilot says Start", ""),
    ("starting", "armed, in mission mode", "refused, other mission"),
    ("flying", "landed and disarmed", "no take-off, silence"),
)


def flight_phases() -> str:
    """Phases of a sortie, what leads on from each, and what may end it."""
    drawing = Drawing(940, 300, "Phases of a sortie")
    places = [(20 + 232 * column, 30) for column in range(4)] + [(716 - 232 * column, 170) for column in range(3)]
    for (x, y), (name, leads_on, fails) in zip(places, PHASES, strict=True):
        drawing.box(x, y, 140, 44, name, "#e7f0fa")
        drawing.text(x + 70, y + 62, leads_on, "middle", size=12, colour=GREEN)
        drawing.text(x + 70, y + 79, fails, "middle", size=12, colour=RED)
    for (x0, y0), (x1, y1) in itertools.pairwise(places):
        if y0 != y1:
            drawing.arrow([(x0 + 140, y0 + 22), (x0 + 185, y0 + 22), (x0 + 185, y1 + 22), (x1 + 142, y1 + 22)])
        elif x1 > x0:
            drawing.arrow([(x0 + 140, y0 + 22), (x1 - 2, y1 + 22)])
        else:
            drawing.arrow([(x0, y0 + 22), (x1 + 142, y1 + 22)])
    drawing.arrow([(716, 178), (690, 178), (690, 66), (714, 60)], ORANGE, is_dashed=True)
    drawing.text(684, 140, "no longer well", "end", size=12, colour=ORANGE)
    drawing.box(20, 170, 140, 44, "landed\nreport, top-up", "#e6f4ec")
    drawing.arrow([(252, 192), (162, 192)])
    drawing.text(20, 285, "green: what leads on", size=12, colour=GREEN)
    drawing.text(170, 285, "red: what may end it", size=12, colour=RED)
    return drawing.svg()


def proof() -> str:
    """A flight before a building from the side: what is proved of it in green, what is not in red."""
    drawing = Drawing(940, 440, "What is proved of a flight before a building, and what is not")
    ground = [(0, 385), (200, 380), (330, 392), (480, 380), (560, 370), (940, 370), (940, 440), (0, 440)]
    drawing.polygon(np.array(ground, np.float64), "#e9e4d8")
    drawing.polygon(np.array([(640, 130), (800, 130), (800, 370), (640, 370)], np.float64), PALE)
    for y in (140, 216, 292):
        drawing.polygon(np.array([(632, y), (640, y), (640, y + 66), (632, y + 66)], np.float64), "#9fb8c8")
    # Boxes behind the building, from which its panels cannot be seen.
    for x, y, w, h in (
        (806, 130, 60, 80),
        (866, 130, 60, 80),
        (806, 210, 60, 80),
        (866, 210, 30, 40),
        (896, 210, 30, 40),
    ):
        box = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
        drawing.polygon(np.array(box, np.float64), BLUE, BLUE, 0.12)
    drawing.text(806, 100, "boxes: nothing", colour=GREEN, size=12)
    drawing.text(806, 116, "is seen from here", colour=GREEN, size=12)
    drawing.polygon(np.array([(225, 250), (305, 250), (305, 383), (225, 383)], np.float64), RED, RED, 0.12)
    drawing.text(265, 243, "no-fly volume: not entered", "middle", colour=GREEN, size=12)
    # The flight: column, legs, views, and the return from anywhere.
    drawing.arrow([(110, 380), (110, 200), (520, 160)], BLUE)
    drawing.arrow([(520, 160), (520, 330)], BLUE)
    drawing.arrow([(520, 330), (400, 215), (114, 232)], BLUE)
    drawing.arrow([(520, 300), (505, 290), (505, 90), (96, 90), (96, 376)], GREEN, is_dashed=True)
    drawing.text(120, 82, "return: up, level home, down; the battery keeps its reserve", colour=GREEN, size=12)
    drawing.text(30, 400, "straight above home", colour=GREEN, size=12)
    for y in (170, 320):
        drawing.arrow([(520, y), (628, y)], ORANGE)
    drawing.text(528, 162, "a view covers", colour=GREEN, size=12)
    drawing.text(528, 338, "a section", colour=GREEN, size=12)
    drawing.shapes.append(f'<line x1="595" y1="30" x2="595" y2="368" stroke="{GREEN}" stroke-dasharray="9 4"/>')
    drawing.text(640, 22, "a plane between leg and building:", "end", colour=GREEN, size=12)
    drawing.text(590, 40, "the leg keeps its distance", "end", colour=GREEN, size=12)
    drawing.arrow([(420, 234), (420, 384)], GREEN)
    drawing.text(428, 364, "height above ground", colour=GREEN, size=12)
    # What the files cannot tell.
    for y in (140, 152, 164):
        drawing.arrow([(20, y), (80, y)], RED)
    drawing.text(20, 130, "wind", colour=RED, size=12)
    drawing.shapes.append(f'<circle cx="520" cy="205" r="17" fill="none" stroke="{RED}" stroke-dasharray="3 3"/>')
    drawing.text(497, 193, "where GNSS has it", "end", colour=RED, size=12)
    drawing.shapes.append(
        f'<path d="M735 130 V40 H660" fill="none" stroke="{RED}" stroke-width="2" stroke-dasharray="4 4"/>'
    )
    drawing.text(742, 52, "a crane that the site lacks", colour=RED, size=12)
    drawing.text(250, 212, "corners cut by the autopilot", "middle", colour=RED, size=12)
    drawing.text(30, 428, "green: proved on the files", colour=GREEN, size=12)
    drawing.text(230, 428, "red: not proved", colour=RED, size=12)
    return drawing.svg()


CAMERAS_M = {"A": ((-13.0, 9.0), -9.0), "B": ((7.0, 9.0), 1.0), "C": ((15.0, 9.0), 8.6), "D": ((-4.5, 9.0), -1.5)}
"""Places of cameras before a facade, and where on it each looks: metres along the facade and before it."""

CELL_M, HOUSE_M = 8.0, 22.0
"""Side of a cell of the surroundings, and how far before the facade the house across the street stands."""


def worth() -> str:
    """A street from above: which cells of the house opposite photos show mirrored, and which of them tells most."""
    drawing = Drawing(760, 500, "A facade and the house opposite from above: what further photos show of it")
    scale, across_px, facade_px = 14.0, 380.0, 90.0

    def place(x_m: float, y_m: float) -> tuple[float, float]:
        return across_px + scale * x_m, facade_px + scale * y_m

    seen: dict[int, list[str]] = {}
    for name, ((x_m, y_m), at_m) in CAMERAS_M.items():
        met_m = at_m + (at_m - x_m) * HOUSE_M / y_m  # the angle of reflection is that of incidence
        seen.setdefault(math.floor(met_m / CELL_M), []).append(name)
        colour = ORANGE if name == "D" else BLUE
        drawing.arrow([place(x_m, y_m), place(at_m, 0.0), place(met_m, HOUSE_M)], colour)
        drawing.arrow([place(at_m, 0.0), place(at_m + (at_m - x_m) * 3.6 / y_m, -3.6)], GREEN, is_dashed=True)
        x, y = place(x_m, y_m)
        drawing.shapes.append(f'<circle cx="{x:g}" cy="{y:g}" r="6" fill="{colour}"/>')
        drawing.text(x - 20, y + 5, name, is_bold=True, colour=colour)
    for number in range(-3, 3):
        corners = [(number, 0), (number + 1, 0), (number + 1, 1), (number, 1)]
        box = np.array([place(CELL_M * x, HOUSE_M + 0.5 * CELL_M * y) for x, y in corners])
        names = seen.get(number, [])
        fill = {0: RED, 1: ORANGE}.get(len(names), GREEN)
        drawing.polygon(box, fill, INK, 0.25)
        x, y = box.mean(axis=0)
        drawing.text(x, y + 5, ", ".join(names) or "unknown", "middle", size=12)
    for number in range(-6, 6):
        (x, y), (further, _) = place(4.0 * number + 0.15, 0.0), place(4.0 * number + 3.85, 0.0)
        drawing.shapes.append(f'<rect x="{x:g}" y="{y - 3:g}" width="{further - x:g}" height="6" fill="{INK}"/>')
    drawing.text(20, 30, "rooms: what shows through a pane, by pane and direction", colour=GREEN, is_bold=True)
    drawing.text(480, 310, "D: new to its pane, but shows what A does:", colour=ORANGE, size=12)
    drawing.text(480, 327, "a section more, and little learned", colour=ORANGE, size=12)
    drawing.text(20, 485, "cells of the house opposite:", is_bold=True)
    drawing.text(225, 485, "seen by several photos: known", colour=GREEN)
    drawing.text(435, 485, "by one", colour=ORANGE)
    drawing.text(500, 485, "by none: a photo tells most there", colour=RED)
    drawing.text(20, 120, "panes", size=12)
    return drawing.svg()
