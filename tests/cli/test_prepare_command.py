"""`prepare`: photos and a site to a data set."""

import json

import cv2
import pytest

from tests.cli.test_panels_command import AT
from tests.reconstruction.synthetic_photos import made_photos, write_flight, write_model


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A folder with photos and a coarse model."""
    folder = tmp_path_factory.mktemp("second")
    made = made_photos(0.0, (0.0, 12.0))
    write_flight(folder / "photos", made)
    write_model(folder / "coarse.ply", made[0].case.wall)
    return folder


@pytest.mark.long
def test_photos_become_a_data_set_that_names_every_panel(flight, reflight, tmp_path):
    site, out = tmp_path / "found.site.json", tmp_path / "dataset"
    assert (
        reflight("panels", flight / "photos", flight / "coarse.ply", "-o", site, AT, "--photos-per-facade", 1).status
        == 0
    )
    done = reflight("prepare", flight / "photos", site, "-o", out, "--normal-step", 8, "--points", 1000, "--json")
    assert done.status == 0, done
    assert done.json["photos"] == 2
    described = json.loads((out / "dataset.json").read_text())
    index = cv2.imread(str(next((out / "panels").iterdir())), cv2.IMREAD_UNCHANGED)
    assert set(index.ravel().tolist()) == {0, *(panel["index"] for panel in described["panels"])}
    again = reflight("prepare", flight / "photos", site, "-o", out)
    assert "is not empty" in again.error
    text = reflight("prepare", flight / "photos", site, "-o", tmp_path / "second", "--normal-step", 8, "--points", 0)
    assert "2 photos prepared" in text.out
    assert "lens distortion: off" in text.out


def test_wrong_input_is_refused_in_words(flight, reflight, tmp_path):
    out = tmp_path / "dataset"
    refused = reflight("prepare", flight / "photos", flight / "coarse.ply", "-o", out)
    assert "import it first" in refused.error
    assert "at least 1" in reflight("prepare", flight, tmp_path, "-o", out, "--normal-step", 0).error
    assert not out.exists()
