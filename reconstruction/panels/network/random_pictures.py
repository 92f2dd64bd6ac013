"""Pictures of facades by chance, with their panes: what the network for panes learns from.

They are no photos of one place but of the kinds of things that happen: curtain walls and windows in walls, seen from
far and near, from the side and from below, whole and half built; glass that mirrors sky, trees and houses, or lets see
rooms; frames of any colour, down to those that light has burnt to white; trees, masts and cars before them; lenses,
noise, haze and night. Nothing is traced: facades are painted flat and seen through a homography, which takes a
hundredth of the time of `reconstruction.scenes` and lets every picture be another building.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Image = NDArray[np.float32]
"""Shape (h, w, 3), blue, green, red, 0 to 1 and above where the light is too strong."""

TEXTURE_PX = 640
"""Longer side of a painted facade."""

MOST_SHEAR_DEG = 68.0
"""A facade is seen from so far to the side at most."""

AT_NIGHT = 0.14
"""Share of pictures at night: rooms are lit, and little else is."""

LEAST_PANE_PX = 4.0
"""Panes whose shorter side is below it are no truth: nobody could point at them."""


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticPicture:
    """A picture and its panes.

    Parameters
    ----------
    image
        Shape (h, w, 3), uint8, blue, green, red.
    index
        Shape (h, w), uint16: number of the pane from 1, 0 elsewhere.
    corners_px
        Shape (n, 4, 2): of pane i + 1, lower left, lower right, upper right, upper left as seen from outside; beyond
        the picture where it cuts a pane. NaN where they are not known.
    """

    image: NDArray[np.uint8]
    index: NDArray[np.uint16]
    corners_px: NDArray[np.float32]


def synthetic_picture(seed: int, size_px: int = 384) -> SyntheticPicture:
    """A square picture with one to three facades; the same seed gives the same picture."""
    rng = np.random.default_rng([seed, 20_261])
    picture = _backdrop(rng, size_px)
    is_night = rng.random() < AT_NIGHT
    if is_night:
        picture *= np.float32(rng.uniform(0.02, 0.25))
    index = np.zeros((size_px, size_px), np.uint16)
    corners: list[Array] = []
    close_up = rng.random() < 0.35
    n_facades = 1 if close_up else int(rng.choice([1, 2, 3], p=[0.55, 0.35, 0.1]))
    for _ in range(n_facades):
        facade = _facade(rng, close_up, is_night)
        homography = _view(rng, facade, size_px, close_up)
        _place(rng, picture, index, corners, facade, homography)
    _before(rng, picture)
    image = _developed(rng, picture)
    return SyntheticPicture(image, index, np.asarray(corners, np.float32).reshape(-1, 4, 2))


# What lies behind: sky, ground, other houses.


def _noise(rng: np.random.Generator, height: int, width: int, roughness: float = 1.0) -> Image:
    """Smooth noise of many sizes, shape (h, w), about 0 with a deviation near 1."""
    longest = max(height, width)
    cells, weight = 2, 1.0
    total = rng.standard_normal((2, 2), np.float32)
    while cells < longest // 4:
        cells, weight = 2 * cells, weight * 0.55 * roughness
        shape = max(2, cells * height // longest), max(2, cells * width // longest)
        total = np.asarray(cv2.resize(total, shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)
        total += np.float32(weight) * rng.standard_normal(shape, np.float32)
    total = np.asarray(cv2.resize(total, (width, height), interpolation=cv2.INTER_LINEAR), np.float32)
    return np.asarray(total / (total.std() + 1e-6), np.float32)


def _colour(rng: np.random.Generator, low: float, high: float, saturation: float) -> Image:
    grey = rng.uniform(low, high)
    return np.asarray(np.clip(grey * (1.0 + saturation * rng.standard_normal(3)), 0.0, 1.5), np.float32)


def _scenery(rng: np.random.Generator, height: int, width: int, busy: float, is_mirrored: bool = True) -> Image:
    """Sky above, ground below, things in between; also what glass mirrors."""
    y = np.linspace(0.0, 1.0, height, dtype=np.float32)[:, None, None]
    top = _colour(rng, 0.3, 1.1, 0.08) * np.array([1.15, 1.0, 0.85], np.float32)
    low = _colour(rng, 0.5, 1.2, 0.05)
    picture = np.asarray(top + (low - top) * y + np.zeros((height, width, 3), np.float32), np.float32)
    if rng.random() < 0.6:
        clouds = np.clip(_noise(rng, height, width, 1.2) * 0.5 + rng.uniform(-0.3, 0.5), 0.0, 1.0)[..., None]
        picture += clouds * (rng.uniform(0.6, 1.4) - picture)
    horizon = rng.uniform(0.35, 0.95)
    ground = _colour(rng, 0.1, 0.6, 0.12) * (1.0 + 0.15 * _noise(rng, height, width)[..., None])
    is_ground = y[..., 0] > horizon
    picture = np.where(is_ground[..., None], ground, picture).astype(np.float32)
    for _ in range(int(busy * rng.integers(2, 9))):
        if rng.random() < 0.5:
            _house(rng, picture, horizon, has_spots=is_mirrored and rng.random() < 0.6)
        else:
            _foliage(rng, picture, (rng.uniform(0, width), horizon * height), rng.uniform(0.05, 0.25) * width)
    return picture


def _house(rng: np.random.Generator, picture: Image, horizon: float, has_spots: bool) -> None:
    """A block with rows of dark or bright spots, as other houses look in a mirror; no pane of it is truth."""
    height, width = picture.shape[:2]
    x0, wide = rng.uniform(-0.1, 0.9) * width, rng.uniform(0.08, 0.4) * width
    y1 = (horizon + rng.uniform(-0.05, 0.1)) * height
    y0 = y1 - rng.uniform(0.08, 0.6) * height
    box = slice(max(0, int(y0)), max(0, int(y1))), slice(max(0, int(x0)), max(0, int(x0 + wide)))
    part = picture[box]
    if part.size == 0:
        return
    part[:] = _colour(rng, 0.15, 0.8, 0.1)
    if has_spots:
        step = rng.uniform(4.0, 20.0)
        yy, xx = np.mgrid[: part.shape[0], : part.shape[1]]
        spots = (np.mod(xx, step) < 0.5 * step) & (np.mod(yy, 1.3 * step) < 0.6 * step)
        part[spots] = _colour(rng, 0.05, 0.9, 0.1)


def _foliage(rng: np.random.Generator, picture: Image, root: tuple[float, float], size: float) -> None:
    """A tree or bush: leaves as thresholded noise within a blob, on a trunk."""
    height, width = picture.shape[:2]
    x, y = root
    centre = x, y - size * rng.uniform(0.5, 1.8)
    x0, x1 = int(max(0, centre[0] - size)), int(min(width, centre[0] + size))
    y0, y1 = int(max(0, centre[1] - size)), int(min(height, centre[1] + size))
    if x1 - x0 < 4 or y1 - y0 < 4:
        return
    colour = _colour(rng, 0.03, 0.35, 0.1) * np.array([0.6, 1.1, 0.8], np.float32)
    trunk = max(1, int(0.1 * size))
    cv2.line(picture, (int(x), int(y)), (int(centre[0]), int(centre[1])), [float(c) * 0.5 for c in colour], trunk)
    yy, xx = np.mgrid[y0:y1, x0:x1].astype(np.float32)
    distance = np.hypot((xx - centre[0]) / size, (yy - centre[1]) / size)
    leaves = _noise(rng, y1 - y0, x1 - x0, 1.5) + 2.2 * (0.75 - distance) > 0.2
    shade = 1.0 + 0.35 * _noise(rng, y1 - y0, x1 - x0, 1.6)[..., None]
    part = picture[y0:y1, x0:x1]
    part[leaves & (distance < 1.0)] = (colour * shade)[leaves & (distance < 1.0)]


def _backdrop(rng: np.random.Generator, size_px: int) -> Image:
    if rng.random() < 0.15:
        plain = _colour(rng, 0.0, 1.2, 0.2) + 0.1 * _noise(rng, size_px, size_px)[..., None]
        return np.asarray(plain, np.float32)
    return _scenery(rng, size_px, size_px, 1.0, is_mirrored=False)


# A facade, painted flat.


@dataclass(frozen=True, slots=True, eq=False)
class _Facade:
    """A painted facade and the panes on it.

    `panes` has shape (n, 4): left, top, right, bottom in its own pixels, on a half-open grid of pixels.
    """

    picture: Image
    alpha: NDArray[np.uint8]
    panes: Array


def _facade(rng: np.random.Generator, close_up: bool, is_night: bool) -> _Facade:
    kind = rng.choice(["curtain", "windows", "bands"], p=[0.8, 0.15, 0.05] if close_up else [0.45, 0.45, 0.1])
    most = 4 if close_up else int(rng.choice([8, 14, 26]))
    n_columns, n_rows = int(rng.integers(1, most + 1)), int(rng.integers(1, most + 1))
    aspect = float(np.exp(rng.normal(0.0, 0.45)))
    cell_width, cell_height = 1.0, 1.0 / aspect
    scale = TEXTURE_PX / max(n_columns * cell_width, n_rows * cell_height)
    widths = _steps(rng, n_columns) * cell_width * scale
    heights = _steps(rng, n_rows) * cell_height * scale
    margin = np.ceil(rng.uniform(0.0, 0.8 if kind != "curtain" else 0.35, 4) * scale * min(cell_width, cell_height))
    xs = margin[0] + np.concatenate([[0.0], np.cumsum(widths)])
    ys = margin[1] + np.concatenate([[0.0], np.cumsum(heights)])
    size = int(ys[-1] + margin[3]) + 1, int(xs[-1] + margin[2]) + 1
    if kind == "curtain":
        facade = _curtain_wall(rng, xs, ys, size, close_up)
    else:
        facade = _wall(rng, xs, ys, size, is_band=kind == "bands")
    if is_night:
        _at_night(rng, facade)
    return facade


def _at_night(rng: np.random.Generator, facade: _Facade) -> None:
    """Dark walls and glass, some of it lit by a lamp of its own, and lamps on the wall."""
    picture = facade.picture
    height, width = picture.shape[:2]
    picture *= np.float32(rng.uniform(0.02, 0.3))
    if rng.random() < 0.5:  # lit from below
        shine = np.linspace(0.0, 1.0, height, dtype=np.float32)[:, None, None] ** 2
        picture *= 1.0 + rng.uniform(0.0, 4.0) * shine
    usual, share = _colour(rng, 0.4, 1.4, 0.12), rng.uniform(0.15, 1.0)
    usual = usual * np.array([rng.uniform(0.5, 1.0), 0.9, 1.0], np.float32)
    mixed, uneven = rng.uniform(0.0, 0.25), rng.uniform(0.0, 0.8)
    by_storey = rng.random() < 0.3
    lit = rng.random(256) < share
    for number, (left, top, right, bottom) in enumerate(np.rint(facade.panes).astype(int)):
        if right <= left or bottom <= top or not lit[(top if by_storey else number) % 256]:
            continue
        part = picture[top:bottom, left:right]
        lamp = usual * (1.0 + mixed * rng.standard_normal(3)).astype(np.float32) * rng.uniform(0.4, 1.3)
        down = np.linspace(1.0, 1.0 - uneven * rng.random(), len(part), dtype=np.float32)[:, None, None]
        room = lamp * down * (1.0 + 0.25 * _noise(rng, *part.shape[:2])[..., None])
        before = part.mean(axis=2, keepdims=True)
        part[:] = room * np.clip(0.35 + before / max(float(before.max()), 1e-3), 0.0, 1.0)  # bars and blinds stay dark
    for _ in range(int(rng.choice([0, 0, 1, 3]))):
        x, y, reach = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0.02, 0.1) * width
        far = 3.0 * reach
        box = slice(max(0, int(y - far)), int(y + far) + 1), slice(max(0, int(x - far)), int(x + far) + 1)
        yy, xx = np.mgrid[:height, :width][:, *box].astype(np.float32)
        shine = np.exp(-((xx - x) ** 2 + (yy - y) ** 2) / (2.0 * reach**2))[..., None]
        picture[box] += shine * _colour(rng, 0.5, 2.0, 0.15)


def _steps(rng: np.random.Generator, n: int) -> Array:
    """Sizes of rows or columns as multiples of the usual one: equal, alternating, one odd, or by chance."""
    kind = rng.random()
    if kind < 0.55:
        return np.ones(n)
    if kind < 0.7:
        return np.where(np.arange(n) % 2 == 0, 1.0, rng.uniform(0.35, 1.0))
    if kind < 0.85:
        steps = np.ones(n)
        steps[rng.integers(n)] = rng.uniform(0.4, 1.8)
        return steps
    return rng.uniform(0.5, 1.5, n)


def _glass(rng: np.random.Generator, size: tuple[int, int], boxes: Array, is_glazed: NDArray[np.bool_]) -> Image:
    """What panes show: a mirrored scenery that jumps a little from pane to pane, over rooms, blinds and tint."""
    height, width = size
    outside = _scenery(rng, height // 2 + 60, width // 2 + 60, rng.uniform(0.3, 2.0))
    if rng.random() < 0.3:  # the mirrored scene fills but a few panes: seen near
        outside = outside[: max(8, outside.shape[0] // 2)]
    outside = np.asarray(cv2.resize(outside, (width + 120, height + 120)), np.float32)
    reflectance = float(rng.choice([rng.uniform(0.0, 0.3), rng.uniform(0.3, 1.0)]))
    room, tint = _colour(rng, 0.02, 0.35, 0.12), _colour(rng, 0.6, 1.0, 0.08)
    night = rng.random() < 0.15
    jump, blinds, lit = rng.uniform(0.0, 14.0), rng.uniform(0.0, 0.5), rng.uniform(0.1, 0.7)
    glass = np.zeros((height, width, 3), np.float32)
    warped = rng.random() < 0.5
    for box, glazed in zip(boxes.reshape(-1, 4), is_glazed.ravel(), strict=True):
        left, top, right, bottom = (int(v) for v in np.rint(box))
        if not glazed or right <= left or bottom <= top:
            continue
        inside = np.broadcast_to(room * rng.uniform(0.6, 1.4), (bottom - top, right - left, 3)).copy()
        if rng.random() < blinds:
            drawn = max(1, int((bottom - top) * (1.0 if rng.random() < 0.3 else rng.uniform(0.1, 1.0))))
            inside[:drawn] = _colour(rng, 0.3, 0.95, 0.08)
            if rng.random() < 0.4:
                inside[:drawn:4] *= 0.8
        if night and rng.random() < lit:
            inside[:] = _colour(rng, 0.5, 1.3, 0.15)
        if rng.random() < 0.3:
            inside *= 1.0 + 0.3 * _noise(rng, bottom - top, right - left)[..., None]
        dx, dy = np.clip(60.0 + jump * rng.standard_normal(2), 0, 119).astype(int)
        mirrored = outside[top + dy : bottom + dy, left + dx : right + dx]
        if warped and rng.random() < 0.3:
            mirrored = mirrored * rng.uniform(0.7, 1.2)
        share = np.clip(reflectance * rng.uniform(0.85, 1.1), 0.0, 1.0)
        if rng.random() < 0.04:
            share = min(1.0, share + 0.4)
        glass[top:bottom, left:right] = tint * (share * mirrored + (1.0 - share) * inside)
    return glass


def _curtain_wall(rng: np.random.Generator, xs: Array, ys: Array, size: tuple[int, int], close_up: bool) -> _Facade:
    """Profiles with panes between them; some panes or profiles not there, some cells closed."""
    step = min(float(np.diff(xs).min()), float(np.diff(ys).min()))
    across, along = step * rng.uniform(0.012, 0.2, 2) if rng.random() < 0.7 else step * rng.uniform(0.012, 0.06, 2)
    half_x, half_y = max(0.6, 0.5 * across), max(0.6, 0.5 * along)
    boxes = np.stack(
        [
            np.broadcast_to(xs[None, :-1] + half_x, (len(ys) - 1, len(xs) - 1)),
            np.broadcast_to(ys[:-1, None] + half_y, (len(ys) - 1, len(xs) - 1)),
            np.broadcast_to(xs[None, 1:] - half_x, (len(ys) - 1, len(xs) - 1)),
            np.broadcast_to(ys[1:, None] - half_y, (len(ys) - 1, len(xs) - 1)),
        ],
        axis=-1,
    )
    n_rows, n_columns = boxes.shape[:2]
    is_open = rng.random((n_rows, n_columns)) < rng.choice([0.0, 0.05, 0.4], p=[0.65, 0.1, 0.25])
    is_closed = rng.random((n_rows, n_columns)) < rng.choice([0.0, 0.08], p=[0.9, 0.1])
    if rng.random() < 0.08:
        is_closed[rng.integers(n_rows) :: max(2, int(rng.integers(2, 5)))] = True
    is_glazed = ~is_open & ~is_closed
    frame = _colour(
        rng, *[(0.02, 0.2), (0.25, 0.7), (0.8, 1.1), (1.1, 2.5)][rng.choice(4, p=[0.35, 0.3, 0.2, 0.15])], 0.06
    )
    picture = np.broadcast_to(frame, (*size, 3)).astype(np.float32).copy()
    if rng.random() < 0.5:
        picture *= 1.0 + 0.12 * _noise(rng, *size)[..., None]
    glass = _glass(rng, size, boxes, is_glazed)
    spandrel = _colour(rng, 0.05, 0.9, 0.1)
    behind = _scenery(rng, *size, 1.0, is_mirrored=False) * rng.uniform(0.2, 1.2) if is_open.any() else None
    room = _inside(rng, size) if is_open.any() else None
    alpha = np.full(size, 255, np.uint8)
    sees_room = rng.random() < 0.7
    for row in range(n_rows):
        for column in range(n_columns):
            left, top, right, bottom = (int(v) for v in np.rint(boxes[row, column]))
            part = slice(top, bottom), slice(left, right)
            if is_glazed[row, column]:
                picture[part] = glass[part]
            elif is_open[row, column] and room is not None and behind is not None:
                picture[part] = room[part] if sees_room else behind[part]
                if not sees_room and rng.random() < 0.3:
                    alpha[part] = 0
            else:
                picture[part] = spandrel * (1.0 + 0.05 * rng.standard_normal())
    _profiles(rng, picture, boxes, is_glazed)
    outside = xs[0] - 3 * half_x, ys[0] - 3 * half_y, xs[-1] + 3 * half_x, ys[-1] + 3 * half_y
    if rng.random() < 0.6:
        wall = _masonry(rng, size)
        inside = np.zeros(size, bool)
        inside[max(0, int(outside[1])) : int(outside[3]), max(0, int(outside[0])) : int(outside[2])] = True
        picture[~inside] = wall[~inside]
    else:
        alpha[: max(0, int(outside[1]))] = 0
        alpha[int(outside[3]) :] = 0
        alpha[:, : max(0, int(outside[0]))] = 0
        alpha[:, int(outside[2]) :] = 0
    if close_up and rng.random() < 0.4:
        _burnt(rng, picture)
    return _Facade(picture, alpha, boxes[is_glazed])


def _inside(rng: np.random.Generator, size: tuple[int, int]) -> Image:
    """Floors, beams and cloth that one sees where the glass is not in yet: edges like frames, and no pane."""
    height, width = size
    picture = np.asarray(
        _colour(rng, 0.1, 0.9, 0.15) * (1.0 + 0.12 * _noise(rng, height, width)[..., None]), np.float32
    )
    for _ in range(int(rng.integers(2, 9))):
        colour = [float(c) for c in _colour(rng, 0.2, 1.2, 0.1)]
        y, x = int(rng.integers(height)), int(rng.integers(width))
        thick = int(rng.integers(3, max(4, height // 12)))
        if rng.random() < 0.5:
            cv2.line(picture, (0, y), (width, y + int(rng.normal(0.0, 0.05) * width)), colour, thick)
        else:
            cv2.line(picture, (x, 0), (x + int(rng.normal(0.0, 0.05) * height), height), colour, thick)
    return picture


def _profiles(rng: np.random.Generator, picture: Image, boxes: Array, is_glazed: NDArray[np.bool_]) -> None:
    """Light and dark sides of profiles and gaskets along the glass."""
    if rng.random() < 0.5:
        return
    colour = [float(c) for c in _colour(rng, 0.0, 1.2, 0.05)]
    thick = int(rng.integers(1, 4))
    for left, top, right, bottom in np.rint(boxes[is_glazed]).astype(int):
        cv2.line(picture, (left, top), (right, top), colour, thick)
        if rng.random() < 0.7:
            cv2.line(picture, (left, top), (left, bottom), colour, thick)


def _burnt(rng: np.random.Generator, picture: Image) -> None:
    """A place where the sun stands: all is white around it."""
    height, width = picture.shape[:2]
    x, y, reach = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0.1, 0.5) * max(height, width)
    yy, xx = np.mgrid[:height, :width].astype(np.float32)
    picture += rng.uniform(0.3, 2.0) * np.exp(-((xx - x) ** 2 + (yy - y) ** 2) / (2.0 * reach**2))[..., None]


def _masonry(rng: np.random.Generator, size: tuple[int, int]) -> Image:
    """Plaster, brick, stone or concrete."""
    height, width = size
    base = _colour(rng, 0.1, 0.95, 0.12)
    picture = np.asarray(
        base * (1.0 + rng.uniform(0.02, 0.15) * _noise(rng, height, width, 1.3)[..., None]), np.float32
    )
    kind = rng.random()
    if kind < 0.3:  # courses
        course = rng.uniform(5.0, 60.0)
        rows = np.mod(np.arange(height), course) < max(1.0, 0.1 * course)
        picture[rows] *= rng.uniform(0.6, 1.3)
        if rng.random() < 0.7:
            length = course * rng.uniform(1.5, 3.0)
            yy, xx = np.mgrid[:height, :width]
            joints = np.mod(xx + 0.5 * length * (np.floor(yy / course) % 2), length) < max(1.0, 0.1 * course)
            picture[joints] *= rng.uniform(0.6, 1.3)
    elif kind < 0.5:  # cornices
        for _ in range(int(rng.integers(1, 6))):
            y = int(rng.integers(height))
            picture[y : y + int(rng.integers(2, 25))] *= rng.uniform(0.5, 1.4)
    return picture


def _wall(rng: np.random.Generator, xs: Array, ys: Array, size: tuple[int, int], is_band: bool) -> _Facade:
    """A wall with a window in most cells: frames, bars, sills, shutters, arches, balconies."""
    picture = _masonry(rng, size)
    n_rows, n_columns = len(ys) - 1, len(xs) - 1
    wide = rng.uniform(0.9, 0.97) if is_band else rng.uniform(0.25, 0.8)
    high = rng.uniform(0.25, 0.8)
    shift = rng.uniform(-0.5, 0.5) * (1.0 - high)
    ww, hh = wide * np.diff(xs), np.repeat(high, n_rows) * np.diff(ys)
    if rng.random() < 0.3:  # storeys that differ
        hh *= rng.uniform(0.6, 1.0, n_rows)
    cx, cy = 0.5 * (xs[1:] + xs[:-1]), 0.5 * (ys[1:] + ys[:-1]) + shift * np.diff(ys)
    if rng.random() < 0.15:
        cx = cx + rng.normal(0.0, 0.06, n_columns) * np.diff(xs)
    boxes = np.stack(
        np.broadcast_arrays(
            (cx - 0.5 * ww)[None, :], (cy - 0.5 * hh)[:, None], (cx + 0.5 * ww)[None, :], (cy + 0.5 * hh)[:, None]
        ),
        axis=-1,
    )
    boxes = np.clip(boxes, 0.0, np.array([*size[::-1], *size[::-1]], float))
    is_glazed = rng.random((n_rows, n_columns)) > rng.choice([0.0, 0.1, 0.35], p=[0.5, 0.35, 0.15])
    glass = _glass(rng, size, boxes, is_glazed)
    _no_panes(rng, picture, boxes)
    style = _WindowStyle.random(rng)
    differ = rng.random() < 0.3
    for row in range(n_rows):
        if differ and rng.random() < 0.4:
            style = _WindowStyle.random(rng)
        for column in range(n_columns):
            if is_glazed[row, column]:
                style.paint(rng, picture, glass, boxes[row, column])
            elif rng.random() < 0.3:
                _blind(rng, picture, boxes[row, column])
    if rng.random() < 0.25:
        _balconies(rng, picture, boxes)
    return _Facade(picture, np.full(size, 255, np.uint8), boxes[is_glazed])


def _no_panes(rng: np.random.Generator, picture: Image, boxes: Array) -> None:
    """Doors, signs, vents, panels and pipes on a wall: straight and dark or bright as windows are, and no pane."""
    height, width = picture.shape[:2]
    usual = boxes[0, 0, 2:] - boxes[0, 0, :2]
    for _ in range(int(rng.choice([0, 0, 1, 3, 8]))):
        colour = _colour(rng, 0.03, 1.0, 0.2)
        wide, high = usual * np.exp(rng.normal(-0.3, 0.5, 2))
        x, y = rng.uniform(0, width), rng.uniform(0, height)
        kind = rng.random()
        if kind < 0.25:  # a door, on the ground
            y, high = height - high, 2.0 * high
        elif kind < 0.5:  # a sign or a panel over the windows
            wide = wide * rng.uniform(1.0, 5.0)
        elif kind < 0.7:  # a pipe, or the joint of two houses
            wide, y, high = max(1.0, 0.08 * wide), 0.0, float(height)
        box = slice(max(0, int(y)), max(0, int(y + high))), slice(max(0, int(x)), max(0, int(x + wide)))
        part = picture[box]
        if part.size == 0:
            continue
        texture = 1.0 + rng.uniform(0.0, 0.2) * _noise(rng, *part.shape[:2])[..., None]
        part[:] = colour * texture if kind < 0.85 else part * rng.uniform(0.5, 1.5)
        if rng.random() < 0.3:
            step = int(rng.integers(2, 9))
            part[::step] *= rng.uniform(0.3, 1.5)
        if rng.random() < 0.4:
            edge = [float(c) for c in _colour(rng, 0.05, 1.0, 0.1)]
            low = box[1].start, box[0].start
            cv2.rectangle(picture, low, (low[0] + part.shape[1], low[1] + part.shape[0]), edge, int(rng.integers(1, 4)))


def _blind(rng: np.random.Generator, picture: Image, box: Array) -> None:
    """A niche or a walled-up window."""
    left, top, right, bottom = (int(v) for v in np.rint(box))
    part = picture[top:bottom, left:right]
    if part.shape[0] < 4 or part.shape[1] < 4:
        return
    part *= np.float32(rng.uniform(0.75, 1.2))
    dark, thick = part[0, 0] * np.float32(rng.uniform(0.4, 0.9)), int(rng.integers(1, 4))
    part[:thick], part[:, :thick] = dark, dark


@dataclass(frozen=True, slots=True, eq=False)
class _WindowStyle:
    """How the windows of one house look."""

    frame: Image
    frame_share: float
    bars: tuple[int, int]
    bar_share: float
    surround: Image | None
    surround_share: float
    shutters: Image | None
    is_arched: bool
    has_sill: bool

    @classmethod
    def random(cls, rng: np.random.Generator) -> _WindowStyle:
        return cls(
            frame=_colour(rng, 0.05, 1.1, 0.08),
            frame_share=rng.uniform(0.0, 0.1),
            bars=(int(rng.choice([1, 1, 2, 2, 3])), int(rng.choice([1, 1, 2, 3, 4]))),
            bar_share=rng.uniform(0.01, 0.06),
            surround=_colour(rng, 0.2, 1.0, 0.08) if rng.random() < 0.4 else None,
            surround_share=rng.uniform(0.03, 0.2),
            shutters=_colour(rng, 0.05, 0.8, 0.2) if rng.random() < 0.15 else None,
            is_arched=rng.random() < 0.15,
            has_sill=rng.random() < 0.4,
        )

    def paint(self, rng: np.random.Generator, picture: Image, glass: Image, box: Array) -> None:
        """One window: glass and frame lie within the box, the rest around it."""
        left, top, right, bottom = (int(v) for v in np.rint(box))
        wide, high = right - left, bottom - top
        if wide < 2 or high < 2:
            return
        around = int(self.surround_share * wide)
        if self.surround is not None:
            picture[max(0, top - around) : bottom + around, max(0, left - around) : right + around] = self.surround
        if self.shutters is not None and rng.random() < 0.8:
            half = max(1, wide // 2)
            picture[top:bottom, max(0, left - half) : left] = self.shutters
            picture[top:bottom, right : right + half] = self.shutters
        if self.has_sill:
            sill = max(1, int(0.06 * high))
            picture[bottom : bottom + sill, max(0, left - sill) : right + sill] *= rng.uniform(0.5, 1.5)
        window = glass[top:bottom, left:right].copy()
        shape = window.shape[:2]
        if self.is_arched:
            yy, xx = np.mgrid[: shape[0], : shape[1]]
            radius = 0.5 * shape[1]
            corner = (yy < radius) & (np.hypot(xx + 0.5 - radius, yy + 0.5 - radius) > radius)
            window[corner] = picture[top:bottom, left:right][: shape[0], : shape[1]][corner]
        frame = round(self.frame_share * min(wide, high))
        if frame > 0:
            window[:frame], window[-frame:] = self.frame, self.frame
            window[:, :frame], window[:, -frame:] = self.frame, self.frame
        bar = max(1, int(self.bar_share * min(wide, high)))
        for number in range(1, self.bars[0]):
            x = number * wide // self.bars[0]
            window[:, max(0, x - bar // 2) : x - bar // 2 + bar] = self.frame
        for number in range(1, self.bars[1]):
            y = number * high // self.bars[1]
            window[max(0, y - bar // 2) : y - bar // 2 + bar] = self.frame
        picture[top:bottom, left:right][: shape[0], : shape[1]] = window[
            : picture[top:bottom, left:right].shape[0], : picture[top:bottom, left:right].shape[1]
        ]


def _balconies(rng: np.random.Generator, picture: Image, boxes: Array) -> None:
    colour = [float(c) for c in _colour(rng, 0.05, 0.9, 0.1)]
    for left, top, right, bottom in np.rint(boxes.reshape(-1, 4)).astype(int):
        if rng.random() < 0.3:
            more, y = (right - left) // 4, bottom - int(0.3 * (bottom - top))
            cv2.rectangle(
                picture, (left - more, y), (right + more, bottom + 3), colour, -1 if rng.random() < 0.3 else 1
            )
            for x in range(left - more, right + more, max(3, (right - left) // 8)):
                cv2.line(picture, (x, y), (x, bottom + 3), colour, 1)


# Seen from somewhere.


def _view(rng: np.random.Generator, facade: _Facade, size_px: int, close_up: bool) -> Array:
    """A homography from the painted facade into the picture, shape (3, 3)."""
    height, width = facade.alpha.shape
    frontal = rng.random() < 0.25
    yaw = 0.0 if frontal else np.radians(np.clip(rng.normal(0.0, 30.0), -MOST_SHEAR_DEG, MOST_SHEAR_DEG))
    pitch = 0.0 if frontal else np.radians(np.clip(rng.normal(5.0, 14.0), -50.0, 50.0))
    roll = np.radians(rng.normal(0.0, 1.0 if frontal else 5.0))
    focal = size_px * float(np.exp(rng.uniform(np.log(0.6), np.log(3.0))))
    cos, sin = np.cos, np.sin
    turn_y = np.array([[cos(yaw), 0, sin(yaw)], [0, 1, 0], [-sin(yaw), 0, cos(yaw)]])
    turn_x = np.array([[1, 0, 0], [0, cos(pitch), -sin(pitch)], [0, sin(pitch), cos(pitch)]])
    turn_z = np.array([[cos(roll), -sin(roll), 0], [sin(roll), cos(roll), 0], [0, 0, 1]])
    turn = turn_z @ turn_x @ turn_y
    # The facade fills a share of the picture: all of it and more in a close-up.
    fills = rng.uniform(0.9, 2.6) if close_up else float(np.exp(rng.uniform(np.log(0.35), np.log(2.2))))
    distance = focal * max(height, width) / (fills * size_px)
    at = np.array([rng.uniform(-0.35, 0.35), rng.uniform(-0.35, 0.35)]) * (1.0 if not close_up else 0.8)
    centre = np.array([[1.0, 0.0, -0.5 * width], [0.0, 1.0, -0.5 * height], [0.0, 0.0, 1.0]])
    plane = np.column_stack([turn[:, 0], turn[:, 1], [0.0, 0.0, distance]])
    plane[:, 2] += distance * np.array([at[0], at[1], 0.0]) * size_px / focal
    camera = np.array([[focal, 0.0, 0.5 * size_px], [0.0, focal, 0.5 * size_px], [0.0, 0.0, 1.0]])
    return np.asarray(camera @ plane @ centre)


def _place(
    rng: np.random.Generator,
    picture: Image,
    index: NDArray[np.uint16],
    corners: list[Array],
    facade: _Facade,
    homography: Array,
) -> None:
    """Paint a facade into the picture, over what is there, and add its panes to the truth."""
    size = picture.shape[0]
    ends = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float) * facade.alpha.shape[::-1]
    depth = ends @ homography[2, :2] + homography[2, 2]
    if depth.min() <= 0.05 * depth.max():
        return
    shrink = _area_scale(homography, facade.alpha.shape)
    texture, alpha, to_picture = facade.picture, facade.alpha, homography
    if shrink < 0.7:  # painted finer than seen: average first, as a sensor does
        factor = max(shrink, 0.05)
        small = max(1, round(alpha.shape[1] * factor)), max(1, round(alpha.shape[0] * factor))
        texture = np.asarray(cv2.resize(texture, small, interpolation=cv2.INTER_AREA), np.float32)
        scale = np.diag([alpha.shape[1] / small[0], alpha.shape[0] / small[1], 1.0])
        alpha = np.asarray(cv2.resize(alpha, small, interpolation=cv2.INTER_AREA), np.uint8)
        to_picture = homography @ scale
    half = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]])  # pixel middles lie at .5
    warp = np.linalg.inv(half) @ to_picture @ half
    seen = cv2.warpPerspective(texture, warp, (size, size), flags=cv2.INTER_LINEAR)
    mask = cv2.warpPerspective(alpha, warp, (size, size), flags=cv2.INTER_LINEAR).astype(np.float32)[..., None] / 255.0
    light = rng.uniform(0.5, 1.3)
    picture += mask * (light * seen - picture)
    index[mask[..., 0] > 0.5] = 0
    boxes = facade.panes
    points = np.stack([boxes[:, [0, 3]], boxes[:, [2, 3]], boxes[:, [2, 1]], boxes[:, [0, 1]]], axis=1)
    flat = points.reshape(-1, 2)
    image = flat @ homography[:, :2].T + homography[:, 2]
    places = (image[:, :2] / image[:, 2:]).reshape(-1, 4, 2)
    for quad in places:
        sides = np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1)
        low, high = quad.min(axis=0), quad.max(axis=0)
        if sides.min() < LEAST_PANE_PX or (high < 1).any() or (low > size - 1).any():
            continue
        corners.append(quad)
        smaller = quad + np.sign(quad.mean(axis=0) - quad) * 0.6  # the painter's outline is a pixel wide
        fixed = np.rint((smaller - 0.5) * 16.0).astype(np.int32)
        cv2.fillPoly(index, [fixed], len(corners), shift=4)


def _area_scale(homography: Array, shape: tuple[int, int]) -> float:
    """Picture pixels per painted one, along a side, at the facade's middle."""
    middle = 0.5 * np.array(shape[::-1])
    around = middle + np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    image = around @ homography[:, :2].T + homography[:, 2]
    places = image[:, :2] / image[:, 2:]
    a, b = places[1] - places[0], places[2] - places[0]
    return float(np.sqrt(abs(a[0] * b[1] - a[1] * b[0])))


def _before(rng: np.random.Generator, picture: Image) -> None:
    """Trees, masts, wires, cars and scaffolds before the facades; panes behind them stay truth."""
    size = picture.shape[0]
    for _ in range(int(rng.choice([0, 0, 0, 1, 2, 4]))):
        kind = rng.random()
        colour = [float(c) for c in _colour(rng, 0.02, 0.7, 0.15)]
        if kind < 0.3:
            _foliage(rng, picture, (rng.uniform(0, size), rng.uniform(0.6, 1.1) * size), rng.uniform(0.05, 0.25) * size)
        elif kind < 0.5:
            _branches(rng, picture, colour)
        elif kind < 0.75:
            a, b = rng.uniform(0, size, 2), rng.uniform(-0.2, 0.2) * size
            ends = ((a[0], 0.0), (a[0] + b, size)) if rng.random() < 0.5 else ((0.0, a[1]), (size, a[1] + b))
            (x0, y0), (x1, y1) = ends
            cv2.line(picture, (int(x0), int(y0)), (int(x1), int(y1)), colour, int(rng.choice([1, 1, 2, 4, 8])))
        else:
            x, y = rng.uniform(0, size), rng.uniform(0.7, 1.05) * size
            wide, high = rng.uniform(0.05, 0.25) * size, rng.uniform(0.03, 0.1) * size
            cv2.ellipse(picture, (int(x), int(y)), (int(wide), int(high)), 0, 0, 360, colour, -1)


def _branches(rng: np.random.Generator, picture: Image, colour: list[float]) -> None:
    size = picture.shape[0]
    tips = [(rng.uniform(0, size), rng.uniform(0.7, 1.1) * size, -0.5 * np.pi, rng.uniform(0.1, 0.25) * size, 5)]
    while tips:
        x, y, angle, length, level = tips.pop()
        x1, y1 = x + length * np.cos(angle), y + length * np.sin(angle)
        cv2.line(picture, (int(x), int(y)), (int(x1), int(y1)), colour, max(1, level - 1))
        if level > 1:
            for _ in range(int(rng.integers(2, 4))):
                tips.append((x1, y1, angle + rng.normal(0.0, 0.6), length * rng.uniform(0.5, 0.85), level - 1))


# Developed by some camera.


def _developed(rng: np.random.Generator, picture: Image) -> NDArray[np.uint8]:
    """Exposure, bloom, haze, shadows, colour, blur, noise and JPEG."""
    size = picture.shape[0]
    light = np.maximum(picture, 0.0)
    if rng.random() < 0.3:
        light = light * (1.0 + rng.uniform(0.1, 0.5) * _noise(rng, size, size, 0.4)[..., None]).clip(0.2, 2.0)
    light = light * np.exp(rng.normal(0.15, 0.35))
    if rng.random() < 0.08:
        light = light * rng.uniform(0.25, 0.6)
    if rng.random() < 0.35:  # bloom: what is too bright spills over
        extra = np.maximum(light - rng.uniform(0.7, 1.0), 0.0)
        light = light + rng.uniform(0.3, 2.0) * cv2.GaussianBlur(extra, (0, 0), rng.uniform(1.0, 14.0))
    if rng.random() < 0.25:
        veil = rng.uniform(0.0, 0.4)
        light = light * (1.0 - veil) + veil * rng.uniform(0.5, 1.1)
    light = light * (1.0 + 0.1 * rng.standard_normal(3)).astype(np.float32)
    blur = abs(rng.normal(0.0, 0.9))
    if blur > 0.3:
        light = cv2.GaussianBlur(light, (0, 0), blur)
    shown = np.clip(light, 0.0, 1.0) ** rng.uniform(0.5, 1.3)
    if rng.random() < 0.08:
        shown = np.broadcast_to(shown.mean(axis=-1, keepdims=True), shown.shape)
    shown = shown + rng.uniform(0.0, 0.04) * rng.standard_normal(shown.shape)
    image = np.asarray(np.clip(255.0 * shown + 0.5, 0, 255), np.uint8)
    if rng.random() < 0.6:
        _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(30, 96))])
        image = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)
    return image
