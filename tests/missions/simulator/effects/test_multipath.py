"""Multipath: the sky near glass is what plane geometry says, and errors grow towards the facade."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missions.simulator.airframe.state import ExactReceiver
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.gnss import fix_of
from missions.simulator.effects.multipath import GlassSky, ReflectedReceiver, position_error_m, sphere
from planning.geo.frames import Origin
from planning.geo.mesh import empty_mesh
from planning.site.bundled import SCENES, panel_grid
from planning.site.records import Airspace, Site, SiteModel

FACTS = effect_facts()
MASK = math.sin(math.radians(FACTS.multipath.mask_deg))


def wall(width_m: float, height_m: float) -> SiteModel:
    """A wall of glass on the x axis that faces south, with nothing else."""
    half = width_m / 2.0
    facade = panel_grid("A", ((-half, 0.0, 0.0), (half, 0.0, 0.0), (-half, 0.0, height_m)), 2, 2)
    airspace = Airspace((-900.0, -900.0, 0.0), (900.0, 900.0, 900.0), ground_z_m=0.0)
    site = Site("wall", Origin(0.0, 0.0, 0.0), (facade,), airspace, (0.0, -50.0, 0.0))
    return SiteModel(site, empty_mesh())


def test_directions_are_spread_evenly() -> None:
    rays = sphere(2048)
    assert np.linalg.norm(rays, axis=1) == pytest.approx(np.ones(2048))
    assert np.abs(rays.mean(axis=0)).max() < 1e-3
    assert (rays.T @ rays / 2048) == pytest.approx(np.eye(3) / 3.0, abs=1e-3)


def test_an_endless_wall_hides_half_of_the_sky_and_mirrors_the_other_half() -> None:
    sky = GlassSky(wall(2e4, 2e4), FACTS.multipath).at((0.0, -2.0, 1e4))
    assert sky.hidden == pytest.approx(0.5, abs=0.01)
    assert sky.mirrored == pytest.approx(0.5, abs=0.01)
    # Every satellite that is seen is mirrored: the phase errs as the formula says, all of them.
    full = FACTS.multipath.wavelength_m / math.tau * math.asin(FACTS.multipath.amplitude) / math.sqrt(2.0)
    assert sky.phase_error_m == pytest.approx(full, rel=0.03)


def test_the_extra_way_is_twice_the_distance_times_the_cosine() -> None:
    """At 0.5 m, where no delay reaches half the correlator: the mean square of 2 d |d . n| over half the sky."""
    distance_m = 0.5
    sky = GlassSky(wall(2e4, 2e4), FACTS.multipath).at((0.0, -distance_m, 1e4))
    rays = sphere(20_000)
    to_south = rays[(rays[:, 2] > MASK) & (rays[:, 1] < 0.0)]
    extra_m = 2.0 * distance_m * -to_south[:, 1]
    expected = FACTS.multipath.amplitude * math.sqrt(float(np.mean(extra_m**2)) / 2.0)
    assert sky.code_error_m == pytest.approx(expected, rel=0.03)


def test_behind_the_wall_and_far_away_nothing_is_mirrored() -> None:
    counted = GlassSky(wall(40.0, 40.0), FACTS.multipath)
    assert counted.at((0.0, 10.0, 20.0)).mirrored == 0.0
    assert counted.at((0.0, -800.0, 1.0)).mirrored < 0.005


@pytest.mark.parametrize("scene", ["office", "canyon", "library"])
def test_errors_grow_towards_the_facade(scene: str) -> None:
    model = SCENES[scene]()
    counted = GlassSky(model, FACTS.multipath)
    corners = np.array(model.site.facades[0].panels[len(model.site.facades[0].panels) // 3].corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    normal /= np.linalg.norm(normal)
    shares, errors = [], []
    for away_m in (4.0, 8.0, 20.0, 60.0):
        x, y, z = corners.mean(axis=0) + away_m * normal
        sky = counted.at((x, y, z))
        shares.append(sky.mirrored)
        errors.append(position_error_m(sky, "rtk-fixed", FACTS.multipath, FACTS.receivers)[0])
    if scene == "canyon":  # 60 m away is behind the building across the street
        shares, errors = shares[:3], errors[:3]
    assert shares == sorted(shares, reverse=True)
    assert errors == sorted(errors, reverse=True)
    assert min(shares) >= 0.0
    assert max(shares) < 1.0


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (0.0, 0.0, 20.0), (0.0, 5.0, 20.0), (-18.0, 0.0, 42.0)])
def test_on_and_inside_the_building_numbers_stay_finite(place: tuple[float, float, float]) -> None:
    sky = GlassSky(SCENES["office"](), FACTS.multipath).at(place)
    error = position_error_m(sky, "single", FACTS.multipath, FACTS.receivers)
    assert all(map(math.isfinite, error))
    assert 0.0 <= sky.hidden <= 1.0


def test_the_receiver_says_how_it_is_and_nothing_jumps_on_the_way() -> None:
    counted = GlassSky(wall(60.0, 60.0), FACTS.multipath)
    inner = ExactReceiver(fix_of(FACTS.receivers["single"]))
    made = ReflectedReceiver(counted, "single", inner, gives_height=True, rng=np.random.default_rng(0))
    last, worst = np.zeros(3), 0.0
    satellites = []
    for i in range(2000):
        made.step(0.02, (0.0, -45.0 + 0.02 * i, 30.0), flies=True)
        now = np.array(made.offset_enu_m)
        worst = max(worst, float(np.abs(now - last).max())) if i else 0.0
        last = now
        satellites.append(made.fix.n_satellites)
    assert worst < 0.03
    assert satellites[-1] < satellites[0]
    assert made.fix.horizontal_accuracy_m > inner.fix.horizontal_accuracy_m
