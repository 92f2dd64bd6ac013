"""COLMAP's text files (colmap.github.io, "Output Format"). Numbers are written so that they come back bit for bit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from planning.base.errors import InputError
from reconstruction.colmap.record import NO_POINT, NO_POINTS, ColmapCamera, ColmapImage, ColmapPoints

UNSIGNED_NO_POINT = str(2**64 - 1)
"""How some versions write that an observation is of no point."""

HEAD = {
    "cameras": "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n",
    "images": (
        "# Image list with two lines of data per image:\n"
        "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
    ),
    "points": (
        "# 3D point list with one line of data per point:\n"
        "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    ),
}


def read_cameras(content: str, place: str) -> list[ColmapCamera]:
    """Cameras of `cameras.txt`."""
    cameras = []
    for number, line in _lines(content):
        parts = line.split()
        try:
            camera_id, model, width, height = int(parts[0]), parts[1], int(parts[2]), int(parts[3])
            cameras.append(ColmapCamera(camera_id, model, width, height, tuple(map(float, parts[4:]))))
        except (ValueError, IndexError) as error:
            raise _wrong(place, number, "CAMERA_ID MODEL WIDTH HEIGHT PARAMS", line) from error
    return cameras


def read_images(content: str, place: str) -> list[ColmapImage]:
    """Images of `images.txt`: names run to the end of their line, and an image may have no observations."""
    images = []
    lines = _lines(content, keep_empty=True)
    for number, line in lines:
        if not line.strip():
            continue
        parts = line.split(maxsplit=9)
        try:
            image_id, camera_id, name = int(parts[0]), int(parts[8]), parts[9].rstrip("\r\n")
            w, x, y, z, *t = map(float, parts[1:8])
        except (ValueError, IndexError) as error:
            raise _wrong(place, number, "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME", line) from error
        number, line = next(lines, (number + 1, ""))
        parts = line.replace(UNSIGNED_NO_POINT, str(NO_POINT)).split()
        try:
            points_px = np.array([parts[0::3], parts[1::3]], np.float64).T.reshape(-1, 2)
            point_ids = np.array(parts[2::3], np.int64)
            if 3 * len(point_ids) != len(parts):
                raise ValueError("not three numbers each")
        except (ValueError, OverflowError) as error:
            raise _wrong(place, number, "X Y POINT3D_ID of every observation", line) from error
        images.append(ColmapImage(image_id, (w, x, y, z), (t[0], t[1], t[2]), camera_id, name, points_px, point_ids))
    return images


def read_points(content: str, place: str) -> ColmapPoints:
    """Points of `points3D.txt`."""
    ids, rows, tracks = [], [], []
    for number, line in _lines(content):
        parts = line.split()
        try:
            ids.append(int(parts[0]))
            rows.append([*map(float, parts[1:4]), *map(int, parts[4:7]), float(parts[7])])
            tracks.append(np.array(parts[8:], np.int64).reshape(-1, 2))
            if not all(0 <= value <= 255 for value in rows[-1][3:6]):
                raise ValueError("a colour is outside 0 to 255")
        except (ValueError, IndexError, OverflowError) as error:
            raise _wrong(place, number, "POINT3D_ID X Y Z R G B ERROR IMAGE_ID POINT2D_IDX ...", line) from error
    if not ids:
        return NO_POINTS
    table = np.array(rows, np.float64)
    return ColmapPoints(
        np.array(ids, np.int64),
        table[:, :3].copy(),
        table[:, 3:6].astype(np.uint8),
        table[:, 6].copy(),
        np.concatenate([[0], np.cumsum([len(track) for track in tracks])]).astype(np.int64),
        np.concatenate(tracks),
    )


def _lines(content: str, keep_empty: bool = False) -> Iterator[tuple[int, str]]:
    """Lines with their numbers from 1, without comments. Line breaks are those of files, not all that Unicode has."""
    for number, line in enumerate(content.split("\n"), 1):
        if not line.startswith("#") and (keep_empty or line.strip()):
            yield number, line


def _wrong(place: str, number: int, expected: str, line: str) -> InputError:
    found = line if len(line) <= 80 else f"{line[:77]}..."
    return InputError(f"{place}: line {number}: expected {expected}, found '{found.strip()}'")


def cameras_text(cameras: Sequence[ColmapCamera]) -> str:
    """Content of `cameras.txt`."""
    rows = (
        f"{c.id} {c.model} {c.width_px} {c.height_px} {' '.join(map(repr, map(float, c.parameters)))}\n"
        for c in cameras
    )
    return HEAD["cameras"] + f"# Number of cameras: {len(cameras)}\n" + "".join(rows)


def images_text(images: Sequence[ColmapImage]) -> str:
    """Content of `images.txt`."""
    mean = sum(len(image.point_ids) for image in images) / max(1, len(images))
    parts = [HEAD["images"], f"# Number of images: {len(images)}, mean observations per image: {mean!r}\n"]
    for image in images:
        pose = " ".join(map(repr, map(float, (*image.q_wxyz, *image.t))))
        seen = zip(image.points_px.tolist(), image.point_ids.tolist(), strict=True)
        parts.append(f"{image.id} {pose} {image.camera_id} {image.name}\n")
        parts.append(" ".join(f"{x!r} {y!r} {point}" for (x, y), point in seen) + "\n")
    return "".join(parts)


def points_text(points: ColmapPoints) -> str:
    """Content of `points3D.txt`."""
    mean = len(points.tracks) / max(1, len(points))
    parts = [HEAD["points"], f"# Number of points: {len(points)}, mean track length: {mean!r}\n"]
    for i in range(len(points)):
        start, stop = points.starts[i : i + 2].tolist()
        numbers = [int(points.ids[i]), *points.xyz[i].tolist(), *points.rgb[i].tolist(), float(points.errors_px[i])]
        numbers += points.tracks[start:stop].reshape(-1).tolist()
        parts.append(" ".join(map(repr, numbers)) + "\n")
    return "".join(parts)
