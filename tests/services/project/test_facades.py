"""How good found panels are is kept with the project: saved and read whole, and in nobody's way where it is damaged."""

import json
from dataclasses import replace

import pytest

from groundstation.services.photos.found_panels import with_found_panels
from groundstation.services.project.document import Document
from groundstation.services.project.folder import create_project, facades_beside, open_project, save_project
from groundstation.services.site.sources import with_new_site
from planning.base.errors import InputError
from planning.site.bundled import SCENES
from reconstruction.panels.solving.facades_file import found_facades
from tests.services.photo_cases import draft_of, site_model
from tests.services.project_cases import Crash, failing_disk

FILE = "site/site.facades.json"


@pytest.fixture(scope="module")
def draft():
    return draft_of()


@pytest.fixture(scope="module")
def found(draft):
    """A site with the panels that were found, and how good they are."""
    model = with_found_panels(site_model(), draft)
    return Document(model, found_facades=found_facades(draft.found, draft.photos))


@pytest.fixture
def folder(tmp_path, found):
    create_project(tmp_path / "p", found)
    return tmp_path / "p"


def known(document):
    """Panels of the site whose accuracy is known."""
    facades = document.found_facades
    return 0 if facades is None else sum(facades.of(panel) is not None for panel in document.site.site.panels)


def test_all_panels_are_known_after_saving_and_opening(folder, found):
    opened = open_project(folder)
    assert known(opened.document) == 30
    assert opened.document.found_facades.content == found.found_facades.content == (folder / FILE).read_bytes()
    assert opened.notes == ()


def test_saving_again_writes_nothing_and_without_found_panels_the_file_goes(folder, found):
    opened = open_project(folder).document
    before = (folder / FILE).stat().st_mtime_ns, (folder / "project.json").stat().st_mtime_ns
    save_project(folder, opened)
    assert before == ((folder / FILE).stat().st_mtime_ns, (folder / "project.json").stat().st_mtime_ns)
    save_project(folder, replace(opened, found_facades=None))
    assert not (folder / FILE).exists()
    assert open_project(folder).document.found_facades is None


def test_a_project_of_before_has_no_facades_and_keeps_its_own_fields(tmp_path):
    folder = tmp_path / "p"
    create_project(folder, Document(SCENES["single-panel"]()))
    index = json.loads((folder / "project.json").read_text())
    del index["facades"], index["facades_sha256"]
    (folder / "project.json").write_text(json.dumps(index))
    opened = open_project(folder)
    assert opened.notes == ()
    assert opened.document.found_facades is None
    save_project(folder, opened.document)
    assert not (folder / FILE).exists()


def test_a_damaged_file_is_told_and_stays(folder):
    (folder / FILE).write_text('{"format": "reflight-facades/1", "facades": [{"panels": [{}]}]}')
    opened = open_project(folder)
    assert [note.code for note in opened.notes] == ["facades-left-out"]
    assert FILE in opened.notes[0].message
    assert known(opened.document) == 0
    save_project(folder, opened.document)
    assert (folder / FILE).exists()


def test_a_file_that_another_program_has_changed_is_not_replaced(folder, found):
    (folder / FILE).write_text("mine")
    save_project(folder, found)
    assert (folder / FILE).read_text() == "mine"
    opened = open_project(folder)
    assert opened.record.facades == "site/site-2.facades.json"
    assert known(opened.document) == 30


@pytest.mark.few(1)
@pytest.mark.parametrize("crash", [False, True])
def test_a_save_that_breaks_off_leaves_the_old_facades_or_the_new_ones(tmp_path, found, draft, crash):
    folder = tmp_path / "p"
    bare = replace(found, found_facades=None)
    n_writes = None
    for at in range(100):
        if n_writes is not None and at >= n_writes:
            break
        here = folder / str(at)
        create_project(here, bare)
        try:
            with failing_disk(at, crash=crash) as tried:
                save_project(here, found)
            n_writes = len(tried)
        except (Crash, InputError):
            pass
        document = open_project(here).document
        assert known(document) in (0, 30)
        assert [note.code for note in open_project(here).notes] == []
        save_project(here, found)
        assert known(open_project(here).document) == 30
    assert n_writes is not None
    assert n_writes > 5


def test_a_site_file_outside_a_project_brings_what_lies_beside_it(tmp_path, found):
    site = tmp_path / "made.site.json"
    assert facades_beside(site) is None
    beside = tmp_path / "made.facades.json"
    beside.write_bytes(found.found_facades.content)
    document = with_new_site(Document(), found.site, facades_beside(site))
    assert known(document) == 30
    beside.write_text("{")
    assert facades_beside(site) is None


def test_an_edited_panel_is_not_known_any_more(found):
    facade = found.site.site.facades[0]
    corners = tuple((x + 0.1, y, z) for x, y, z in facade.panels[3].corners_enu_m)
    panels = (*facade.panels[:3], replace(facade.panels[3], corners_enu_m=corners), *facade.panels[4:])
    site = replace(found.site.site, facades=(replace(facade, panels=panels),))
    assert known(replace(found, site=replace(found.site, site=site))) == 29
