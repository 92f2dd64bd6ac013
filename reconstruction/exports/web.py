"""A model as a web page: a folder with one `index.html` that any browser shows without network or other files.

All is in that one file, because a page that is opened from a disk may not read others, and tablets hand a browser just
the file that was touched. Gaussians follow the page in chunks, the most visible ones first: the first picture is there
before all is read. Models that are too large for that have a coarse model in the page, and parts beside it
(`page_parts`). These are scripts, which a page may load from the disk as well as by http; it keeps so many of them as
there is room for, those that are seen largest.

What users wrote is data: JSON whose characters cannot end a script, shown as text only; the page's policy forbids all
network, all other scripts, and markup made of text.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder, open_input_file
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.compression import whole_file
from reconstruction.exports.gaussian_blocks import raster_of
from reconstruction.exports.page_parts import PART, GlassValues, TwoLevels, two_levels
from reconstruction.exports.page_records import Row, by_object, columns_of, files_of
from reconstruction.gpu.shaders import shader
from reconstruction.objects.gs_scene import GsElement, GsScene
from reconstruction.objects.store import largest, middle_of, outward, usual_look
from reconstruction.splats.harmonic_colour import light_of_display
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.training.model.pane_mirrors import PaneMirrors

# Gaussians as a web page has them: 32 bytes each and a byte per coefficient of direction, the most visible ones
# first.
#
# Little-endian words of 32 bits, as `shaders.js` reads them:
#
# | word | holds |
# | --- | --- |
# | 0 to 2 | mean, float32, metres, ENU less the scene's `origin_enu_m` |
# | 3, 4 | quaternion w, x, y, z, half floats |
# | 5, 6 | three sizes in metres, half floats; then the pane's number + 1 on 16 bits, 0 for none |
# | 7 | red, green, blue of all directions, and opacity, 8 bits each |
#
# Coefficients of higher degrees follow a chunk's words: signed bytes, by Gaussian, coefficient and channel.
#
# Where panes mirror, own values of those on panes stand beside: two words, the colour of all directions and R, and F0,
# 8 bits each, and coefficients as above.

Words = NDArray[np.uint32]

N_AT_ONCE = 8_192
"""Gaussians of a chunk: 8 rows of the page's texture, 0.6 MB of text, and up to 0.4 MB more of those on panes. With the
first chunk the first picture is there."""

MOST_EMBEDDED = 1_000_000
"""Gaussians of a page that is one file: 75 MB with harmonics of degree 2, and mirrors."""

RESIDENT = 1 << 21
"""Gaussians of parts that a page keeps at most: 230 MB of graphics memory."""

MAX_GAUSSIANS = 32_000_000
"""2 GB of files."""

MAX_PANES = 65_535

N_WORDS = 8

COLOUR_RANGE = (-0.25, 1.25)
"""Of the colour of all directions, display values: others are added to it, so it may lie a little outside 0 to 1."""

FLAT = 0.28209479177387814
"""The harmonic of degree 0."""

LARGEST_HALF = 65_504.0

FAINTEST = 1.0 / 255.0
"""Opacity below which nothing is drawn, as in 3-D Gaussian splatting."""


@dataclass(frozen=True, slots=True, eq=False)
class PackedGaussians:
    """What the page gets, the most visible first.

    Parameters
    ----------
    words
        Shape (n, 8), uint32.
    rest
        Coefficients from degree 1 on, shape (n, (degree + 1)^2 - 1, 3), int8.
    rest_steps
        What 1 stands for in each coefficient, shape ((degree + 1)^2 - 1,).
    rows
        Which of the given ones each is, shape (n,).
    """

    words: Words
    rest: NDArray[np.int8]
    rest_steps: NDArray[np.float32]
    rows: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.words)

    def chunks(self) -> Iterator[bytes]:
        """Words of up to `N_AT_ONCE` Gaussians, then their coefficients."""
        for start in range(0, len(self), N_AT_ONCE):
            part = slice(start, start + N_AT_ONCE)
            yield self.words[part].astype("<u4").tobytes() + self.rest[part].tobytes()

    @property
    def is_on_pane(self) -> NDArray[np.bool_]:
        """Shape (n,)."""
        return self.words[:, 6] >> 16 > 0


@dataclass(frozen=True, slots=True, eq=False)
class PackedGlass:
    """What Gaussians on panes are made of, in the order of the packed ones.

    Parameters
    ----------
    words
        Shape (n, 2), uint32.
    rest, rest_steps
        As of `PackedGaussians`.
    is_on_pane
        Which of the packed Gaussians these are.
    """

    words: Words
    rest: NDArray[np.int8]
    rest_steps: NDArray[np.float32]
    is_on_pane: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.words)

    def chunks(self) -> Iterator[bytes]:
        """Words of those of each chunk of Gaussians, then their coefficients."""
        ends = np.concatenate([[0], np.cumsum(self.is_on_pane)])
        for start in range(0, len(self.is_on_pane), N_AT_ONCE):
            part = slice(ends[start], ends[min(start + N_AT_ONCE, len(self.is_on_pane))])
            yield self.words[part].astype("<u4").tobytes() + self.rest[part].tobytes()


def packed(
    gaussians: Ellipsoids,
    panes: NDArray[np.int32],
    degree: int,
    most: int | None = None,
    steps: NDArray[np.float32] | None = None,
) -> PackedGaussians:
    """Gaussians for a page; those too faint to be drawn are left out.

    Parameters
    ----------
    panes
        Number of the page's pane that each lies on, -1 for none, shape (n,).
    degree
        Of the harmonics kept, 0 to 3.
    most
        So many of the most visible are kept; None: all.
    steps
        Of coefficients; None: such as suit these.
    """
    seen = np.flatnonzero(gaussians.opacities >= FAINTEST)
    order = seen[np.argsort(-_visibilities(gaussians)[seen], kind="stable")][:most]
    chosen = gaussians.chosen(order)
    words = np.empty((len(chosen), N_WORDS), np.uint32)
    words[:, 0:3] = np.ascontiguousarray(chosen.means_m, np.float32).view(np.uint32)
    halves = np.zeros((len(chosen), 4, 2), np.uint16)
    halves[:, 0:2] = chosen.quats.astype(np.float16).view(np.uint16).reshape(-1, 2, 2)
    sizes = np.minimum(chosen.scales_m, np.float32(LARGEST_HALF)).astype(np.float16).view(np.uint16)
    halves[:, 2] = sizes[:, :2]
    halves[:, 3, 0] = sizes[:, 2]
    halves[:, 3, 1] = panes[order] + 1
    words[:, 3:7] = halves[..., 0] | halves[..., 1].astype(np.uint32) << 16
    words[:, 7] = _bytes(_flat_shares(chosen.sh), chosen.opacities)
    rest, steps = _rest(chosen.sh[:, 1 : (degree + 1) ** 2], steps)
    return PackedGaussians(words, rest, steps, order)


def packed_glass(
    glass: GlassValues, chunks: PackedGaussians, degree: int, steps: NDArray[np.float32] | None = None
) -> PackedGlass:
    """Own values of Gaussians on panes.

    Parameters
    ----------
    glass
        Of each Gaussian that `packed` was given.
    steps
        Of coefficients; None: such as suit these.
    """
    is_on_pane = chunks.is_on_pane
    own = glass.chosen(chunks.rows[is_on_pane])
    more = _bytes(own.f0, np.zeros(len(own.f0)))
    words = np.column_stack([_bytes(_flat_shares(own.sh), own.reflectivity), more])
    return PackedGlass(words, *_rest(own.sh[:, 1 : (degree + 1) ** 2], steps), is_on_pane)


def glass_of(mirrors: PaneMirrors, places: NDArray[np.int32], degree: int) -> GlassValues:
    """Of Gaussians by their rows in the model, with harmonics of a degree."""
    return GlassValues(mirrors.sh[places, : (degree + 1) ** 2], mirrors.reflectivity[places], mirrors.f0[places])


def _visibilities(gaussians: Ellipsoids) -> NDArray[np.float32]:
    """About how much of a picture each covers: opacity times the two larger sizes."""
    sizes = np.sort(gaussians.scales_m, axis=1)
    return np.asarray(gaussians.opacities * sizes[:, 1] * sizes[:, 2], np.float32)


def _flat_shares(sh: NDArray[np.float32]) -> NDArray[np.float32]:
    """Colours of all directions, 0 to 1 of `COLOUR_RANGE`."""
    low, high = COLOUR_RANGE
    return np.asarray((0.5 + np.float32(FLAT) * sh[:, 0] - low) / (high - low), np.float32)


def _bytes(three: NDArray[Any], one: NDArray[Any]) -> Words:
    """Words of four numbers 0 to 1, shapes (n, 3) and (n,), 8 bits each."""
    values = np.column_stack([three, one])
    bytes_ = np.rint(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint32)
    return np.asarray((bytes_ << np.array([0, 8, 16, 24], np.uint32)).sum(axis=1, dtype=np.uint32))


def _steps(coefficients: NDArray[np.float32]) -> NDArray[np.float32]:
    """Of bytes of coefficients: the outermost 0.1 % are cut, or a few stray ones would coarsen all."""
    if not len(coefficients) or not coefficients.shape[1]:
        return np.zeros(coefficients.shape[1], np.float32)
    largest = np.quantile(np.abs(coefficients), 0.999, axis=(0, 2), method="higher")
    return np.maximum(largest / 127.0, 1e-12).astype(np.float32)


def _rest(
    coefficients: NDArray[np.float32], steps: NDArray[np.float32] | None = None
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Bytes of coefficients, and their steps."""
    steps = _steps(coefficients) if steps is None else steps
    if not len(coefficients) or not coefficients.shape[1]:
        return np.zeros(coefficients.shape, np.int8), steps
    return np.clip(np.rint(coefficients / steps[:, None]), -127.0, 127.0).astype(np.int8), steps


# What a web page is told about a scene besides its Gaussians: panes, facades, and where to look at first.

Array = NDArray[np.float64]

HALF_FIELD = 0.46
"""Tangent of half the page's field of view, with some room."""

STEEPEST = 1.55
"""Pitch of the page's camera at most, radians."""

AHEAD_RAD = 0.2
"""Off the middle of a photo, what stands there still counts as what it was taken of."""

CLEAR_M = 1.0
"""Before a facade: frames and sunshades stand out that far, and are looked at, too."""

STEP, N_TRIED = 0.85, 9
"""Distances that are tried, each as a share of the one before: down to a quarter of what shows all of a facade."""

MOST_HIDDEN = 0.05
"""Share of the facade that may be hidden more than from the best of these distances."""

SIGHT_PX = 64, 48
"""Of the picture by which that is measured."""


def panes_of(gaussians: Ellipsoids, elements: Sequence[GsElement]) -> NDArray[np.int32]:
    """Place among `elements` of the panel that each lies on, -1 for none."""
    pane_of = np.full(max((element.panel for element in elements), default=-1) + 2, -1, np.int32)
    for pane, element in enumerate(elements):
        pane_of[element.panel] = pane
    return pane_of[gaussians.panels]  # -1 takes the last, which is none


def described_panes(scene: GsScene, elements: Sequence[GsElement]) -> dict[str, Any]:
    """Facades, and panes with their corners in metres, ENU less the scene's `origin_enu_m`.

    Raises
    ------
    InputError
        A corner is not finite.
    """
    facades = [component for component in scene.components if component.kind == "facade"]
    of_element = [number for number, facade in enumerate(facades) for _ in facade.elements]
    origin = np.asarray(scene.origin_enu_m, np.float64)
    corners = [np.asarray(element.corners_enu_m, np.float64) - origin for element in elements]
    if not all(np.isfinite(each).all() for each in corners):
        raise InputError(say("corners of a panel hold numbers that are not finite"))
    return {
        "facades": [{"id": facade.global_id, "name": facade.name} for facade in facades],
        "parts": [{"id": part.global_id, "name": part.name} for part in scene.components if part not in facades],
        "panes": [
            {
                "id": element.global_id,
                "name": element.name,
                "facade": facade,
                "corners": [round(float(value), 5) for value in places.ravel()],
                "is_bare": element.n_gaussians == 0,
            }
            for element, facade, places in zip(elements, of_element, corners, strict=True)
        ],
    }


def first_view(scene: GsScene, elements: Sequence[GsElement], gaussians: Ellipsoids) -> dict[str, Any]:
    """Where to look at first: square at the facade of the largest area, else as the photo in the midst of the others.

    Where that is not known either it is at the Gaussians, from the south. A place in metres, heading and pitch in
    radians, half the width and height of what is to be seen there, how far it comes forward, and how far from that one
    can go back before something else stands in the way.
    """
    origin = np.asarray(scene.origin_enu_m, np.float64)
    facades = [
        np.asarray([element.corners_enu_m for element in component.elements], np.float64) - origin
        for component in scene.components
        if component.elements
    ]
    if not facades:
        as_photographed = _photographed(scene, gaussians)
        if as_photographed is not None:
            return as_photographed
        places = gaussians.means_m.astype(np.float64) if len(gaussians) else np.zeros((1, 3))
        low, high = np.quantile(places, (0.05, 0.95), axis=0)  # a few lie far out
        radius = max(float(np.linalg.norm(high - low)) / 2.0, 0.5)
        return _view((low + high) / 2.0, 0.0, -0.12, np.full(2, radius), 0.0, radius / HALF_FIELD)
    quads = facades[largest(facades)]
    normal, middle = outward(quads), middle_of(quads)
    forward = np.array([0.0, 1.0, 0.0]) if normal is None else -normal  # panels on all sides: from the south
    heading, pitch = _angles(forward)
    axes = _axes(heading, pitch)
    inside = (quads.reshape(-1, 3) - middle) @ axes.T
    half, front = np.maximum(np.abs(inside[:, :2]).max(axis=0), 0.25), float(-inside[:, 2].min())
    free = _free_m(gaussians, middle, axes, half, front)
    return _view(middle, heading, pitch, half, front, free)


def _photographed(scene: GsScene, gaussians: Ellipsoids) -> dict[str, Any] | None:
    """From where the photo in the midst of the others was taken, at what stands in its middle; None where not known."""
    look = usual_look(scene.training)
    if look is None:
        return None
    place, forward = look[0] - np.asarray(scene.origin_enu_m, np.float64), look[1]
    towards = gaussians.means_m - place
    depths = towards @ forward
    is_ahead = depths > np.linalg.norm(towards, axis=1) * math.cos(AHEAD_RAD)
    if not is_ahead.any():
        return None
    distance = float(np.median(depths[is_ahead]))
    heading, pitch = _angles(forward)
    return _view(place + distance * forward, heading, pitch, np.full(2, distance * HALF_FIELD), 0.0, distance)


def _angles(forward: Array) -> tuple[float, float]:
    """Heading and pitch, as the page's camera can have them, of a unit direction."""
    is_level = np.hypot(forward[0], forward[1]) > 1e-6
    heading = float(np.arctan2(forward[0], forward[1])) if is_level else 0.0
    return heading, float(np.clip(np.arcsin(np.clip(forward[2], -1.0, 1.0)), -STEEPEST, STEEPEST))


def _axes(heading: float, pitch: float) -> Array:
    """Right, down and forward of a camera, as rows."""
    sh, ch, sp, cp = np.sin(heading), np.cos(heading), np.sin(pitch), np.cos(pitch)
    return np.array([[ch, -sh, 0.0], [sp * sh, sp * ch, -cp], [cp * sh, cp * ch, sp]])


def _free_m(gaussians: Ellipsoids, middle: Array, axes: Array, half: Array, front: float) -> float:
    """How far before a facade one can stand so that what lies between hides hardly more of it than from near."""
    furthest = float(half.max()) / HALF_FIELD
    depths = (gaussians.means_m - middle) @ axes[2] + front
    between = gaussians.chosen((depths < -CLEAR_M) & (depths > -furthest - 1.0) & (gaussians.panels < 0))
    if not len(between):
        return furthest
    tried = [furthest * STEP**k for k in range(N_TRIED)]
    hidden = np.array([_hidden(between, middle, axes, half, front + distance) for distance in tried])
    return tried[int(np.argmax(hidden <= hidden.min() + MOST_HIDDEN))]


def _hidden(gaussians: Ellipsoids, middle: Array, axes: Array, half: Array, distance: float) -> float:
    """Share of a facade that Gaussians before it hide from a place straight in front."""
    cam_from_world = np.eye(4)
    cam_from_world[:3, :3] = axes
    cam_from_world[:3, 3] = -axes @ (middle - distance * axes[2])
    width, height = SIGHT_PX
    fx, fy = (0.5 * np.array(SIGHT_PX) / half * distance).tolist()
    view = View(width, height, fx, fy, width / 2.0, height / 2.0, torch.from_numpy(cam_from_world))
    means, quats, scales, opacities = (
        torch.from_numpy(each) for each in (gaussians.means_m, gaussians.quats, gaussians.scales_m, gaussians.opacities)
    )
    settings, nothing = RasterSettings(antialiased=True), torch.zeros(len(gaussians), 1)
    return float(rasterise(means, quats, scales, opacities, nothing, view, settings=settings).alphas.mean())


def _view(target: Array, heading: float, pitch: float, half: Array, front: float, free: float) -> dict[str, Any]:
    return {
        "target": _told(target),
        "heading": round(heading, 6),
        "pitch": round(pitch, 6),
        "half": _told(half),
        "front": round(front, 4),
        "free": round(free, 4),
    }


def _told(place: Array) -> list[float]:
    return [round(float(value), 4) for value in place]


# What lies behind everything on a web page: the model's sky, or a plain one. Linear light: 1 is as bright as white.
#
# A picture of all directions as `reconstruction.splats.sky.Sky` has it: rows from the zenith to the nadir, twice as
# many columns clockwise from south, so that north is in the middle.

Halves = NDArray[np.float16]

N_ROWS = 64

_PLAIN = ((0.0, (150, 182, 212)), (0.49, (226, 234, 240)), (0.51, (176, 178, 178)), (1.0, (120, 122, 122)))
"""sRGB colours by share of the way from the zenith to the nadir: overcast sky above, grey ground below."""


def sky_light(sky: Sky) -> Halves:
    """Of a model, shape (h, 2 h, 3); as bright as the model has it, which what is thin before it lets through."""
    with torch.no_grad():
        return sky.picture().cpu().numpy().astype(np.float16)


def plain_sky_light() -> Halves:
    """Where a model has none, shape (h, 2 h, 3)."""
    shares = (np.arange(N_ROWS) + 0.5) / N_ROWS
    places = [share for share, _ in _PLAIN]
    colours = np.stack([np.interp(shares, places, [colour[i] for _, colour in _PLAIN]) for i in range(3)], axis=1)
    light = light_of_display(torch.from_numpy(colours / 255.0)).numpy().astype(np.float16)
    return np.repeat(light[:, None], 2 * N_ROWS, axis=1)


FORMAT = "reflight-web/1"
PAGE = "index.html"
PARTS = "parts-"
SIGN = f'<meta name="generator" content="{FORMAT}">'
"""Of our pages, in their first bytes: no other page is written over."""

SOURCES = Path(__file__).parent / "data"
SCRIPTS = (
    *(
        "words",
        "geometry",
        "order",
        "shaders",
        "picture",
        "mirrors",
        "colours",
        "records",
        "motion",
        "loading",
        "parts",
    ),
    "page",
)
LAST = "scripting"
SHADERS = ("view", "splats", "mirrors", "overlays")
SHARED = ("mirrored", "network")
"""Of WebGPU, in one piece; the window's pictures by a graphics card are made with the shared ones, too."""

PAGE_FILE = FileLimit(say("a web page"), 4096 * MIB)

MAX_TEXT_BYTES = 64 * 2**20
"""Of records and panes."""


@dataclass(frozen=True, slots=True)
class WebOptions:
    """What a page is to have.

    Parameters
    ----------
    title
        "": the scene's name.
    degree
        Up to which harmonics colours depend on where one looks from, 0 to 3: 9, 24 and 45 bytes more per Gaussian.
    most
        Keep so many of the most visible Gaussians; None: all.
    is_baked
        Whether what panes mirror is in their colours: the page says so in its footnote.
    mirrors
        What panes mirror in browsers with WebGPU; None where they mirror nothing.
    sky
        What lies behind everything, see `sky_light`; None: a plain one.
    content_of
        Content of a picture or document that a record names, or None where there is none.
    """

    title: str = ""
    degree: int = 2
    most: int | None = None
    is_baked: bool = True
    mirrors: PaneMirrors | None = None
    sky: Halves | None = None
    content_of: Callable[[str], bytes | None] = field(default=lambda name: None)

    def __post_init__(self) -> None:
        if self.degree not in (0, 1, 2, 3):
            raise ValueError(f"degree: expected 0 to 3, got {self.degree}")
        if self.most is not None and self.most < 1:
            raise ValueError(f"most: expected 1 or more, got {self.most}")
        if self.sky is not None and (self.sky.dtype != np.float16 or self.sky.shape[1:] != (2 * len(self.sky), 3)):
            raise ValueError(f"sky: expected float16 of shape (h, 2 h, 3), got {self.sky.dtype} {self.sky.shape}")


@dataclass(frozen=True, slots=True)
class WebPage:
    """What was written.

    Parameters
    ----------
    n_strays
        Records whose object is not in the scene; they are not in the page.
    n_missing, n_damaged, n_large
        Files that records name and that are not in the page, but named there: those that are not beside the records,
        pictures that cannot be read, and documents for which there is no room.
    """

    path: Path
    n_bytes: int
    n_gaussians: int
    n_panes: int
    n_pictures: int
    n_documents: int
    n_strays: int
    n_missing: int
    n_damaged: int
    n_large: int


def write_web(
    scene: GsScene,
    folder: Path,
    records: Sequence[Row] = (),
    options: WebOptions | None = None,
    monitor: Monitor = QUIET,
) -> WebPage:
    """Write the page of a scene, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    folder
        Made where it is missing; one that has a page of ours gets the new one.
    records
        Of elements, components and the scene; see `page_records`.

    Raises
    ------
    InputError
        The folder has other files and no page of ours, or cannot be written; the scene has more Gaussians or panes than
        a page bears, or numbers that are not finite; a record cannot be shown, or pictures are too large together.
    OperationCancelled
        The user cancelled; nothing was written.
    """
    options, raster = options or WebOptions(), raster_of(scene)
    _check_folder(folder)
    elements = tuple(element for _, element in scene.elements)
    parts_of_scene = {part.global_id for part in scene.components} | {element.global_id for element in elements}
    found, n_strays = by_object(records, frozenset({scene.global_id, *parts_of_scene}))
    files = files_of(found, options.content_of, monitor)
    gaussians = _gaussians(scene, elements, options, folder)
    shown = _packed_scene(scene, gaussians, elements, options)
    chunks, glass = shown.chunks, shown.glass
    sky = plain_sky_light() if options.sky is None else options.sky
    described = {
        "title": options.title or scene.name,
        "scene": scene.global_id,
        "is_baked": options.is_baked,
        "is_antialiased": raster.antialiased,
        "blur_px2": raster.blur_px**2,
        "n": len(chunks),
        "at_once": N_AT_ONCE,
        "degree": options.degree,
        "rest_steps": [float(step) for step in chunks.rest_steps],
        "colour_range": COLOUR_RANGE,
        "mirrors": None if glass is None else _described_mirrors(options, elements, glass),
        "beside": shown.described(),
        "sky": {"rows": len(sky), "halves": base64.b64encode(sky.astype("<f2").tobytes()).decode()},
        "view": first_view(scene, elements, gaussians),
        **described_panes(scene, elements),
        "columns": [asdict(column) for column in columns_of(elements, found)],
        "records": found,
        "files": files.as_json(),
    }
    place = _name_parts(described)
    head = _head(described, options.title or scene.name)

    def parts() -> Iterator[bytes]:
        yield head
        own = iter(()) if glass is None else glass.chunks()
        for number, chunk in enumerate(chunks.chunks()):
            monitor.report(say("writing the page"), number * N_AT_ONCE, len(chunks))
            yield _block("g", number, chunk)
            for values in islice(own, 1):
                yield _block("m", number, values)
            if shown.part_of is not None:
                numbers = shown.part_of[number * N_AT_ONCE : (number + 1) * N_AT_ONCE]
                yield _block("b", number, numbers.astype("<u2").tobytes())
            if number == 0 and glass is not None and options.mirrors is not None:
                # The first picture waits for neither the light nor the rest.
                for place, block in enumerate(options.mirrors.blocks()):
                    yield _block("l", place, block)
        for kind, contents in (("p", files.pictures), ("d", files.documents)):
            for number, content in enumerate(contents.values()):
                yield _block(kind, number, content)
        yield b"</body></html>\n"

    n_bytes = _write(folder, parts(), place, shown.files(monitor))
    states = list(files.states.values())
    lost = [states.count(state) for state in ("missing", "damaged", "large")]
    counts = shown.n_gaussians, len(elements), len(files.pictures), len(files.documents), n_strays
    return WebPage(folder / PAGE, n_bytes, *counts, *lost)


def _check_folder(folder: Path) -> None:
    """Refuse what is not ours to write into."""
    try:
        if not folder.exists():
            return
        if not folder.is_dir():
            raise InputError(say("cannot be written: this is a file; name a folder", place=folder))
        page = folder / PAGE
        if page.is_file():
            with open_input_file(page, PAGE_FILE) as stream:
                if SIGN.encode() in stream.read(1000):
                    return
            raise InputError(say("is a page of somebody else's; name another folder", place=page))
        if any(folder.iterdir()):
            raise InputError(
                say("has other files and no page of ours; name an empty folder, or a new one", place=folder)
            )
    except OSError as error:
        raise InputError(
            say("cannot be read ({}); name another folder", error.strerror or error, place=folder)
        ) from error


def _gaussians(scene: GsScene, elements: Sequence[GsElement], options: WebOptions, folder: Path) -> Ellipsoids:
    if not scene.components:
        raise InputError(say("not written: the scene has no components; export at least one facade", place=folder))
    if len(elements) > MAX_PANES:
        raise InputError(
            say("not written: {} panels, a page bears {}; export one facade", len(elements), MAX_PANES, place=folder)
        )
    gaussians = ellipsoids_of_all(scene.components, options.degree)
    for name in ("means_m", "quats", "scales_m", "opacities", "sh"):
        if not np.isfinite(getattr(gaussians, name)).all():
            raise InputError(
                say("not written: {} of the scene's Gaussians holds numbers that are not finite", name, place=folder)
            )
    n_kept = min(len(gaussians), options.most or len(gaussians))
    if n_kept > MAX_GAUSSIANS:
        raise InputError(
            say(
                "not written: {} Gaussians, a page bears {}; keep the most visible ones alone (most), or export "
                "one facade",
                n_kept,
                MAX_GAUSSIANS,
                place=folder,
            )
        )
    return gaussians


@dataclass(frozen=True, slots=True, eq=False)
class _PackedScene:
    """What a page has of a scene's Gaussians, and what lies beside it.

    Parameters
    ----------
    chunks, glass
        All of it, or the coarse model; `glass` None where no pane mirrors.
    levels
        None where all is in the page.
    fine, own, panes
        What parts are of, with values of glass and panes by row.
    part_of
        Number + 1 of the part that takes the place of each Gaussian in the page; 0 for none.
    """

    chunks: PackedGaussians
    glass: PackedGlass | None
    fine: Ellipsoids
    own: GlassValues | None
    panes: NDArray[np.int32]
    degree: int
    levels: TwoLevels | None = None
    part_of: NDArray[np.int32] | None = None

    @property
    def n_gaussians(self) -> int:
        """That can be seen, be it not all at once."""
        return len(self.chunks) if self.levels is None else int((self.fine.opacities >= FAINTEST).sum())

    def described(self) -> dict[str, Any] | None:
        """For the page, as JSON has it: of each part how many Gaussians, how many of them on panes, and where."""
        if self.levels is None:
            return None
        each = []
        for part in self.levels.parts:
            seen = self.fine.opacities[part.rows] >= FAINTEST
            n_glass = int((seen & (self.panes[part.rows] >= 0)).sum()) if self.glass is not None else 0
            each.append([int(seen.sum()), n_glass, *(round(value, 3) for value in (*part.middle_m, part.radius_m))])
        most_glass = max((n_glass for _, n_glass, *_ in each), default=0)
        room = min(len(each) * PART, RESIDENT)
        return {"size": PART, "room": room, "most_glass": most_glass, "side": self.levels.side_m, "each": each}

    def files(self, monitor: Monitor) -> Iterator[bytes]:
        """Scripts that hand the page its parts."""
        parts = () if self.levels is None else self.levels.parts
        for number, part in enumerate(parts):
            monitor.report(say("writing the page"), number, len(parts))
            steps = self.chunks.rest_steps
            chunks = packed(self.fine.chosen(part.rows), self.panes[part.rows], self.degree, steps=steps)
            contents = [_in_one(chunks.words, chunks.rest)]
            if self.glass is not None and self.own is not None:
                steps = self.glass.rest_steps
                glass = packed_glass(self.own.chosen(part.rows), chunks, self.degree, steps)
                contents.append(_in_one(glass.words, glass.rest))
            texts = b",".join(b'"%b"' % base64.b64encode(content) for content in contents)
            yield b"reflightPart(%d,%b);\n" % (number, texts)


def _in_one(words: Words, rest: NDArray[np.int8]) -> bytes:
    return words.astype("<u4").tobytes() + rest.tobytes()


def _packed_scene(
    scene: GsScene, gaussians: Ellipsoids, elements: Sequence[GsElement], options: WebOptions
) -> _PackedScene:
    """All of it in the page, or a coarse model and parts."""
    degree, mirrors, panes = options.degree, options.mirrors, panes_of(gaussians, elements)
    own = None
    if mirrors is not None and (panes >= 0).any():
        own = glass_of(mirrors, np.concatenate([part.gaussians.places for part in scene.components]), degree)
    if options.most is not None or len(gaussians) <= MOST_EMBEDDED:
        chunks = packed(gaussians, panes, degree, options.most)
        glass = None if own is None or not chunks.is_on_pane.any() else packed_glass(own, chunks, degree)
        return _PackedScene(chunks, glass, gaussians, own, panes, degree)
    levels = two_levels(gaussians, own)
    some = slice(None, None, max(1, len(gaussians) // MOST_EMBEDDED))
    steps = _steps(gaussians.sh[some, 1:])
    chunks = packed(levels.coarse, panes_of(levels.coarse, elements), degree, steps=steps)
    glass = None
    if own is not None and levels.glass is not None:
        glass = packed_glass(levels.glass, chunks, degree, _steps(own.sh[some][panes[some] >= 0][:, 1:]))
    part_of = levels.part_of[chunks.rows] + 1
    return _PackedScene(chunks, glass, gaussians, own, panes, degree, levels, part_of)


def _name_parts(described: dict[str, Any]) -> str:
    """Name the folder of parts by what the page says of them; "" where there are none."""
    if described["beside"] is None:
        return ""
    text = json.dumps(described, ensure_ascii=True, allow_nan=False)
    described["beside"]["folder"] = f"{PARTS}{hashlib.sha256(text.encode()).hexdigest()[:12]}"
    return str(described["beside"]["folder"])


def _described_mirrors(options: WebOptions, elements: Sequence[GsElement], glass: PackedGlass) -> dict[str, Any]:
    assert options.mirrors is not None
    steps = [float(step) for step in glass.rest_steps]
    described = options.mirrors.described([element.panel for element in elements])
    return {**described, "n_glass": len(glass), "own_steps": steps}


def _head(described: Mapping[str, Any], title: str) -> bytes:
    """The page up to where the Gaussians begin."""
    style = _source("page.css")
    parts = [f"const WGSL = {json.dumps(wgsl())};", *(_source(f"{name}.js") for name in (*SCRIPTS, LAST))]
    script = '"use strict";\n(() => {\n' + "\n".join(parts) + "})();\n"
    text = json.dumps(described, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    if len(text) > MAX_TEXT_BYTES:
        raise InputError(
            say("records and panels: more than {} MiB of text; export one facade", MAX_TEXT_BYTES // 2**20)
        )
    blanks = {
        "SIGN": SIGN,
        # What our script loads is ours, too: parts.
        "SCRIPT_HASH": _hash(script) + (" 'strict-dynamic'" if described["beside"] else ""),
        "STYLE_HASH": _hash(style),
        "TITLE": html.escape(title.encode("utf-8", "replace").decode()),
        "STYLE": style,
        "SCRIPT": script,
        "MODEL": text,
    }
    pieces = _source("page.html").split("@@")
    if sorted(pieces[1::2]) != sorted(blanks):
        raise ValueError(f"page.html: expected {sorted(blanks)}, got {sorted(pieces[1::2])}")
    return "".join(blanks[piece] if place % 2 else piece for place, piece in enumerate(pieces)).encode()


def wgsl() -> str:
    """The page's programs for WebGPU."""
    return "".join([*(_source(f"{name}.wgsl") for name in SHADERS), *(shader(name, {}) for name in SHARED)])


def _source(name: str) -> str:
    return (SOURCES / name).read_text("utf-8")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _block(kind: str, number: int, content: bytes) -> bytes:
    """Bytes that the page's script finds; of this type browsers run none."""
    return b'<script type="text/plain" id="%b%d">%b</script>\n' % (kind.encode(), number, base64.b64encode(content))


def _write(folder: Path, blocks: Iterator[bytes], place: str, parts: Iterator[bytes]) -> int:
    """Write the page, whole or not at all; a folder that was made for it goes if that fails.

    Parameters
    ----------
    place
        Name of the folder of parts; those of an older page go once the new one stands.
    """
    is_new = not folder.exists()
    make_folder(folder)
    path, n_bytes, older = folder / PAGE, 0, set(folder.glob(f"{PARTS}*"))
    new = folder / place if place else None
    is_done = False
    try:
        if new is not None:
            n_bytes += _write_parts(new, parts)
        with whole_file(path) as temporary, temporary.open("wb") as stream:
            for block in blocks:
                n_bytes += stream.write(block)
        is_done = True
    finally:
        ours = set() if new is None else {new}
        for each in older - ours if is_done else ours - older:
            shutil.rmtree(each, ignore_errors=True)
        if is_new and not path.exists():
            folder.rmdir()
    return n_bytes


def _write_parts(folder: Path, parts: Iterator[bytes]) -> int:
    """Write the files of a page's parts."""
    make_folder(folder)
    n_bytes = 0
    for number, content in enumerate(parts):
        write_atomically(folder / f"{number}.js", content)
        n_bytes += len(content)
    return n_bytes
