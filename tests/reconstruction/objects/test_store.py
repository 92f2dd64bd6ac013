"""Scenes of objects on the disk: the same again, in parts too, and refused where they are not what they say."""

import hashlib
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.numpy import load_file, save_file

from planning.base.errors import InputError, OperationCancelled
from reconstruction.objects.store import DESCRIPTION, StoredScene, read_scene, write_scene
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


def assert_same(one, other):
    assert (one.global_id, one.name, one.origin, one.origin_enu_m) == (
        other.global_id,
        other.name,
        other.origin,
        other.origin_enu_m,
    )
    assert (one.training, one.n_gaussians) == (other.training, other.n_gaussians)
    for mine, yours in zip(one.components, other.components, strict=True):
        assert (mine.global_id, mine.name, mine.kind, mine.elements) == (
            yours.global_id,
            yours.name,
            yours.kind,
            yours.elements,
        )
        assert_same_table(mine.gaussians, yours.gaussians)
    for mine, yours in zip(one.auxiliary, other.auxiliary, strict=True):
        assert mine.name == yours.name
        assert mine.tensors.keys() == yours.tensors.keys()
        assert all(np.array_equal(mine.tensors[key], yours.tensors[key]) for key in mine.tensors)


def assert_same_table(mine, yours):
    assert mine.values.keys() == yours.values.keys()
    assert all(np.array_equal(mine.values[key], yours.values[key]) for key in mine.values)
    assert np.array_equal(mine.places, yours.places)


@pytest.fixture
def stored(tmp_path):
    write_scene(synthetic_scene(), tmp_path / "scene")
    return tmp_path / "scene"


@settings(max_examples=15, deadline=None)
@given(
    sizes=st.lists(st.lists(st.integers(0, 4), min_size=1, max_size=4), min_size=1, max_size=3),
    n_background=st.integers(0, 4),
    seed=st.integers(0, 99),
)
def test_any_scene_is_read_back_the_same(tmp_path_factory, sizes, n_background, seed):
    scene = synthetic_scene(tuple(map(tuple, sizes)), n_background, seed)
    folder = tmp_path_factory.mktemp("scenes")
    write_scene(scene, folder)
    assert_same(read_scene(folder), scene)


def test_a_facade_is_read_without_the_others(stored):
    whole = read_scene(stored)
    for name in ("B", "background"):
        for other in stored.glob("A-*.safetensors"):
            other.unlink()
        part = read_scene(stored, [name])
        assert [component.name for component in part.components] == [name]
        assert not part.is_whole
        mine = next(component for component in whole.components if component.name == name)
        assert_same_table(part.components[0].gaussians, mine.gaussians)
    with pytest.raises(InputError, match=r"A-.*cannot be read"):
        read_scene(stored)
    with pytest.raises(InputError, match="has no component 'Z'; it has A, B, background"):
        read_scene(stored, ["Z"])


def test_an_element_is_read_alone(stored):
    whole, store = read_scene(stored), StoredScene(stored)
    for component, element in whole.elements:
        found, gaussians = store.element(element.global_id)
        assert found == element
        assert_same_table(gaussians, component.gaussians.part(element.start, element.stop))
    with pytest.raises(InputError, match="no element with the GlobalId"):
        store.element("nothing")


def test_components_come_one_by_one(stored):
    assert [each.name for each in StoredScene(stored).components()] == ["A", "B", "background"]


def test_a_scene_that_is_written_over_stays_whole_until_the_end(stored, monkeypatch):
    before, other = synthetic_scene(), synthetic_scene(seed=5)
    (stored / "records.sqlite").write_bytes(b"records")
    (stored / "own.safetensors").write_bytes(b"somebody's")

    class Interrupted:
        def report(self, stage, done, total):
            if done == 2:
                raise OperationCancelled("no longer wanted")

    with pytest.raises(OperationCancelled):
        write_scene(other, stored, Interrupted())
    assert_same(read_scene(stored), before)
    write_scene(other, stored)
    assert_same(read_scene(stored), other)
    names = sorted(path.name for path in stored.iterdir())
    assert len(names) == 7, names
    assert (stored / "records.sqlite").read_bytes() == b"records"


def test_parts_of_a_scene_are_not_written(stored, tmp_path):
    with pytest.raises(ValueError, match="all of its components"):
        write_scene(read_scene(stored, ["A"]), tmp_path / "part")


def changed(folder, change):
    path = folder / DESCRIPTION
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def rewritten(folder, change):
    """A component's file changed, and the description made to fit."""
    path = next(folder.glob("A-*.safetensors"))
    tensors = load_file(path)
    change(tensors)
    save_file(tensors, path)
    sha256, n_bytes = hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_size
    changed(folder, lambda content: content["components"][0].update(sha256=sha256, n_bytes=n_bytes))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(format="reflight-gsscene/2"), "format"),
        (lambda c: c.update(components=[]), "expected at least one"),
        (lambda c: c.update(origin_enu_m=[1e999, 0, 0]), "finite"),
        (lambda c: c["components"][0].update(file="../A.safetensors"), "name of a .safetensors file beside"),
        (lambda c: c["components"][0].update(file="/etc/passwd"), "name of a .safetensors file beside"),
        (lambda c: c["components"][0].update(sha256="00"), "changed or cut off"),
        (lambda c: c["components"][0].update(n_bytes=1), "changed or cut off"),
        (lambda c: c["components"][0].update(n_gaussians=9), "expected 9"),
        (lambda c: c["components"][0].update(n_gaussians=10**12), "expected 0 to"),
        (lambda c: c["components"][0].update(name="B"), "found one twice"),
        (lambda c: c["components"][0]["elements"][0].update(stop=2), "begins at row 3, expected 2"),
        (lambda c: c["components"][0]["elements"][2].update(stop=7), "expected 7 rows"),
        (lambda c: c["components"][0]["elements"][2].update(start=-3), "start"),
        (lambda c: c["components"][0]["elements"][0].update(panel=1), "found one twice"),
        (lambda c: c["components"][0].update(kind="roof"), "kind"),
        (lambda c: c["components"][2].update(elements=c["components"][0]["elements"][:1]), "found one twice"),
    ],
)
def test_a_damaged_description_is_refused_in_words(stored, change, message):
    changed(stored, change)
    with pytest.raises(InputError, match=message):
        read_scene(stored)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.pop("means"), "has no 'means'"),
        (lambda t: t.pop("places"), "places: expected 8 of int32"),
        (lambda t: t.update(places=t["places"].astype(np.int64)), "places: expected 8 of int32"),
        (lambda t: t.update(quats=t["quats"][:, :3].copy()), "quats: expected 8 rows"),
        (lambda t: t.update(sh=t["sh"].astype(np.float64)), "sh: expected 8 rows of float32"),
        (lambda t: t["means"].__setitem__((0, 0), np.nan), "means: holds numbers that are not finite"),
        (lambda t: t.update(own=np.zeros((8, 5000), np.float32)), "own: expected 8 rows"),
        (lambda t: t.update({key: value[:5].copy() for key, value in t.items()}), "expected 8"),
    ],
)
def test_a_component_of_another_content_is_refused_in_words(stored, change, message):
    rewritten(stored, change)
    with pytest.raises(InputError, match=message):
        read_scene(stored)


@pytest.mark.parametrize("content", [b"", b"\xff" * 8 + b"x" * 64, b"\x80\x04cos\nsystem\n", b"PK\x03\x04"])
def test_a_file_of_another_kind_is_refused_in_words(stored, content):
    path = next(stored.glob("A-*.safetensors"))
    path.write_bytes(content)
    sha256 = hashlib.sha256(content).hexdigest()
    changed(stored, lambda c: c["components"][0].update(sha256=sha256, n_bytes=len(content)))
    with pytest.raises(InputError, match="no safetensors file, or damaged"):
        read_scene(stored)
    with pytest.raises(InputError, match="no safetensors file, or damaged"):
        StoredScene(stored).element(
            next(iter(json.loads((stored / DESCRIPTION).read_text())["components"]))["elements"][0]["global_id"]
        )


def test_a_folder_without_a_scene_says_what_to_do(tmp_path):
    with pytest.raises(InputError, match="make one with `organise`"):
        read_scene(tmp_path)
