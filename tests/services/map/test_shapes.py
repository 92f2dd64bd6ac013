"""Sites and plans from above: footprints of the right size, panels once, lengths for bars that are round."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.map.shapes import plan_shapes, round_length, site_shapes
from groundstation.services.map.web_mercator import metres_per_point, world_from_enu
from groundstation.services.project.document import Item, ItemKind
from planning.site.bundled import ORIGIN, tower
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk


def area_m2(rings):
    per_unit = 256.0 * metres_per_point(ORIGIN.lat_deg, 0.0)
    total = 0.0
    for ring in rings:
        x, y = (ring * per_unit).T
        total += abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0
    return total


def test_footprints_cover_what_stands_there():
    shapes = site_shapes(kiosk())
    building, tree = shapes.solids
    assert building.item == Item(ItemKind.BUILDING)
    assert tree.item == Item(ItemKind.OBSTACLE, "tree")
    # A map's metres from south to north are up to 0.7 % longer than true ones.
    assert area_m2(building.rings) == pytest.approx(12.0 * 8.0, rel=0.008)
    assert area_m2(tree.rings) == pytest.approx(9.0, rel=0.02)
    assert area_m2(shapes.airspace.rings) == pytest.approx(6400.0, rel=0.008)


def test_panels_above_one_another_are_drawn_once():
    model = tower()
    shapes = site_shapes(model)
    assert sum(len(panels) for _, panels in shapes.facades) < model.site.n_panels / 10
    assert [item.id for item, _ in shapes.facades] == [facade.id for facade in model.site.facades]


def test_plan_is_where_its_points_are():
    plan = example_plan()
    shapes = plan_shapes(plan, ORIGIN)
    assert shapes.viewpoint_ids[3] == "v0003"
    assert shapes.viewpoints[3] == pytest.approx(world_from_enu(ORIGIN, [plan.viewpoints[3].position_enu_m])[0])
    assert shapes.sortie_of.tolist() == [1] * 6 + [2] * 4
    assert [len(route) for route in shapes.routes] == [len(sortie.path_enu_m) for sortie in plan.sorties]


@given(st.floats(1e-6, 1e9))
def test_round_lengths_are_the_largest_that_fit(longest):
    length = round_length(longest)
    assert longest / 2.5 <= length * (1.0 + 1e-9)
    assert length <= longest * (1.0 + 1e-9)
    mantissa = length / 10.0 ** np.floor(np.log10(length) + 1e-9)
    assert min(abs(mantissa - step) for step in (1.0, 2.0, 5.0)) < 1e-6
