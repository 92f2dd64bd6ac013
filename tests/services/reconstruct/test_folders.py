"""Folders of data sets and models: what stands there, which are meant, and what is said of damaged ones."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.reconstruct.choices import (
    USUAL_MEMORY_BYTES,
    Machine,
    TrainChoice,
    forecast,
    method_rows,
    preset_for,
    preset_rows,
    this_machine,
)
from groundstation.services.reconstruct.folders import (
    CHECKPOINT,
    DATA_SET,
    MODEL,
    NOTE,
    Standing,
    models_beside,
    note_training,
    noted_data_set,
    noted_training,
    proposed_folder,
    read_data_set,
    read_model_card,
    standing,
    usual_data_set,
)
from planning.base.errors import InputError
from reconstruction.training.parameters import TrainRequest
from tests.reconstruction.training.synthetic_data_set import write_data_set


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("places") / "glass.photos"
    write_data_set(folder, n=4)
    return folder


@pytest.fixture(scope="module")
def card(data):
    return read_data_set(data)


def write_model(folder, card, **changes):
    folder.mkdir(parents=True)
    panels = [{"id": "p", "facade": "f", "corners_enu_m": each} for each in card.source.panels.corners_enu_m.tolist()]
    content = {
        "format": "reflight-model/1",
        "method": "2dgs",
        "n_splats": 12,
        "site": {"name": "s", "origin": None, "panels": panels},
        "held_out": ["a"],
        "history": [{"t_s": 1.0, "value": 20.0}],
        "more": {"than": "is asked"},
    }
    (folder / MODEL).write_text(json.dumps(content | changes))


def test_a_data_set_says_what_it_is(card):
    assert (len(card.source.photos), card.largest_px) == (4, 40 * 30)
    assert card.normal_step == 2


def test_a_folder_that_is_none_is_refused_in_words(tmp_path):
    with pytest.raises(InputError, match=r"has no dataset.json; name a folder"):
        read_data_set(tmp_path)


def test_what_stands_in_a_folder_is_told(tmp_path):
    out = tmp_path / "new" / "model"
    assert standing(out) == Standing(free_bytes=standing(tmp_path).free_bytes)
    assert standing(out).free_bytes > 0
    out.mkdir(parents=True)
    (out / NOTE).write_text("{}")
    assert not standing(out).is_foreign
    (out / "letter.txt").write_text("dear")
    assert standing(out).is_foreign
    (out / MODEL).write_text("{}")
    found = standing(out)
    assert (found.is_foreign, found.has_model, found.is_interrupted) == (False, True, False)
    (out / CHECKPOINT).write_text("")
    assert standing(out).is_interrupted


def test_a_training_is_noted_with_its_data_set_which_may_move_with_it(tmp_path, data):
    project = tmp_path / "project"
    there = project / "glass.photos"
    there.mkdir(parents=True)
    (there / DATA_SET).write_text("{}")
    out = project / "models" / "one"
    note_training(out, there, TrainRequest("1h", "2dgs", time_limit_s=90.0))
    note = noted_training(out)
    assert (note.preset, note.method, note.light, note.time_limit_s) == ("1h", "2dgs", None, 90.0)
    project.rename(tmp_path / "moved")
    assert noted_data_set(tmp_path / "moved" / "models" / "one") == tmp_path / "moved" / "glass.photos"


@pytest.mark.parametrize("content", [None, "", "{", '{"format": "other/1"}', '{"format": "reflight-training/1"}'])
def test_a_note_that_is_none_is_no_note(tmp_path, content):
    if content is not None:
        (tmp_path / NOTE).write_text(content)
    assert noted_training(tmp_path) is None
    assert noted_data_set(tmp_path) is None


def test_a_folder_that_cannot_be_made_is_told(tmp_path, data):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        note_training(tmp_path / "file" / "model", data, TrainRequest())


def test_models_go_among_those_of_the_project_where_nothing_stands(tmp_path, data):
    assert proposed_folder(data, "2dgs", None) == data.parent / "glass.2dgs.model"
    first = proposed_folder(data, "2dgs", tmp_path)
    assert first == tmp_path / "models" / "glass-2dgs"
    first.mkdir(parents=True)
    assert proposed_folder(data, "2dgs", tmp_path) == first
    (first / MODEL).write_text("{}")
    assert proposed_folder(data, "2dgs", tmp_path) == tmp_path / "models" / "glass-2dgs-2"


def test_the_usual_data_set_is_that_of_the_last_training_else_the_newest(tmp_path, data):
    assert usual_data_set(None) is None
    assert usual_data_set(tmp_path) is None
    for number, name in enumerate(("old", "new")):
        (tmp_path / name).mkdir()
        (tmp_path / name / DATA_SET).write_text("{}")
        os.utime(tmp_path / name / DATA_SET, (1000 + number, 1000 + number))
    assert usual_data_set(tmp_path) == tmp_path / "new"
    note_training(tmp_path / "models" / "m", tmp_path / "old", TrainRequest())
    assert usual_data_set(tmp_path) == tmp_path / "old"


def test_models_of_the_same_panels_are_offered_and_others_are_not(tmp_path, card):
    out = tmp_path / "models" / "next"
    assert models_beside(out, card) == ()
    write_model(tmp_path / "models" / "one", card)
    write_model(tmp_path / "models" / "damaged", card, history="none")
    moved = (card.source.panels.corners_enu_m + 1.0).tolist()
    panels = [{"id": "p", "facade": "f", "corners_enu_m": each} for each in moved]
    write_model(tmp_path / "models" / "elsewhere", card, site={"name": "s", "origin": None, "panels": panels})
    (found,) = models_beside(out, card)
    assert (found.folder.name, found.method, found.light, found.n_splats) == ("one", "2dgs", "", 12)
    assert found.history[0].value == 20.0
    with pytest.raises(InputError, match="history"):
        read_model_card(tmp_path / "models" / "damaged")
    with pytest.raises(InputError, match="no finished model"):
        read_model_card(Path("nowhere"))


def test_methods_and_presets_have_rows(card):
    rows = method_rows()
    assert rows[0].name == TrainChoice().method
    assert len({row.name for row in rows}) == len(rows)
    assert all(row.title and row.what for row in rows)
    assert list(preset_rows()) == ["10min", "1h", "overnight"]


@pytest.mark.parametrize(
    ("minutes", "name"), [(1, "10min"), (20, "10min"), (30, "1h"), (120, "1h"), (300, "overnight")]
)
def test_an_own_time_has_the_settings_of_the_preset_that_is_nearest(minutes, name):
    assert preset_for(minutes) == name
    request = TrainChoice(minutes=float(minutes)).request()
    assert (request.preset, request.time_limit_s) == (name, 60.0 * minutes)


def test_light_is_wished_only_of_methods_that_know_panels():
    assert TrainChoice(light="mlp").request().light == "mlp"
    assert TrainChoice(method="2dgs", light="mlp").request().light is None
    assert TrainChoice(light="auto").request().light is None


def test_memory_is_told_and_taken_from_what_is_free(card):
    plenty = forecast(card, Machine(4, 1 << 40, 1 << 40), TrainChoice())
    assert plenty.limit_bytes == USUAL_MEMORY_BYTES
    assert plenty.photos_bytes == 4 * (6 * 1200 + 6 * 20 * 15)
    assert plenty.all_fit
    assert not plenty.is_reduced
    short = forecast(card, Machine(1, 1 << 30, 400 << 20), TrainChoice())
    assert short.limit_bytes == 100 << 20
    assert short.is_reduced
    # However little is free, one photo must have room.
    least = forecast(card, Machine(1, 1 << 30, 0), TrainChoice("2dgs"))
    assert least.limit_bytes * 0.75 >= least.least_bytes
    unknown = forecast(card, Machine(1, None, None), TrainChoice())
    assert unknown.limit_bytes == USUAL_MEMORY_BYTES


@pytest.mark.parametrize(("minutes", "reduce"), [(10.0, 10), (60.0, 6), (600.0, 3)])
def test_memory_is_that_of_photos_as_they_are_learned_from(card, minutes, reduce):
    lens = card.source.photos[0].intrinsics
    large = [replace(photo, intrinsics=lens.scaled(5280, 3956)) for photo in card.source.photos]
    card = replace(card, source=replace(card.source, photos=tuple(large)))
    found = forecast(card, Machine(4, 1 << 40, 1 << 40), TrainChoice("2dgs", minutes=minutes))
    assert found.reduce == reduce
    assert found.photos_bytes == 4 * 6 * (5280 // reduce) * (3956 // reduce)


def test_this_machine_has_a_core_and_no_more_free_memory_than_there_is():
    found = this_machine()
    assert found.cores >= 1
    if found.memory_bytes is not None and found.free_bytes is not None:
        assert 0 <= found.free_bytes <= found.memory_bytes
