"""Photos from the card: reading and checking thousands of them, and what a reduced scale saves and overlooks."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from planning.photos.folder import read_photos
from reconstruction.photos.decode import Scale, grey_picture
from reconstruction.photos.quality import DEFAULT_LIMITS, photo_quality
from tests.benchmarks.fresh_process import run_measured
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.reconstruction.photos.pictures import facade, moved, write

SCALES: tuple[Scale, ...] = (1, 2, 4, 8)

CHECK = """
import json, sys
from pathlib import Path
from planning.photos.folder import read_photos
from reconstruction.photos.quality import check_quality
report = check_quality(read_photos(Path(sys.argv[1])).photos)
print(json.dumps(sum(found is not None for found in report.photos)))
"""

BLURS_PX = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0)
MOVES_PX = (5, 9, 15)


def measure(context: Context) -> Iterator[Row]:
    """Many small photos, then few large ones at every scale."""
    n = 200 if context.is_quick else 2000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write_small(folder / "small", n)
        with timer() as reading:
            photos = read_photos(folder / "small").photos
        yield Row(f"{n} photos", "metadata read", reading(), "s")
        with timer() as plainly:
            for photo in photos:
                photo_quality(photo)
        yield Row(f"{n} photos of 0.3 MP", "checked one after the other", plainly(), "s")
        seconds, peak_mib = _checked_in_a_process(folder / "small", n)
        yield Row(
            f"{n} photos of 0.3 MP", "checked on all cores, from a fresh process", seconds, "s", seconds / plainly(),
            "one after the other",
        )  # fmt: skip
        yield Row(f"{n} photos of 0.3 MP", "peak memory", peak_mib, "MiB", target="under 1024 MiB", met=peak_mib < 1024)
        yield from _large(folder / "large", 2 if context.is_quick else 6)
    yield from _verdicts(context)


def _write_small(folder: Path, n: int) -> None:
    pictures = [facade(seed) for seed in range(20)]
    pictures += [moved(picture, 9) for picture in pictures[:5]]
    for index in range(n):
        write(folder / f"{index // 500}" / f"DJI_{index:04d}.jpg", np.roll(pictures[index % 25], 7 * index, axis=1))


def _checked_in_a_process(folder: Path, n: int) -> tuple[float, float]:
    """Wall time, s, and largest memory, MiB."""
    done = run_measured(["-c", CHECK, folder])
    if json.loads(done.printed) != n:
        raise RuntimeError(f"expected {n} photos checked, got {done.printed}")
    return done.seconds, done.peak_mib


def _large(folder: Path, n: int) -> Iterator[Row]:
    """Photos of 21 megapixels, one thread."""
    photos = [write(folder / f"{i}.jpg", np.tile(facade(i, (989, 1320)), (4, 4)), 92) for i in range(n)]
    seconds = {}
    for scale in SCALES:
        with timer() as decoding:
            for photo in photos:
                grey_picture(photo, scale)
        with timer() as whole:
            for photo in photos:
                photo_quality(photo, scale=scale)
        seconds[scale] = whole() / n
        what = f"decoded at 1/{scale}"
        yield Row("21 MP photo", what, decoding() / n, "s")
        yield Row("21 MP photo", f"{what} and measured", seconds[scale], "s", seconds[scale] / seconds[1], "1/1")


def _verdicts(context: Context) -> Iterator[Row]:
    """Real sharp photos, blurred by known amounts: which are taken for blurred at each scale."""
    names = ["multiview/lund_door/DSC_0001.JPG", "multiview/berlin/01.jpg", "multiview/berlin/02.jpg"]
    if not context.is_quick:
        names += ["multiview/lund_door/DSC_0006.JPG", "multiview/lund_door/DSC_0012.JPG", "multiview/berlin/03.jpg"]
    verdicts: dict[tuple[Scale, str], list[bool]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for path in map(context.data, names):
            sharp = np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE))
            cases = {f"{s:g} px": sharp if s == 0.0 else cv2.GaussianBlur(sharp, (0, 0), s) for s in BLURS_PX}
            cases |= {f"moved by {length} px": moved(sharp, length) for length in MOVES_PX}
            for case, picture in cases.items():
                photo = write(Path(folder) / "a.jpg", picture, 92)
                for scale in SCALES:
                    sigma_px = photo_quality(photo, scale=scale).sigma_px
                    is_blurred = sigma_px is not None and sigma_px > DEFAULT_LIMITS.sigma_px
                    verdicts.setdefault((scale, case), []).append(is_blurred)
    for scale in SCALES:
        text = ", ".join(f"{case} {sum(found)}" for (s, case), found in verdicts.items() if s == scale)
        changed = sum(a != b for (s, case), found in verdicts.items() if s == scale
                      for a, b in zip(found, verdicts[1, case], strict=True))  # fmt: skip
        n_all = sum(len(found) for (s, _), found in verdicts.items() if s == scale)
        what = f"at 1/{scale}: verdicts other than at 1/1"
        yield Row(f"{len(names)} real photos", what, float(changed), f"of {n_all}", against=f"called blurred: {text}")


BENCHMARK = Benchmark(
    "photos",
    "Photos from the card",
    "Reading the metadata of a folder and checking every photo for blur, exposure and likeness. Blur is measured in "
    "pixels of the full picture; a photo counts as blurred above 1.5 px. Photos that are decoded at a part of their "
    "size take less time, and hide what blur is smaller than a pixel there.",
    measure,
)
