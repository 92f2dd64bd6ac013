from __future__ import annotations

import math

from missions.mavlink.fence import fence_polygons
from missions.mission.build import missions_from_plan
from planning.geo.enu import enu_from_geodetic
from planning.site.records import NoFlyZone
from tests.missions.plans import HONG_KONG, example_plan


def square(name: str, x: float, y: float, half_m: float = 5.0) -> NoFlyZone:
    corners = ((x - half_m, y - half_m), (x + half_m, y - half_m), (x + half_m, y + half_m), (x - half_m, y + half_m))
    return NoFlyZone(name, corners, 0.0, 10.0)


def test_zone_beside_the_path_becomes_a_polygon_in_its_place() -> None:
    zone = square("road", 60.0, 60.0)
    polygons, findings = fence_polygons(missions_from_plan(example_plan())[0], (zone,))
    assert findings == ()
    (polygon,) = polygons
    local = enu_from_geodetic(HONG_KONG, [p[0] for p in polygon], [p[1] for p in polygon], HONG_KONG.ellipsoid_height_m)
    for corner, (x, y, _) in zip(zone.polygon_enu_m, local, strict=True):
        assert math.dist(corner, (x, y)) < 0.01


def test_zone_that_is_flown_over_is_left_out_and_said_because_fences_have_no_height() -> None:
    over, near = square("yard", 25.0, 0.0), square("kerb", 3.0 + 6.0, -41.0)
    polygons, findings = fence_polygons(missions_from_plan(example_plan())[0], (over, near, square("road", 60.0, 60.0)))
    assert len(polygons) == 1
    assert [(f.code, f.place) for f in findings] == [("zone-not-fenced", "yard"), ("zone-not-fenced", "kerb")]
