"""Which model of light a scene calls for."""

from dataclasses import replace

import pytest
import torch

from planning.base.errors import OperationCancelled
from reconstruction.light.choose_light import Trials, choose_light, chosen
from reconstruction.light.config import GridSettings, ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.radiance_grid import RadianceGrid, box_around, box_of
from tests.reconstruction.light.made_folder import far, near, write_folder

CONFIG = ReflectionConfig(environment_rows=32, steps=100, batch=512)


@pytest.fixture(scope="module", params=[near, far], ids=["near", "far"])
def found(request, tmp_path_factory):
    """Rays of a scene, and what was chosen."""
    folder = tmp_path_factory.mktemp("chosen") / "photos"
    write_folder(folder, request.param, 20)
    source = read_photo_set(folder)
    rays = glass_rays(source, source.photos)
    return request.param, rays, source.panels, choose_light(rays, source.panels, CONFIG)


def test_near_things_call_for_a_radiance_grid_and_far_ones_for_an_environment_map(found):
    light, _, _, (name, (mirrors, is_near)) = found
    assert name == ("radiance-grid" if light is near else "environment-map")
    assert mirrors.on
    assert is_near.on == (light is near)
    assert "radiance grid" in str(is_near)
    assert is_near.unit == "dB"
    assert is_near.cost_s > 0.0


def test_the_choice_can_be_cancelled_and_one_photo_is_not_enough_for_one(found):
    _, rays, planes, _ = found

    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        choose_light(rays, planes, CONFIG, Cancelling())
    one = rays[torch.nonzero(rays.photos == 0).squeeze(1)]
    assert choose_light(one, planes, CONFIG) == ("environment-map", ())


@pytest.mark.slow
def test_kernels_that_are_compiled_first_do_not_count_for_the_trials(found, monkeypatch):
    _, rays, planes, (name, _) = found
    now_s = [0.0]
    march, is_compiled = RadianceGrid.forward, []

    def slow_at_first(grid, *args):
        now_s[0] += 0.0 if is_compiled else 20.0
        is_compiled.append(True)
        return march(grid, *args)

    monkeypatch.setattr(RadianceGrid, "forward", slow_at_first)
    limited = replace(CONFIG, time_limit_s=100.0)
    assert choose_light(rays, planes, limited, clock=lambda: now_s[0])[0] == name


@pytest.mark.parametrize(
    ("scores_db", "name"),
    [
        ((22.0, 24.0, 26.0), "radiance-grid"),
        ((22.0, 24.0, 24.2), "environment-map"),
        ((22.0, 24.0, 20.0), "environment-map"),
        ((30.0, 30.1, 30.2), "harmonics"),
        ((24.0, 20.0, 25.0), "radiance-grid"),
    ],
)
def test_the_cheaper_model_is_taken_where_the_other_is_no_better(scores_db, name):
    found, decisions = chosen(Trials(scores_db, 10.0))
    assert found == name
    assert all(decision.decided_by == "scene" for decision in decisions)


def test_the_box_holds_where_mirrored_rays_go_and_no_more_cells_than_are_allowed(found):
    _, rays, _, _ = found
    middle, table = rays.middle(), rays.table
    box = box_around(middle.points, middle.omega_r, table.normals[rays.panels], 2.0, 0.05, 0.5, 20_000)
    x, y, z = box.counts
    assert 10_000 < x * y * z < 26_000
    ends = middle.points + 1.8 * middle.omega_r
    inside = (box.turned(ends) - box.turned(torch.tensor([box.middle]))).abs() <= torch.tensor(box.halves)
    assert inside.float().mean(dim=0).min() > 0.9
    assert box.counts_at(1) == tuple(-(-n // 2) for n in box.counts)
    # Panels look south: that is where the box's own y axis points.
    assert torch.allclose(box.turned(torch.tensor([[0.0, -1.0, 0.0]])), torch.tensor([[0.0, 1.0, 0.0]]), atol=1e-6)
    assert box_of(rays, GridSettings(reach_m=30.0), len(rays)).reach == pytest.approx(30.0 / float(table.half_side_m))
    few, many = (box_of(rays, GridSettings(cell=0.01), n).counts for n in (10_000, 100_000))
    assert few[0] * few[1] * few[2] < 0.2 * many[0] * many[1] * many[2]
