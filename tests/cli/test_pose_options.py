"""`--refine` and what belongs to it, alike in the commands that read photos."""

import sys

import pytest

from planning.photos.folder import read_photos
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refined_folder import write_refined
from reconstruction.photos.poses import pose_photos
from tests.cli.test_panels_command import AT
from tests.reconstruction.synthetic_photos import made_photos, write_flight, write_model
from tests.services.photos.test_poses import refinement


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """Three synthetic photos, a coarse model, and the folder where refined poses of the photos are looked for."""
    folder = tmp_path_factory.mktemp("refine")
    made = made_photos(0.0, (0.0, 12.0, -10.0))
    write_flight(folder / "photos", made)
    write_model(folder / "coarse.ply", made[0].case.wall)
    return folder


@pytest.fixture
def site(flight, reflight):
    path = flight / "coarse.site.json"
    if not path.exists():
        assert reflight("site", "import", flight / "coarse.ply", "-o", path, AT, "--without-panels").status == 0
    return path


@pytest.fixture
def kept(flight, site):
    """Refined poses, as if they had been computed before."""
    from planning.site.file import read_site

    photos = flight / "photos"
    stated = pose_photos(read_photos(photos).photos, read_site(site).site, photos).photos
    folder = flight / "photos.refined"
    write_refined(folder, refinement(stated), stated, RefineParameters())
    return folder


@pytest.fixture
def without_pycolmap(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)


@pytest.mark.slow
def test_one_refinement_serves_photos_panels_and_prepare(flight, site, kept, reflight, tmp_path, without_pycolmap):
    photos = reflight("photos", flight / "photos", site, "--refine", "--scale", 8, "--json")
    assert photos.status == 0, photos
    told = photos.json["refined"]
    assert (told["photos"], told["of"], told["was_kept"]) == (3, 3, True)
    assert told["folder"] == str(kept)
    assert told["turned_deg_median"] == pytest.approx(0.5, rel=1e-3)
    found = tmp_path / "found.site.json"
    panels = reflight(
        "panels", flight / "photos", flight / "coarse.ply", "-o", found, AT, "--photos-per-facade", 1, "--refine"
    )
    assert panels.status == 0, panels
    assert f"{kept}: refined poses, computed before" in panels.out
    prepared = reflight(
        "prepare", flight / "photos", found, "-o", tmp_path / "data", "--refine", "--normal-step", 8, "--points", 0
    )
    assert prepared.status == 0, prepared
    assert "3 of 3 photos have refined poses" in prepared.err


def test_without_pycolmap_it_is_said_what_to_install_and_nothing_is_written(
    flight, site, reflight, tmp_path, without_pycolmap
):
    refused = reflight("photos", flight / "photos", site, "--refine", "--refined", tmp_path / "refined")
    assert "pip install 'reflight-groundstation[colmap]'" in refused.error
    assert not (tmp_path / "refined").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--refined", "x"), "--refined: belongs to --refine"),
        (("--refine-size", 800), "--refine-size: belongs to --refine"),
        (("--find-lens", "off"), "--find-lens: belongs to --refine"),
        (("--refine", "--refine-size", 0), "--refine-size: expected at least 1, got 0"),
    ],
)
@pytest.mark.parametrize("command", ["photos", "prepare"])
def test_options_that_make_no_sense_are_refused_in_words(flight, site, reflight, tmp_path, command, options, words):
    out = ("-o", tmp_path / "out") if command == "prepare" else ()
    assert words in reflight(command, flight / "photos", site, *out, *options).error


def test_refining_and_a_model_of_ones_own_exclude_each_other(flight, site, reflight):
    assert reflight("photos", flight / "photos", site, "--refine", "--colmap", "sparse/0").status == 2


def test_a_folder_of_something_else_is_not_written_into(flight, site, reflight, tmp_path):
    pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    (tmp_path / "mine.txt").write_text("mine")
    refused = reflight("photos", flight / "photos", site, "--refine", "--refined", tmp_path)
    assert "something other than refined poses; name another folder" in refused.error
