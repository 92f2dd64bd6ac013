"""Real photos through the whole chain: poses refined, a coarse model of what they show, and the data set."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from planning.geo.mesh import write_mesh
from planning.photos.folder import read_photos
from planning.site.file import read_site
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import angle_between_deg
from reconstruction.colmap.refined_folder import read_refined
from reconstruction.photos.poses import pose_photos
from tests.reconstruction.real_photos import ORIGIN, coarse_building, reference_photos, write_flight

AT = f"--origin={ORIGIN.lat_deg},{ORIGIN.lon_deg},{ORIGIN.ellipsoid_height_m}"
LENS = Intrinsics(1296, 1936, 2484.0, 2484.0, 648.0, 968.0)
"""Straight, its focal length 2 % longer than that of the reference."""

PANEL = ((-0.11, 21.83, 1.67), (2.05, 21.79, 1.67), (-0.11, 21.83, 7.56))
"""The leaf of the door: lower left, lower right and upper left corner."""


@pytest.fixture(scope="module")
def flight(shared_data, tmp_path_factory):
    """The twelve photos of Lund with drone's poses, and the reference poses."""
    pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    folder = tmp_path_factory.mktemp("lund")
    truth = reference_photos(shared_data / "multiview" / "lund_door")
    write_flight(truth, folder / "photos", LENS)
    write_mesh(
        folder / "rough.ply", coarse_building(np.random.default_rng(0).uniform((-20, 19, 0), (20, 20, 25), (999, 3)))
    )
    return folder, truth


def outlines_px(prepared, photo):
    """Corners of the one panel in a picture of panel numbers: extremes along the picture's diagonals, shape (4, 2)."""
    index = cv2.imread(str(prepared / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
    rows, columns = np.nonzero(index)
    assert len(rows) > 10_000
    points = np.column_stack([columns, rows]) + 0.5
    return points[[np.argmin(points @ way) for way in ((1, -1), (-1, -1), (-1, 1), (1, 1))]]


def misses_px(prepared, truth, corners_enu_m, lens):
    """Distance of the panel's corners from where the reference poses have them, in each photo."""
    found = []
    for photo in truth:
        straight = PosedPhoto(photo.name, photo.path, lens, photo.pose)
        expected = straight.pixels(corners_enu_m)
        found.append(np.linalg.norm(outlines_px(prepared, photo) - expected, axis=1).max())
    return np.array(found)


@pytest.mark.slow
def test_real_photos_are_refined_modelled_and_prepared(flight, reflight):
    folder, truth = flight
    photos, refined = folder / "photos", folder / "photos.refined"
    rough = folder / "rough.site.json"
    assert reflight("site", "import", folder / "rough.ply", "-o", rough, AT, "--without-panels").status == 0
    done = reflight("photos", photos, rough, "--refine", "--refine-size", 400, "--scale", 8, "--json")
    assert done.status == 0, done
    assert (done.json["refined"]["photos"], done.json["refined"]["was_kept"]) == (12, False)
    assert done.json["refined"]["reprojection_px"] < 1.0
    assert "lens-distortion-unknown" not in done.json["findings"]

    stated = pose_photos(read_photos(photos).photos, read_site(rough).site, photos).photos
    better = read_refined(refined, stated).photos
    off = [
        [
            angle_between_deg(one.pose.cam_from_enu, true.pose.cam_from_enu)
            for one, true in zip(poses, truth, strict=True)
        ]
        for poses in (stated, better)
    ]
    assert np.median(off[1]) < 0.4 * np.median(off[0])

    points = read_model(refined).points
    write_mesh(folder / "coarse.ply", coarse_building(points.xyz[points.errors_px < 1.5]))
    none = reflight("panels", photos, folder / "coarse.ply", "-o", folder / "found.site.json", AT, "--refine")
    assert "no grid of panels was found" in none.error  # it is a portal of stone

    site = folder / "door.site.json"
    grid = " ".join(",".join(map(str, corner)) for corner in PANEL)
    drawn = reflight(
        "site",
        "import",
        folder / "coarse.ply",
        "-o",
        site,
        AT,
        f"--panel-grid={grid}",
        "--rows",
        1,
        "--columns",
        1,
        "--grid-tolerance=6",
    )
    assert drawn.status == 0, drawn
    for name, options in (("own", ()), ("refined", ("--refine",))):
        done = reflight(
            "prepare",
            photos,
            site,
            "-o",
            folder / name,
            *options,
            "--normal-step",
            16,
            "--points",
            0,
            "--hidden-panels=off",
        )
        assert done.status == 0, done
    corners = np.array(read_site(site).site.facades[0].panels[0].corners_enu_m)
    own = misses_px(folder / "own", truth, corners, LENS.straight())
    fine = misses_px(folder / "refined", truth, corners, better[0].intrinsics.straight())
    assert np.median(own) > 40.0  # two degrees of heading
    assert fine.max() < 15.0
    assert np.median(fine) < 10.0
