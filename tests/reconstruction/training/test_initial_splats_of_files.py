"""Splats of a file to start from: in the right frame, and on the right panels."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.splats.initialise import InitialParameters, initial_splats
from reconstruction.splats.ply import write_splats
from reconstruction.splats.splats import NO_PANEL
from reconstruction.splats.surfels import known_scene, model_origin
from reconstruction.training.config import TrainConfig
from reconstruction.training.start import splats_of_file
from reconstruction.training.train import train_model

OTHER = np.array([30.0, -20.0, 4.0])
MEMORY = 1 << 28


@pytest.fixture
def known(data_set):
    source = read_photo_set(data_set)
    scene = known_scene(source)
    origin = model_origin(scene)
    return source, origin, initial_splats(scene, source.photos, origin, InitialParameters(n_splats=400))


def test_splats_of_another_frame_are_where_they_were(known, tmp_path):
    source, origin, splats = known
    with torch.no_grad():
        splats.means -= torch.from_numpy(OTHER).float()
    write_splats(tmp_path / "a.ply", splats, "2dgs", origin + OTHER)
    found = splats_of_file(tmp_path / "a.ply", source, source.photos, origin, MEMORY)
    there = splats.means.detach() + torch.from_numpy(OTHER).float()
    assert torch.allclose(found.means, there, atol=1e-5)
    assert torch.equal(found.sh, splats.sh)
    assert torch.equal(found.panels, splats.panels)


def test_photos_tell_the_panels_of_splats_that_do_not_say_them(known, tmp_path):
    source, origin, splats = known
    truth = splats.panels.clone()
    splats.panels.fill_(NO_PANEL)
    write_splats(tmp_path / "a.ply", splats, "2dgs", origin)
    found = splats_of_file(tmp_path / "a.ply", source, source.photos, origin, MEMORY).panels
    assert len(torch.unique(truth)) > 5
    # What lies on the edge of a pane may show more beside it.
    assert (found == truth).double().mean() > 0.9
    is_pane = (found >= 0) & (truth >= 0)
    assert torch.equal(found[is_pane], truth[is_pane])


def test_what_is_of_another_site_is_refused(known, tmp_path):
    source, origin, splats = known
    write_splats(tmp_path / "far.ply", splats, "2dgs", origin + 5000.0)
    with pytest.raises(InputError, match=r"far.ply: has no splat within 1000 m .* in one frame"):
        splats_of_file(tmp_path / "far.ply", source, source.photos, origin, MEMORY)
    splats.panels[3] = 9
    write_splats(tmp_path / "more.ply", splats, "2dgs", origin)
    with pytest.raises(InputError, match=r"more.ply: has splats on panel 10, and .* has 6 panels"):
        splats_of_file(tmp_path / "more.ply", source, source.photos, origin, MEMORY)


def test_a_training_goes_on_from_the_splats_of_another(data_set, tmp_path):
    light = ReflectionConfig(environment_rows=8, steps=4, batch=64)
    config = TrainConfig(
        method="2dgs", iterations=4, n_splats=300, max_splats=300, densification="none", score_every_s=1e9
    )
    first = train_model(data_set, config)
    write_splats(tmp_path / "a.ply", first.model.splats, "2dgs", first.record.origin_enu_m)
    again = train_model(data_set, replace(config, n_splats=20, iterations=1), splats_path=tmp_path / "a.ply")
    assert again.n_splats == first.n_splats > 200
    assert torch.allclose(again.model.splats.means, first.model.splats.means, atol=0.01)
    assert torch.allclose(again.model.splats.sh, first.model.splats.sh, atol=0.01)
    with_light = replace(config, method="refglass-gs", light="environment-map", reflections=light, iterations=1)
    mirrored = train_model(data_set, with_light, splats_path=tmp_path / "a.ply")
    assert (mirrored.model.splats.panels >= 0).double().mean() > 0.3
