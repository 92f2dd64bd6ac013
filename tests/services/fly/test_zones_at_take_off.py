"""Before a take-off the geo-zones count that apply now, whatever time the plan was made for."""

from datetime import timedelta

import pytest

from groundstation.services.fly.sortie import prepare_sortie
from planning.base.errors import MissionError
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, polygon, square, with_zones
from tests.planning.test_zones_of_flights import NIGHT, NOON, flight


@pytest.mark.long
def test_a_zone_of_the_night_is_no_hindrance_at_noon_and_one_in_the_evening():
    content = ed269(ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 90.0))), applicability=NIGHT))
    model = with_zones(content)
    ready = prepare_sortie(flight(), model, 1, now=NOON)
    assert len(ready.case.space.no_fly.part) == 0
    with pytest.raises(MissionError, match="School: flights prohibited"):
        prepare_sortie(flight(), model, 1, now=NOON + timedelta(hours=7, minutes=10))
