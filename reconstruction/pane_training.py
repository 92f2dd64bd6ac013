r"""Training the network for panes.

    python -m reconstruction.pane_training --pool POOL --glass FOLDER --offices FOLDER --gathered FILE --minutes 120 \
        --out reconstruction/panels/network/data/panes.safetensors

It learns from pictures made by chance, which POOL keeps, from traced facades, and from every second photo of two sets
whose licence allows it; the other photos are left to measure with. FILE keeps facades and photos: where it is there
already, the folders are not needed. docs/concepts/segmentation.md has its data card.

    python -m reconstruction.pane_training --pool POOL --gathered FILE --leave-out 0 --out WITHOUT-0
    python -m reconstruction.pane_training --glass FOLDER --offices FOLDER --without WITHOUT-0 WITHOUT-1 WITHOUT-2 \
        --confidence reconstruction/panels/network/data/confidence.json

A network is surer of photos that it learned from than of others. So how probable panes are is fitted to pictures made
by chance that it did not learn from, and to photos that are looked at by networks that learned from the other two
thirds of them: those come first. What speaks against panes is fitted to half of the photos that the network did not
learn from; without --without only that is fitted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.files import read_input_file
from reconstruction.base.tensor_files import TENSORS_FILE
from reconstruction.metrics.sets import PhotoSet, ScoredPhoto, annotated_set, folder_set, synthetic_set
from reconstruction.panels.network.calibration import Source, calibrated, calibrated_last, write_regressions
from reconstruction.panels.network.confidence import regressions
from reconstruction.panels.network.crops import CropSampler
from reconstruction.panels.network.network import LARGE, SMALL, PaneNetwork, network_of
from reconstruction.panels.network.pool import PER_FILE, SYNTHETIC_PX, Pool, read_gathered, write_gathered
from reconstruction.panels.network.random_pictures import SyntheticPicture, synthetic_picture
from reconstruction.panels.network.training import FIRST_PICTURES, SOURCES, NetworkToTrain, train
from reconstruction.panels.search.cells import from_lower_left
from reconstruction.scenes.facades.cases import wide_camera

FIRST_SEED = 100_000
"""Of traced facades that are learned from: no test and no benchmark uses seeds from here on."""

EVERY_SECOND = 2

FOLDS = 3
"""Parts of the photos of each set, each left out by one of the networks that confidences are fitted with."""


def traced_facades(n_seeds: int) -> list[SyntheticPicture]:
    """Facades of the program's own scenes."""
    sets = (synthetic_set(name, n_seeds, wide_camera(640, 480), first_seed=FIRST_SEED) for name in KINDS)
    return list(chain.from_iterable(_learned(photos) for photos in sets))


KINDS = ("made-planar", "made-curved")


def _learned(photos: PhotoSet, every: int = 1) -> Iterator[SyntheticPicture]:
    for photo in islice(photos.photos(), 0, None, every):
        yield training_photo(photo.image, photo.index)


LONGEST_PX = 1280
"""Size of a photo that is learned from."""


def training_photo(
    photo: NDArray[np.uint8],
    truth: NDArray[np.uint16],
    longest_px: int = LONGEST_PX,
) -> SyntheticPicture:
    """A photo, shape (h, w, 3), and its panes' numbers, shape (h, w), as a picture of that size to learn from.

    Corners of panes that its border cuts are not known.
    """
    scale = min(1.0, longest_px / max(truth.shape))
    size = round(truth.shape[1] * scale), round(truth.shape[0] * scale)
    image = np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_AREA), np.uint8)
    index = np.asarray(cv2.resize(truth, size, interpolation=cv2.INTER_NEAREST_EXACT), np.uint16)
    corners = np.full((int(index.max(initial=0)), 4, 2), np.nan, np.float32)
    for number in range(1, len(corners) + 1):
        corners[number - 1] = _corners(index == number)
    return SyntheticPicture(image, index, corners)


def _corners(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Corners of an area, shape (4, 2), NaN where it touches the picture's border or is no quadrilateral."""
    unknown = np.full((4, 2), np.nan, np.float32)
    rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
    if len(rows) < 3 or len(columns) < 3:
        return unknown
    if rows[0] == 0 or columns[0] == 0 or rows[-1] == mask.shape[0] - 1 or columns[-1] == mask.shape[1] - 1:
        return unknown
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    outline = max(outlines, key=cv2.contourArea)
    quad = cv2.approxPolyN(cv2.convexHull(outline), 4).reshape(-1, 2).astype(np.float32)
    if len(quad) != 4 or cv2.contourArea(quad) > 1.25 * max(cv2.contourArea(outline), 1.0):
        return unknown
    off = quad - quad.mean(axis=0)
    # Counter-clockwise as seen, y downwards.
    ordered = quad[np.argsort(-np.arctan2(off[:, 1], off[:, 0]))].astype(float)
    return np.asarray(from_lower_left(ordered + 0.5, np.array([0.0, -1.0])), np.float32)


CALIBRATED_PX, LAST_PX = (512,), (768, 512)
"""Sizes, in turn, of pictures made by chance that confidences are fitted to, and the last of their regressions."""

N_CALIBRATED = 150, 8
"""How many of them, and traced facades of each kind."""

N_LEARNED_AT_MOST = 1000
"""Pictures by chance beyond so many times `PER_FILE`, and traced facades beyond so many, were not learned from."""

WEIGHTS, LAST_WEIGHTS = (0.3, 0.6, 0.5, 2.0), (1.0, 1.0, 0.3, 1.0)
"""What glass, offices, traced facades and pictures by chance count in the confidences, and in the last regression."""


def calibrate(glass: PhotoSet, offices: PhotoSet, without: Sequence[PaneNetwork], out: Path) -> None:
    """Fit confidences to panes that the network with its present weights finds, and write them.

    Photos are looked at by those of `FOLDS` networks that have not learned from them; where these are not given, the
    first two regressions stay as they are. The last is fitted to photos that no network has learned from.
    """
    first, second, _ = regressions()
    if without:
        learned = [islice(each.photos(), 0, None, EVERY_SECOND) for each in (glass, offices)]
        first, second = calibrated(_sources_to_fit(learned, CALIBRATED_PX, WEIGHTS, without), _tell)
    others = [islice(each.photos(), 1, None, 2 * EVERY_SECOND) for each in (glass, offices)]
    last = calibrated_last(_sources_to_fit(others, LAST_PX, LAST_WEIGHTS), first, second, _tell)
    write_regressions((first, second, last), out)


def _sources_to_fit(
    sets: Sequence[Iterable[ScoredPhoto]],
    sizes_px: Sequence[int],
    weights: Sequence[float],
    looking: Sequence[PaneNetwork] = (),
) -> list[Source]:
    """Photos of both sets, looked at by these networks; traced facades; pictures by chance of sizes in turn."""
    n_made, n_traced = N_CALIBRATED
    seed = FIRST_SEED + N_LEARNED_AT_MOST
    facades = [synthetic_set(name, n_traced, wide_camera(1200, 900), first_seed=seed) for name in KINDS]
    synthetic = (
        synthetic_picture(PER_FILE * N_LEARNED_AT_MOST + number, sizes_px[number % len(sizes_px)])
        for number in range(n_made)
    )
    pictures = (
        *([(photo.image, photo.index) for photo in photos] for photos in sets),
        ((photo.image, photo.index) for photos in facades for photo in photos.photos()),
        ((picture.image, picture.index) for picture in synthetic),
    )
    return [Source(*each) for each in zip(pictures, weights, (looking, looking, (), ()), strict=True)]


def main() -> None:
    """Read the arguments, make what is missing, learn."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--out", type=Path, help="learn, and write the weights to this file")
    wanted.add_argument("--confidence", type=Path, help="fit confidences to the weights that are there; their file")
    parser.add_argument("--pool", type=Path, help="folder that synthetic pictures are kept in")
    parser.add_argument("--pictures", type=int, default=3000, help="how many of them")
    parser.add_argument("--processes", type=int, default=2, help="that make them side by side")
    parser.add_argument("--gathered", type=Path, help="file that keeps traced facades and photos")
    parser.add_argument("--traced", type=int, default=40, help="traced facades of each kind")
    parser.add_argument("--glass", type=Path, help="folder with photos/ and truth/ of a curtain wall")
    parser.add_argument("--offices", type=Path, help="folder of the set of offices at night")
    parser.add_argument("--minutes", type=float, default=120.0, help="how long to learn")
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu", help="one core, or a graphics card")
    parser.add_argument("--large", action="store_true", help="train the larger network, which takes twice as long")
    parser.add_argument("--start", type=Path, help="weights to go on from")
    parser.add_argument("--leave-out", type=int, choices=range(FOLDS), help="part of the photos not to learn from")
    parser.add_argument("--without", type=Path, nargs=FOLDS, help="weights of networks that left out each part")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if options.confidence is not None:
        if options.glass is None or options.offices is None:
            parser.error("--confidence needs --glass and --offices")
        glass = folder_set(options.glass / "photos", options.glass / "truth")
        without = [network_of(read_input_file(path, TENSORS_FILE)) for path in options.without or ()]
        calibrate(glass, annotated_set("offices", options.offices), without, options.confidence)
        return
    if options.pool is None or options.gathered is None:
        parser.error("--out needs --pool and --gathered")
    with Pool(options.pool, options.pictures, options.processes) as pool:
        if not options.gathered.exists():
            write_gathered(_sources(options), options.gathered)
        bank = CropSampler(options.device, SOURCES, options.pictures * SYNTHETIC_PX**2)
        traced, *photos = read_gathered(options.gathered)
        bank.add(traced, 1)
        for photos_of_set in photos:
            bank.add([photo for i, photo in enumerate(photos_of_set) if i % FOLDS != options.leave_out], 2)
        _tell(f"{len(bank)} traced facades and photos")
        bank.add(pool.arrived(least=FIRST_PICTURES), 0)
        network = NetworkToTrain(options.out, LARGE if options.large else SMALL, options.start)
        train(bank, options.minutes, [network], options.seed, pool.arrived, _tell)


def _sources(options: argparse.Namespace) -> list[list[SyntheticPicture]]:
    """Traced facades, photos of glass, photos of offices."""
    gathered = [traced_facades(options.traced)]
    if options.glass is not None:
        gathered.append(list(_learned(folder_set(options.glass / "photos", options.glass / "truth"), EVERY_SECOND)))
    if options.offices is not None:
        gathered.append(list(_learned(annotated_set("offices", options.offices), EVERY_SECOND)))
    return gathered


def _tell(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
