"""`photos`: what photos on a card are worth."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from groundstation.services.plan.planning import plan_site
from planning.plan import read_plan
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site
from tests.missions.flight.photo_files import Device, write_photos
from tests.planning.revision.cases import QUICK


@dataclass(frozen=True)
class Office:
    site: Path
    plan: Path


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Photos of all views of a plan but the last three, and the files of site and plan."""
    folder = tmp_path_factory.mktemp("card")
    office = Office(write_scene("office", folder), folder / "office.plan.json")
    plan_site(office.site, PlanRequest(n_views=16, greedy=QUICK), office.plan)
    views = read_plan(office.plan).viewpoints
    write_photos(folder / "photos", read_site(office.site).site, views[:-3], Device())
    return folder / "photos", office


@pytest.mark.long
def test_photos_tell_what_is_missing_of_the_plan(flown, reflight):
    photos, office = flown
    done = reflight("photos", photos, office.site, "--plan", office.plan, "--json")
    assert done.status == 0, done
    plan = read_plan(office.plan)
    assert done.json["photos"] == len(plan.viewpoints) - 3
    assert done.json["planned"] == plan.coverage.covered
    assert 0 < done.json["missed"] < 0.5 * done.json["planned"]
    assert done.json["covered"] == pytest.approx(
        done.json["planned"] - done.json["missed"], abs=0.02 * plan.coverage.covered
    )
    text = reflight("photos", photos, office.site)
    assert f"{len(plan.viewpoints) - 3} photos with a pose" in text.out
    assert "occlusion" in text.out


@pytest.mark.long
def test_broken_photos_are_named_and_the_rest_is_read(flown, reflight, tmp_path):
    photos, office = flown
    for path in photos.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    broken = sorted(tmp_path.iterdir())[0]
    broken.write_bytes(broken.read_bytes()[:200])
    done = reflight("photos", tmp_path, office.site, "--json")
    assert done.status == 0, done
    assert any(code.startswith("photo-") for code in done.json["findings"])
    assert done.json["photos"] >= len(list(tmp_path.iterdir())) - 1
    assert done.json["covered"] > 0


@pytest.mark.long
def test_wrong_input_is_refused_in_words(flown, reflight, tmp_path):
    photos, office = flown
    assert "expected a folder of photos" in reflight("photos", tmp_path / "none", office.site).error
    assert "expected a site" in reflight("photos", photos, office.plan).error
