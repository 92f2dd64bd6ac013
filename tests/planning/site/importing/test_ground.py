"""The ground of files that do not state it: scans, bare buildings, strays, cellars, slopes; and impossible sizes."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from groundstation.cli.main import main as run
from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh, box_mesh, from_corners, join
from planning.site.importing.ground import Ground, find_ground, place_on_ground
from planning.site.importing.importer import ImportedSite, import_site
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import place

Array = NDArray[np.float64]
HERE = Origin(48.7, 11.4, 450.0)


def box(x0: float, y0: float, z0: float, x1: float, y1: float, z1: float) -> TriangleMesh:
    return box_mesh(np.array([x0, y0, z0]), np.array([x1, y1, z1]))


def flat(east: Array, _north: Array) -> Array:
    return np.zeros_like(east)


def terrain(
    height: Callable[[Array, Array], Array] = flat, half_m: float = 40.0, noise_m: float = 0.03
) -> TriangleMesh:
    """Open ground in triangles of a metre, as a scan has it."""
    steps = np.arange(-half_m, half_m + 0.5)
    east, north = np.meshgrid(steps, steps, indexing="ij")
    up = height(east, north) + noise_m * np.random.default_rng(0).standard_normal(east.shape)
    n = len(steps)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = [np.stack([first, first + n, first + n + 1], axis=-1), np.stack([first, first + n + 1, first + 1], -1)]
    return TriangleMesh(np.stack([east, north, up], axis=-1).reshape(-1, 3), np.concatenate(triangles))


def triangles(*corners: list[list[float]]) -> TriangleMesh:
    return from_corners(np.array(corners, float))


HOUSE = box(-10, -6, 0, 10, 6, 15)
TREES = [box(x, y, 0.0, x + 3.0, y + 3.0, 8.0) for x, y in ((-30, 20), (15, -20), (25, 10), (-25, -28))]
CARS = [box(x, -9.0, 0.0, x + 4.5, -7.0, 1.5) for x in (-9.0, -3.0, 4.0)]
EAVES = triangles(
    [[-10.6, -6.6, 5.8], [10.6, -6.6, 5.8], [10.6, 0, 10]],
    [[-10.6, -6.6, 5.8], [10.6, 0, 10], [-10.6, 0, 10]],
    [[-10.6, 6.6, 5.8], [10.6, 0, 10], [10.6, 6.6, 5.8]],
    [[-10.6, 6.6, 5.8], [-10.6, 0, 10], [10.6, 0, 10]],
)
COURT = [box(-20, -20, 0, 20, -10, 12), box(-20, 10, 0, 20, 20, 12), box(-20, -10, 0, -10, 10, 12)]
COURT.append(box(10, -10, 0, 20, 10, 12))
POSTS = [box(x - 0.3, y - 0.3, 0, x + 0.3, y + 0.3, 4) for x in (-9, -3, 3, 9) for y in (-5, 0, 5)]

CLEAR = {
    "house alone": ([HOUSE], 0.0),
    "house with eaves": ([box(-10, -6, 0, 10, 6, 6), EAVES], 0.0),
    "cellar under all of it": ([box(-10, -6, -3, 10, 6, 15)], -3.0),
    "lift pit": ([HOUSE, box(-1, -1, -2, 1, 1, 0)], 0.0),
    "lift pit at the wall": ([HOUSE, box(-1, -6, -2, 1, -4, 0)], 0.0),
    "penthouse": ([box(-15, -10, 0, 15, 10, 12), box(-10, -6, 12, 10, 6, 16)], 0.0),
    "one facade": ([triangles([[0, 0, 1], [20, 0, 1], [20, 0, 12]], [[0, 0, 1], [20, 0, 12], [0, 0, 12]])], 1.0),
    "scan": ([HOUSE, terrain()], 0.0),
    "scan with trees and cars": ([HOUSE, terrain(), *TREES, *CARS], 0.0),
    "scan with cellar": ([box(-10, -6, -3, 10, 6, 15), terrain()], 0.0),
    "scan of a penthouse": ([box(-15, -10, 0, 15, 10, 12), box(-10, -6, 12, 10, 6, 16), terrain()], 0.0),
    "scan with a court on a deck": ([*COURT, box(-10, -10, 0, 10, 10, 4), terrain(half_m=60.0)], 0.0),
    "above a retaining wall": ([HOUSE, terrain(lambda x, y: np.where(y < -12, -3.0, 0.0), 50.0)], 0.0),
    "one plate of ground": ([HOUSE, box(-40, -40, 0, 40, 40, 0)], 0.0),
}


def ground_of(*parts: TriangleMesh) -> Ground:
    return find_ground(join(list(parts)).corners_enu_m)


@pytest.mark.long
@pytest.mark.parametrize("case", CLEAR)
def test_the_ground_is_where_anyone_would_see_it(case: str) -> None:
    parts, wanted = CLEAR[case]
    ground = ground_of(*parts)
    assert ground.is_known
    assert ground.other_m is None
    assert ground.z_m == pytest.approx(wanted, abs=0.06)


@pytest.mark.parametrize("slope", [0.05, 0.2])
def test_on_a_slope_the_highest_ground_along_the_building_counts(slope: float) -> None:
    ground = ground_of(box(-10, -6, -5, 10, 6, 15), terrain(lambda x, _: slope * x))
    assert 10.0 * slope <= ground.z_m <= 15.0 * slope + 0.06
    assert -15.0 * slope - 0.06 <= ground.lowest_m <= -10.0 * slope
    assert ground.highest_m == ground.z_m


def test_a_building_between_two_streets_stands_on_the_higher_one() -> None:
    ground = ground_of(box(-10, -6, -4, 10, 6, 15), terrain(lambda x, y: np.where(y < 0, -4.0, 0.0), 50.0))
    assert ground.lowest_m == pytest.approx(-4.0, abs=0.06)
    assert ground.z_m == pytest.approx(0.0, abs=0.06)


UNCLEAR = {
    "cellar under a half of it": ([box(-10, -6, -3, 0, 6, 15), box(0, -6, 0, 10, 6, 15)], (-3.0, 0.0)),
    "ground floor that stands back": ([box(-8, -4, 0, 8, 4, 4), box(-10, -6, 4, 10, 6, 15)], (0.0, 4.0)),
    "on posts": ([box(-10, -6, 4, 10, 6, 15), *POSTS], (0.0, 4.0)),
    "two blocks": ([HOUSE, box(30, 0, 2, 50, 12, 9)], (0.0, 2.0)),
    "podium": ([box(-25, -20, 0, 25, 20, 4), box(-8, -8, 4, 8, 8, 40)], (0.0, 4.0)),
    "podium on ground": ([box(-25, -20, 0, 25, 20, 4), box(-8, -8, 4, 8, 8, 40), terrain(half_m=60.0)], (0.0, 4.0)),
    "block of ground": ([HOUSE, box(-40, -40, -2, 40, 40, 0)], (-2.0, 0.0)),
}


@pytest.mark.parametrize("case", UNCLEAR)
def test_where_two_heights_may_be_the_ground_both_are_named(case: str) -> None:
    parts, wanted = UNCLEAR[case]
    ground = ground_of(*parts)
    assert ground.other_m is not None
    assert sorted((ground.z_m, ground.other_m)) == pytest.approx(wanted, abs=0.06)


@pytest.mark.parametrize(
    "parts",
    [
        [triangles([[0, 0, 8], [20, 0, 8], [20, 12, 8]], [[0, 0, 8], [20, 12, 8], [0, 12, 8]])],
        [HOUSE, box(-14, -10, 3.2, 14, 10, 3.2)],
    ],
    ids=["roof alone", "roof of a verandah"],
)
def test_what_shows_no_ground_is_not_guessed(parts: list[TriangleMesh]) -> None:
    assert not ground_of(*parts).is_known


# --- strays ---


def written(folder: Path, *parts: TriangleMesh, name: str = "scan.obj") -> Path:
    mesh = join(list(parts))
    trimesh.Trimesh(mesh.vertices_enu_m, mesh.triangles, process=False).export(folder / name)
    return folder / name


def imported(path: Path, **options: object) -> ImportedSite:
    return import_site(path, ImportOptions(origin=HERE, panels_required=False, **options))  # type: ignore[arg-type]


STRAY_TRIANGLES = st.lists(
    st.tuples(
        st.floats(-300.0, 300.0), st.floats(-300.0, 300.0), st.floats(-60.0, 14.0), st.integers(0, 2**31), st.booleans()
    ),
    min_size=1,
    max_size=12,
)


def strays(places: list[tuple[float, float, float, int, bool]], tied: Array) -> TriangleMesh:
    """Small triangles anywhere, and spikes from points of the mesh to a stray vertex."""
    made = []
    for x, y, z, seed, is_spike in places:
        rng = np.random.default_rng(seed)
        at = np.array([x, y, z])
        if is_spike:
            foot = tied[rng.integers(len(tied))]
            made.append([foot, foot + rng.uniform(-0.1, 0.1, 3), at])
        else:
            made.append([at, at + rng.uniform(-0.5, 0.5, 3), at + rng.uniform(-0.5, 0.5, 3)])
    return from_corners(np.array(made))


@pytest.mark.slow
@pytest.mark.parametrize("case", ["house alone", "scan", "lift pit"])
@given(places=STRAY_TRIANGLES)
def test_strays_anywhere_do_not_move_the_ground(case: str, places: list[tuple[float, float, float, int, bool]]) -> None:
    parts, wanted = CLEAR[case]
    mesh = join(list(parts))
    mesh = join([mesh, strays(places, mesh.vertices_enu_m)])
    options = ImportOptions(origin=HERE)
    stands = place_on_ground(
        mesh.vertices_enu_m, mesh.triangles, None, lambda points, z: place(None, points, z, options)
    )
    assert stands.question == ""
    assert stands.placement.ground_z_m == pytest.approx(wanted, abs=0.06)


def test_a_stray_point_below_the_ground_puts_no_view_under_it_and_is_told(tmp_path: Path) -> None:
    stray = triangles([[3, 2, -6], [3.2, 2, -6], [3, 2.2, -6]])
    site = imported(written(tmp_path, HOUSE, stray))
    assert site.model.site.airspace.ground_z_m == pytest.approx(0.0, abs=1e-3)
    assert site.model.site.airspace.min_enu_m[2] == pytest.approx(2.0, abs=1e-3)
    assert len(site.model.building.triangles) == 12
    told = next(note for note in site.notes if note.startswith("left out as strays"))
    assert "1 triangles, from -6.00 to -6.00" in told


def test_a_vertex_far_away_does_not_widen_the_airspace(tmp_path: Path) -> None:
    site = imported(written(tmp_path, HOUSE, triangles([[0, 0, 1], [1, 0, 1], [3e7, 0, 1]])))
    assert site.model.site.airspace.max_enu_m[0] == pytest.approx(50.0, abs=0.01)
    assert any(note.startswith("left out as strays") for note in site.notes)


def test_small_things_within_the_airspace_stay_obstacles(tmp_path: Path) -> None:
    sign = box(20.0, -10.0, 3.0, 20.5, -9.9, 4.0)
    site = imported(written(tmp_path, HOUSE, sign))
    assert len(site.model.building.triangles) == 24
    assert not any("strays" in note for note in site.notes)


# --- what is told, and asked ---


def main(arguments: list[str]) -> int:
    return run(arguments, open_window=lambda _: 0)


@pytest.mark.slow
def test_home_stands_on_the_ground_where_it_is(tmp_path: Path) -> None:
    slope = terrain(lambda x, y: 0.1 * y, half_m=60.0, noise_m=0.0)
    site = imported(written(tmp_path, box(-10, -6, -3, 10, 6, 15), slope))
    _, north, up = site.model.site.home_enu_m
    assert abs(north) < 55.0
    assert up == pytest.approx(0.1 * north, abs=0.1)
    assert site.model.site.airspace.ground_z_m > up + 1.0
    assert any("the highest is taken" in note for note in site.notes)


def test_the_command_asks_and_takes_either_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, *UNCLEAR["cellar under a half of it"][0])
    command = ["site", "import", str(path), "-o", str(tmp_path / "s.json"), "--origin", "48,11,400", "--without-panels"]
    assert main(command) == 1
    said = capsys.readouterr().err
    assert not (tmp_path / "s.json").exists()
    answers = re.findall(r"--ground (-?\d+\.\d+)", said)
    assert answers == ["-3.00", "0.00"]
    for answer in answers:
        assert main([*command, "--ground", answer]) == 0


def test_answers_are_in_the_heights_of_the_file(tmp_path: Path) -> None:
    parts, answers = UNCLEAR["cellar under a half of it"]
    shift = np.array([691_000.0, 5_335_000.0, 500.0])
    mesh = join([TriangleMesh(part.vertices_enu_m + shift, part.triangles) for part in parts])
    path = tmp_path / "utm.obj"
    rows = [f"v {x:.3f} {y:.3f} {z:.3f}" for x, y, z in mesh.vertices_enu_m]
    rows += ["f {} {} {}".format(*(row + 1)) for row in mesh.triangles]
    path.write_text("\n".join(rows))
    options = ImportOptions(crs="EPSG:32632", panels_required=False)
    with pytest.raises(InputError, match=r"--ground 497\.00 or --ground 500\.00"):
        import_site(path, options)
    site = import_site(path, ImportOptions(crs="EPSG:32632", panels_required=False, ground_z=497.0))
    assert site.model.building.vertices_enu_m[:, 2].min() == pytest.approx(0.0, abs=1e-3)
    assert answers == (-3.0, 0.0)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("scale", "unit", "said"),
    [
        (1000.0, "m", r"at most 5 km are expected; .*--units cm makes it .* and .*--units mm makes it 20 x 12 x 15 m"),
        (100.0, "m", r"2000 x 1200 x 1500 m, implausibly large .*--units cm makes it 20 x 12 x 15 m \(factor 0\.01\)"),
        (
            1.0,
            "mm",
            r"0\.02 x 0\.012 x 0\.015 m, implausibly small .*--units m makes it 20 x 12 x 15 m \(factor 1000\)",
        ),
        (0.001, "m", r"implausibly small for a building: no unit makes it plausible"),
    ],
)
def test_a_size_that_no_building_has_is_told_with_the_unit_that_mends_it(
    tmp_path: Path, scale: float, unit: str, said: str
) -> None:
    path = written(tmp_path, TriangleMesh(HOUSE.vertices_enu_m * scale, HOUSE.triangles))
    try:
        told = "\n".join(imported(path, unit=unit).notes)
    except InputError as error:
        told = str(error)
    assert re.search(said, told), told


def test_a_size_that_a_building_has_is_not_mentioned(tmp_path: Path) -> None:
    assert not any("implausibly" in note for note in imported(written(tmp_path, HOUSE)).notes)


# --- real points from the air: roofs, some walls, no ground ---


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["city3d_9", "city3d_12", "city3d_57", "city3d_94"])
def test_scans_from_the_air_without_ground_are_asked_about(shared_data: Path, tmp_path: Path, name: str) -> None:
    from scipy.spatial import Delaunay

    cloud = trimesh.load(shared_data / "buildings" / "pointclouds" / f"{name}.ply", process=False)
    points = np.asarray(cloud.vertices, float)
    corners = points[Delaunay(points[:, :2]).simplices]
    sides = np.linalg.norm(np.diff(corners[:, [0, 1, 2, 0], :2], axis=1), axis=2)
    path = written(tmp_path, from_corners(corners[sides.max(axis=1) < 4.0]))
    with pytest.raises(InputError, match=r"--ground"):
        imported(path)
