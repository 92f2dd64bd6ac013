"""Models as objects and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.site.records import Airspace, Facade, Panel, Site
from reconstruction.objects.organise import PanelGlobalIds, organised, put_together
from reconstruction.objects.store import read_scene, write_scene
from reconstruction.records.entries import is_global_id
from reconstruction.records.objects import site_objects
from reconstruction.training.config import config_of
from reconstruction.training.model.saved import description_of, tensors_of
from reconstruction.training.train import train_model
from tests.reconstruction.objects.conftest import CONFIG

HERE = Path("here")


@pytest.mark.slow
@pytest.mark.parametrize("method", ["reflight", "3dgs", pytest.param("ref-gs", marks=pytest.mark.slow)])
def test_a_model_that_went_through_objects_and_files_is_the_same_bits(data_set, trained, tmp_path, method):
    model = trained
    if method != "reflight":
        model = train_model(data_set, config_of({"method": method}, replace(CONFIG, light="auto"), HERE))
    scene = organised(model)
    assert all(element.stop > element.start for _, element in scene.elements)
    write_scene(scene, tmp_path / "scene")
    back = put_together(read_scene(tmp_path / "scene"), HERE)
    before, after = tensors_of(model), tensors_of(back)
    assert before.keys() == after.keys()
    assert all(torch.equal(before[name], after[name]) and before[name].dtype == after[name].dtype for name in before)
    assert description_of(back) == description_of(model)


def test_facades_have_four_layers_and_the_background_three(scene, trained):
    site = trained.record.site
    *facades, background = scene.components
    assert [component.name for component in facades] == list(
        dict.fromkeys(panel.facade or "facade" for panel in site.panels)
    )
    assert {element.name for _, element in scene.elements} == {panel.id for panel in site.panels}
    assert background.kind == "background"
    assert not background.elements
    assert scene.n_gaussians == len(trained.model.splats)


def test_each_panel_has_just_the_gaussians_that_lie_on_it(scene, trained):
    panels = trained.model.splats.panels.numpy()
    means = trained.model.splats.means.detach().numpy()
    for component, element in scene.elements:
        found = component.gaussians.part(element.start, element.stop)
        assert np.array_equal(np.sort(found.places), np.flatnonzero(panels == element.panel))
        assert np.array_equal(found.values["means"], means[found.places])
        assert scene.element(element.global_id) == (component, element)


def test_every_object_has_a_global_id_of_its_own_that_stays(scene, trained):
    ids = [scene.global_id, *(component.global_id for component in scene.components)]
    ids += [element.global_id for _, element in scene.elements]
    assert len(set(ids)) == len(ids)
    assert all(map(is_global_id, ids))
    again = organised(trained)
    assert [element.global_id for _, element in again.elements] == [e.global_id for _, e in scene.elements]


def test_the_building_model_s_global_ids_are_taken_where_they_are_good(trained):
    names = [panel.id for panel in trained.record.site.panels]
    given = {names[0]: "2O2Fr$t4X7Zf8NOew3FLOH", names[1]: "UUID_1234"}
    ids = PanelGlobalIds.of(trained.record, given)
    assert ids.panel(names[0]) == given[names[0]]
    assert is_global_id(ids.panel(names[1]))
    assert ids.panel(names[1]) == PanelGlobalIds.of(trained.record).panel(names[1])
    twice = PanelGlobalIds.of(trained.record, {names[0]: given[names[0]], names[1]: given[names[0]]})
    assert twice.panel(names[0]) != twice.panel(names[1])
    panels = tuple(replace(panel, source_id=given.get(panel.id)) for panel in trained.record.site.panels)
    told = replace(trained.record, site=replace(trained.record.site, panels=panels))
    assert PanelGlobalIds.of(told).panel(names[0]) == given[names[0]]


def test_what_has_no_name_or_one_twice_gets_one_of_its_own(trained):
    panels = tuple(
        replace(panel, id=("" if number else "A"), facade="") for number, panel in enumerate(trained.record.site.panels)
    )
    panels = (*panels[:-1], replace(panels[-1], id="A"))
    nameless = replace(
        trained, record=replace(trained.record, site=replace(trained.record.site, name="", panels=panels))
    )
    scene = organised(nameless)
    names = [element.name for _, element in scene.elements]
    assert len(set(names)) == len(names) == len(panels)
    assert all([scene.name, *(component.name for component in scene.components), *names])
    assert len({element.global_id for _, element in scene.elements}) == len(panels)


def test_global_ids_are_those_that_a_site_without_a_model_has(trained, tmp_path):
    panels = trained.record.site.panels
    facades = [
        Facade(name, tuple(Panel(each.id, each.corners_enu_m) for each in panels if each.facade == name))
        for name in dict.fromkeys(panel.facade for panel in panels)
    ]
    box = Airspace((-99.0, -99.0, 0.0), (99.0, 99.0, 60.0), 0.0)
    site = Site("here", Origin(48.0, 11.0, 500.0), tuple(facades), box, (0.0, -50.0, 0.0))
    named = replace(trained, record=replace(trained.record, site=replace(trained.record.site, name="here")))
    scene = organised(named)
    mine = {scene.global_id, *(each.global_id for each in scene.components[:-1])}
    mine |= {element.global_id for _, element in scene.elements}
    assert mine == {row.global_id for row in site_objects(site)}


def test_parts_of_scenes_that_do_not_belong_together_are_refused(scene, trained):
    facade, *others = scene.components
    table = replace(facade.gaussians, places=np.zeros_like(facade.gaussians.places))
    with pytest.raises(InputError, match="place of their own"):
        put_together(replace(scene, components=(replace(facade, gaussians=table), *others)), HERE)
    with pytest.raises(ValueError, match="all of its components"):
        put_together(replace(scene, components=tuple(others)), HERE)
    with pytest.raises(InputError, match="another model"):
        put_together(replace(scene, auxiliary=scene.auxiliary[:1]), HERE)
