"""Refining poses with pycolmap: time and errors against the scale of the photos."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from reconstruction.colmap.georeference import angle_between_deg
from reconstruction.colmap.refine import RefineParameters, refine_poses
from reconstruction.colmap.similarity import fit
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped, stopwatch
from tests.reconstruction.colmap.test_refine import SIGMA_DEG, SIGMA_M, start


def measure(context: Context) -> Iterator[Row]:
    """The 12 photos of Lund, 1296 x 1936 pixels; one unit of the reference model counts as a metre."""
    try:
        import pycolmap  # noqa: F401  (only whether it is there)
    except ImportError:
        raise Skipped("pycolmap is not installed (pip install .[colmap])") from None
    folder = context.data("multiview/lund_door")
    given, truth = start(folder, 12)
    before_deg = [
        angle_between_deg(a.pose.cam_from_enu, b.pose.cam_from_enu) for a, b in zip(given, truth, strict=True)
    ]
    scene = f"12 photos, positions to {100 * SIGMA_M:g} cm, angles to {SIGMA_DEG:g} degrees"
    yield Row(scene, "angle to the reference before", float(np.mean(before_deg)), "degrees")
    for size in (400,) if context.is_quick else (400, 600, 1000, 1936):
        with stopwatch() as seconds:
            found = refine_poses(given, folder, RefineParameters(max_image_size_px=size))
        pairs = list(zip(found.photos, truth, strict=True))
        ours, theirs = (
            np.array([photo.pose.position_enu_m for photo in column]) for column in zip(*pairs, strict=True)
        )
        aligned_m = np.linalg.norm(fit(ours, theirs)(ours) - theirs, axis=1)
        turns = [b.pose.cam_from_enu.T @ a.pose.cam_from_enu for a, b in pairs]
        among_deg = [angle_between_deg(turn, turns[len(turns) // 2]) for turn in turns]
        angles_deg = [angle_between_deg(a.pose.cam_from_enu, b.pose.cam_from_enu) for a, b in pairs]
        what = f"longer side {size} px"
        yield Row(scene, f"{what}: time", seconds(), "s")
        yield Row(scene, f"{what}: positions aligned to the reference, mean", 1e3 * float(aligned_m.mean()), "mm")
        yield Row(scene, f"{what}: positions aligned to the reference, worst", 1e3 * float(aligned_m.max()), "mm")
        yield Row(scene, f"{what}: angles among each other, worst", max(among_deg), "degrees")
        yield Row(
            scene,
            f"{what}: angle to the reference",
            float(np.mean(angles_deg)),
            "degrees",
            float(np.mean(angles_deg) / np.mean(before_deg)),
            "before",
        )
        points = f"{len(found.model.points)} points"
        yield Row(scene, f"{what}: image points off by", found.reprojection_px, "px", against=points)


BENCHMARK = Benchmark(
    "refined-poses",
    "Poses refined with pycolmap",
    "Positions and angles of the photos' own metadata, with known errors, against those after features were matched "
    "and all rays adjusted. The photos stand almost on one line, so that their positions hardly fix the turn about it; "
    "the angles of the photos do.",
    measure,
)
