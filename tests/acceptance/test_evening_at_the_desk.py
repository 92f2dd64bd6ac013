"""The evening at the controller: from the photos of a flight to a report of the panes, by clicks alone."""

import shutil
import subprocess

import pytest

from groundstation.services.photos.synthetic_flight import write_synthetic_flight
from groundstation.services.settings import Language
from tests.gui.driving import choose, clicked, press


@pytest.fixture
def flight(tmp_path):
    """A site as somebody drew it before the flight, and what lies on the camera's card after it."""
    folder = tmp_path / "flight"
    folder.mkdir()
    return write_synthetic_flight(folder)


@pytest.mark.slow
@pytest.mark.parametrize("pilot", [Language.ENGLISH, Language.GERMAN], indirect=True)
def test_from_the_photos_of_a_flight_to_a_report_of_the_panes(pilot, flight):
    site, photos = flight
    project = pilot.folder / "house"
    _find_the_panels(pilot, site, photos)
    _save(pilot, project)
    _make_the_data_set(pilot, project / "dataset")
    model = pilot.folder / "model"
    _train(pilot, model)
    _write_a_record(pilot, model)
    _report(pilot, pilot.folder / "report.pdf")


def _find_the_panels(pilot, site, photos):
    pilot.tab("Site")
    with clicked(choose(site)):
        pilot.press("Open a site file")
    pilot.idle()
    pilot.tab("Photos")
    with clicked(choose(photos)):
        pilot.press("Choose folder ...")
    pilot.idle()
    pilot.see("photos")
    pilot.press("Find panels")
    pilot.idle()
    pilot.see("found")
    pilot.press("Use these panels")
    pilot.idle()
    pilot.see("site")


def _save(pilot, project):
    with clicked(choose(project)):
        pilot.press("Save")
    pilot.idle()
    assert pilot.controller.context.session.is_saved


def _make_the_data_set(pilot, folder):
    pilot.tab("Photos")
    with clicked(choose(folder)):
        pilot.press("Make data set ...")
    pilot.idle()
    pilot.see("data set")
    assert (folder / "dataset.json").is_file()
    assert pilot.reads("The data set is written, photos: {0}. Train a model of it on the Reconstruct tab: {1}")


def _train(pilot, model):
    pilot.tab("Reconstruct")
    pilot.idle()
    pilot.see("reconstruct")
    assert pilot.reads("{0}: {1} photos, {2} panels"), "the project's data set is there at once"
    with clicked(choose(model)):
        pilot.press("Model goes to: Choose ...")
    pilot.idle()
    pilot.choose("Time", "Custom time")
    pilot.fill("At most", "1")
    pilot.see("ready to train")
    pilot.press("Train")
    page = pilot.controller.window.tab("reconstruct")
    pilot.until(lambda: page.controller.training.stepped is not None, "it trains")
    pilot.see("training")
    pilot.press("Stop and keep")
    pilot.until_reads("The model is finished.")
    pilot.idle()
    pilot.see("trained")
    assert (model / "model.json").is_file()


def _write_a_record(pilot, model):
    pilot.tab("Model")
    with clicked(choose(model)):
        pilot.press("Open a model ...")
    pilot.until(lambda: pilot.button("Export ...").isEnabled(), "the model is open")
    pilot.idle()
    pilot.see("model")
    pilot.row("Panels", 0)

    def fill_in(dialog):
        pilot.fill("kind", "crack")
        pilot.fill("note", "lower left corner")
        pilot.see("record")
        press("OK")(dialog)

    with clicked(fill_in):
        pilot.entry("Add ...", "Defect ...")
    pilot.idle()
    pilot.see("recorded")
    assert "crack" in "\n".join(line_texts(pilot))


def line_texts(pilot):
    tree = pilot.field("Records")
    groups = [tree.topLevelItem(n) for n in range(tree.topLevelItemCount())]
    return [group.child(n).text(0) for group in groups for n in range(group.childCount())]


def _report(pilot, path):
    with clicked(choose(path)):
        pilot.press("Report as PDF ...")
    pilot.until_reads("The report is written: {0}")
    pilot.see("report")
    assert path.read_bytes().startswith(b"%PDF")
    if shutil.which("pdftotext") is not None:
        assert "crack" in subprocess.run(["pdftotext", path, "-"], capture_output=True, text=True, check=True).stdout
