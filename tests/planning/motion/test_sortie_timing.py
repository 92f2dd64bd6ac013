"""Photos on the path of a sortie: each at its vertex, several at one, and how long that takes."""

from __future__ import annotations

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.geo.frames import Vec3
from planning.motion.timing import photo_vertices, sortie_flight_path, stopping_duration_s
from planning.parameters import FlightRules
from planning.plan import Sortie, Viewpoint

M3E = profile("m3e").aircraft
HOME, TOP, NEAR, FAR = (0.0, 0.0, 0.0), (0.0, 0.0, 20.0), (10.0, 0.0, 20.0), (30.0, 0.0, 20.0)


def sortie(path: list[Vec3], places: list[Vec3]) -> tuple[Sortie, dict[str, Viewpoint]]:
    views = {f"v{i}": Viewpoint(f"v{i}", place, 30.0 * i, -10.0) for i, place in enumerate(places)}
    return Sortie(tuple(views), tuple(path), 0.0, 0.0), views


@pytest.mark.parametrize(
    ("path", "places", "vertices"),
    [
        ([HOME, TOP, NEAR, FAR, TOP, HOME], [NEAR, FAR], [2, 3]),
        ([HOME, TOP, NEAR, NEAR, FAR, TOP, HOME], [NEAR, NEAR, FAR], [2, 3, 4]),
        ([HOME, TOP, NEAR, FAR, TOP, HOME], [NEAR, NEAR, FAR], [2, 2, 3]),
        ([HOME, TOP, NEAR, FAR, NEAR, TOP, HOME], [NEAR, FAR, NEAR], [2, 3, 4]),
        ([HOME, TOP, FAR, NEAR, TOP, HOME], [TOP, TOP], [1, 1]),
        ([HOME, TOP, FAR, NEAR], [FAR, NEAR, NEAR], [2, 3, 3]),
        ([HOME, TOP, HOME], [], []),
        ([HOME, TOP, FAR, NEAR, TOP, HOME], [NEAR, FAR], None),
        ([HOME, TOP, FAR, TOP, HOME], [NEAR], None),
    ],
)
def test_photos_are_found_on_the_path_in_order(
    path: list[Vec3], places: list[Vec3], vertices: list[int] | None
) -> None:
    found = photo_vertices(*sortie(path, places))
    assert (None if found is None else found.tolist()) == vertices


def test_photos_that_share_a_vertex_take_as_long_as_with_a_vertex_each() -> None:
    durations = []
    for path in ([HOME, TOP, NEAR, FAR, TOP, HOME], [HOME, TOP, NEAR, NEAR, NEAR, FAR, TOP, HOME]):
        timed = sortie_flight_path(*sortie(path, [NEAR, NEAR, NEAR, FAR]), M3E, FlightRules())
        assert timed is not None
        flown, vertices = timed
        assert vertices.tolist() == [2, 3, 4, 5]
        np.testing.assert_array_equal(flown.vertices_enu_m[2:5], [NEAR] * 3)
        durations.append(stopping_duration_s(flown, M3E, FlightRules()))
    assert durations[0] == durations[1]


def test_a_path_that_is_none_or_misses_a_photo_has_no_times() -> None:
    assert sortie_flight_path(*sortie([], []), M3E, FlightRules()) is None
    assert sortie_flight_path(*sortie([HOME, TOP, HOME], [NEAR]), M3E, FlightRules()) is None
