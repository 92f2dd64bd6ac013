"""Exporting from the Model tab: what is asked for, and what is written in a process beside the window's."""

import pytest

from groundstation.gui.model.model_page import ExportDialog
from groundstation.services.model.export import EXPORTERS, ModelExport, with_ending
from tests.gui.driving import choose, clicked, escape, press, shut, turn_until
from tests.reconstruction.exports.spz.reading import read_spz
from tests.services.reconstruct.test_shown_models import made_model


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """A scene of objects of a trained model."""
    with made_model(tmp_path_factory.mktemp("trained")) as folder:
        yield folder / "scene"


def opened_with(application, page, folder):
    page.controller.open(folder)
    turn_until(application, lambda: page.controller.card is not None and not page._context.jobs())


def test_every_format_is_offered_with_what_it_is_for(application):
    dialog = ExportDialog(("A",))
    offered = [dialog.format.itemData(row) for row in range(dialog.format.count())]
    assert offered == list(EXPORTERS)
    about = []
    for row in range(dialog.format.count()):
        dialog.format.setCurrentIndex(row)
        about.append(dialog.about.text())
    assert len(set(about)) == len(about)
    assert all(about)


def test_only_what_a_format_asks_for_can_be_chosen_and_counts(application):
    dialog = ExportDialog(("A", "B"))
    dialog.part.setCurrentIndex(2)
    for name, value in (("baked", False), ("preset", "small"), ("degree", 1), ("gaussians", "points")):
        dialog.rows[name].setValue(value)
    found = {}
    for kind in EXPORTERS:
        dialog.format.setCurrentIndex(dialog.format.findData(kind))
        found[kind] = dialog.wanted()
        assert found[kind].format == kind
        assert [name for name, row in dialog.rows.items() if row.widget.isEnabled()] == [
            name
            for name, is_chosen in (
                ("baked", not found[kind].baked),
                ("degree", found[kind].degree == 1),
                ("preset", found[kind].preset == "small"),
                ("gaussians", found[kind].gaussians == "points"),
            )
            if is_chosen
        ]
        assert dialog.part.isEnabled() == (found[kind].components == ("B",))
    assert found["sog"] == ModelExport("sog", baked=False, degree=1, preset="small", components=("B",))
    assert found["gltf"] == ModelExport("gltf", baked=False, degree=1, components=("B",), gaussians="points")
    assert found["ifc"] == ModelExport("ifc")


def test_a_preset_can_be_chosen_for_gaussians_that_are_compressed(application):
    dialog = ExportDialog(())
    dialog.format.setCurrentIndex(dialog.format.findData("gltf"))
    assert not dialog.rows["preset"].widget.isEnabled()
    dialog.rows["gaussians"].setValue("spz")
    dialog.rows["preset"].setValue("fine")
    assert dialog.wanted() == ModelExport("gltf", preset="fine", gaussians="spz")
    dialog.rows["gaussians"].setValue(None)
    assert dialog.wanted() == ModelExport("gltf")


def test_files_get_the_ending_of_their_format_unless_they_have_one(tmp_path):
    assert with_ending(tmp_path / "tower", "cityjson").name == "tower.city.json"
    assert with_ending(tmp_path / "tower.json", "cityjson").name == "tower.json"
    assert with_ending(tmp_path / "tower", "web").name == "tower"


@pytest.mark.slow
def test_a_model_is_written_and_the_user_is_told(application, page, trained, tmp_path):
    assert not page.side.export.isEnabled()
    opened_with(application, page, trained)
    assert page.side.export.isEnabled()

    def as_spz(dialog):
        dialog.format.setCurrentIndex(dialog.format.findData("spz"))
        press("Choose a place ...")(dialog)

    for no in ("Cancel", escape, shut):
        with clicked(no):
            page.side.export.click()
        with clicked(as_spz, no):
            page.side.export.click()
    assert page.messages == []
    with clicked(as_spz, choose(tmp_path / "tower")):
        page.side.export.click()
    turn_until(application, lambda: bool(page.messages))
    assert "The model is written" in page.messages[-1].text
    assert 0 < len(read_spz(tmp_path / "tower.spz")) <= page.controller.card.n_gaussians


@pytest.mark.slow
def test_a_web_page_is_written_into_a_folder_that_is_named(application, page, trained, tmp_path):
    opened_with(application, page, trained)
    with clicked("Choose a place ...", escape):
        page.side.export.click()
    with clicked("Choose a place ...", choose(tmp_path / "tower page")):
        page.side.export.click()
    turn_until(application, lambda: bool(page.messages))
    assert (tmp_path / "tower page" / "index.html").is_file()


def test_what_cannot_be_written_is_told_and_the_window_goes_on(application, page, trained, tmp_path):
    opened_with(application, page, trained)
    page.controller.export(tmp_path / "absent" / "tower.spz", ModelExport("spz"))
    turn_until(application, lambda: bool(page.messages))
    assert "there is no folder" in page.messages[-1].text
    assert page.side.export.isEnabled()


def test_an_export_that_is_cancelled_leaves_nothing(application, page, trained, tmp_path):
    opened_with(application, page, trained)
    page.controller.export(tmp_path / "tower.web", ModelExport("web"))
    page._context.cancel(page._context.jobs()[0])
    turn_until(application, lambda: not page._context.jobs())
    assert list(tmp_path.iterdir()) == []
