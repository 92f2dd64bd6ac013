"""Pictures that the network for panes learns from, as files: those made by chance, and photos whose panes are known."""

from __future__ import annotations

import multiprocessing
import queue
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from functools import partial
from pathlib import Path
from types import TracebackType

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.network.random_pictures import SyntheticPicture, synthetic_picture

PER_FILE = 50
"""Made pictures in a file of the pool."""

SYNTHETIC_PX = 448
"""Their size."""


class Pool:
    """A folder of synthetic pictures; those that are missing are made by processes of its own while others are learned.

    Use it in a `with` block: what is not made when that ends, is left.

    Parameters
    ----------
    n_pictures
        So many in all, in files of `PER_FILE`; files that are there already are left as they are.
    """

    def __init__(self, folder: Path, n_pictures: int, n_processes: int) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.n_pictures = n_pictures
        self._arrived: queue.SimpleQueue[Path | list[SyntheticPicture] | BaseException] = queue.SimpleQueue()
        paths = [folder / f"made-{number:04d}.npz" for number in range(-(-n_pictures // PER_FILE))]
        wanted = [(number, path) for number, path in enumerate(paths) if not path.exists()]
        for path in paths:
            if path.exists():
                self._arrived.put(path)
        self._n_left = len(paths)
        self._processes = ProcessPoolExecutor(  # spawned: threads of OpenCV and torch do not outlive a fork
            max(1, min(n_processes, len(wanted))), multiprocessing.get_context("spawn")
        )
        for number, path in wanted:
            future = self._processes.submit(_write_file, number, path, PER_FILE)
            future.add_done_callback(partial(self._take, path))

    def _take(self, path: Path, future: Future[None]) -> None:
        """Read what a process has made: on the thread that waits for it, beside the one that learns."""
        if future.cancelled():
            return
        try:
            future.result()
            self._arrived.put(read_pictures(path))
        except BaseException as error:
            self._arrived.put(error)

    def __enter__(self) -> Pool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._processes.shutdown(wait=True, cancel_futures=True)

    def arrived(self, least: int = 0, most_files: int = 4) -> list[SyntheticPicture]:
        """Pictures made since the last call, of a few files at most; waits for `least`, or until all are made.

        Raises
        ------
        Exception
            What a process that makes pictures has raised.
        """
        pictures: list[SyntheticPicture] = []
        n_files = 0
        while self._n_left and (n_files < most_files or len(pictures) < least):
            try:
                one = self._arrived.get(block=len(pictures) < least)
            except queue.Empty:
                break
            if isinstance(one, BaseException):
                raise one
            pictures += read_pictures(one) if isinstance(one, Path) else one
            self._n_left -= 1
            n_files += 1
        return pictures


def _write_file(number: int, path: Path, per_file: int) -> None:
    cv2.setNumThreads(1)
    pictures = [synthetic_picture(seed, SYNTHETIC_PX) for seed in range(number * per_file, (number + 1) * per_file)]
    corners = [picture.corners_px for picture in pictures]
    unfinished = path.with_suffix(".part.npz")
    np.savez(
        unfinished,
        images=np.stack([picture.image for picture in pictures]),
        indices=np.stack([picture.index for picture in pictures]),
        corners=np.concatenate(corners),
        counts=np.array([len(each) for each in corners]),
    )
    unfinished.replace(path)


def read_pictures(path: Path) -> list[SyntheticPicture]:
    """Pictures of a file of the pool."""
    with np.load(path) as file:
        images, indices, corners, counts = (file[name] for name in ("images", "indices", "corners", "counts"))
    parts = np.split(corners, np.cumsum(counts)[:-1])
    return [SyntheticPicture(*each) for each in zip(images, indices, parts, strict=True)]


# Photos and traced facades, gathered in one file.

QUALITY = 95
"""Of the JPEG that a photo is kept as."""


def write_gathered(sources: Sequence[Sequence[SyntheticPicture]], path: Path) -> None:
    """Write several lists of pictures of any size to one file, images as JPEG and numbers of panes as PNG."""
    stored: dict[str, NDArray[np.generic]] = {"counts": np.array([len(pictures) for pictures in sources])}
    number = 0
    for pictures in sources:
        for picture in pictures:
            image = cv2.imencode(".jpg", picture.image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
            stored |= {
                f"image-{number}": image,
                f"index-{number}": cv2.imencode(".png", picture.index)[1],
                f"corners-{number}": picture.corners_px,
            }
            number += 1
    unfinished = path.with_suffix(".part.npz")
    np.savez(unfinished, **stored)  # type: ignore[arg-type]
    unfinished.replace(path)


def read_gathered(path: Path) -> list[list[SyntheticPicture]]:
    """Lists of pictures from a file by `write_gathered`."""
    sources: list[list[SyntheticPicture]] = []
    number = 0
    with np.load(path) as file:
        for count in file["counts"]:
            pictures = []
            for _ in range(count):
                image = cv2.imdecode(file[f"image-{number}"], cv2.IMREAD_COLOR)
                index = cv2.imdecode(file[f"index-{number}"], cv2.IMREAD_UNCHANGED)
                pictures.append(SyntheticPicture(np.asarray(image), np.asarray(index), file[f"corners-{number}"]))
                number += 1
            sources.append(pictures)
    return sources
