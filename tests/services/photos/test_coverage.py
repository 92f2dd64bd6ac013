"""What photos show of panels: the promise of a plan kept or not, which photo shows which section, what is missing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.intake import PhotoCoverage, panel_ids, photo_coverage, photo_intake, recounted
from planning.aircraft.catalogue import profile
from planning.coverage.sections import NOT_SEEN
from planning.insight.sections import SectionState
from planning.parameters import Constraints
from planning.plan import Viewpoint
from planning.site.bundled import SCENES
from planning.site.file import site_sha256
from planning.site.free_space import unchecked_space
from planning.site.records import Facade
from planning.viewpoints.prepare import coverage_model
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos.coverage import achieved_coverage
from tests.services.photo_cases import site_model, write_photos

CAMERA = profile("m3e").camera
SITE = SCENES["office"]()


def views(n, seed):
    """Views of the office from in front, more or less aimed at it."""
    rng = np.random.default_rng(seed)
    frames = SITE.site.panels
    found = []
    for number in range(n):
        target = np.array(frames[rng.integers(len(frames))].corners_enu_m).mean(axis=0)
        position = target + np.array([rng.uniform(-12.0, 12.0), rng.uniform(-22.0, -11.0), rng.uniform(-6.0, 8.0)])
        ahead = target - position
        heading = math.degrees(math.atan2(ahead[0], ahead[1]))
        pitch = math.degrees(math.atan2(ahead[2], math.hypot(ahead[0], ahead[1])))
        found.append(Viewpoint(f"v{number}", tuple(position.tolist()), heading, pitch))
    return found


def photo(view):
    return PosedPhoto(f"{view.id}.jpg", f"{view.id}.jpg", Intrinsics.of(CAMERA), Pose.of(view))


def coverage(flown, planned=()):
    model = coverage_model(SITE, unchecked_space(SITE, 10.0), CAMERA, Constraints(occlusion="off"))
    photos = tuple(photo(view) for view in flown)
    achieved = achieved_coverage(model, photos, planned, panel_ids(SITE.site))
    return PhotoCoverage(tuple(panel_ids(SITE.site)), model.frames, model.grid, photos, achieved)


@pytest.mark.parametrize("seed", range(4))
def test_photos_taken_as_planned_keep_the_whole_promise_and_half_of_them_what_sets_of_sections_say(seed):
    planned = views(14, seed)
    whole = coverage(planned, planned)
    assert np.nanmin(whole.kept_promise()) == 1.0
    assert all(len(whole.missing(panel)) == 0 for panel in range(len(whole.panel_ids)))
    half = coverage(planned[::2], planned)
    promised = [set(whole.achieved.sections[:, m].tolist()) - {NOT_SEEN} for m in range(len(whole.panel_ids))]
    kept = [set(half.achieved.sections[:, m].tolist()) - {NOT_SEEN} for m in range(len(whole.panel_ids))]
    for panel, share in enumerate(half.kept_promise().tolist()):
        if promised[panel]:
            assert share == pytest.approx(len(promised[panel] & kept[panel]) / len(promised[panel]))
            assert set(half.missing(panel).tolist()) == promised[panel] - kept[panel]
        else:
            assert math.isnan(share)
    assert 0.2 < np.nanmean(half.kept_promise()) < 0.95


def test_the_direction_of_a_photo_lies_in_the_section_that_it_is_listed_with():
    found = coverage(views(10, 7))
    n_compared = 0
    for panel in range(len(found.panel_ids)):
        sightings = found.sightings(panel)
        for sighting, (theta, phi) in zip(sightings, found.directions_deg(panel), strict=True):
            step = found.grid.step_deg
            assert sighting.section == int(theta // step) * found.grid.n_sectors + int(phi // step)
            n_compared += 1
        sections = {sighting.section for sighting in sightings}
        assert sections == {k for k, state in enumerate(found.states(panel)) if state is SectionState.COVERED}
        for section in sections:
            assert found.sightings(panel, section) == tuple(one for one in sightings if one.section == section)
    assert n_compared > 100


def test_without_a_plan_nothing_is_promised_and_every_section_that_no_photo_shows_is_missing():
    found = coverage(views(3, 1))
    assert not found.has_promise
    assert np.isnan(found.kept_promise()).all()
    assert SectionState.MISSED not in found.states(0)
    assert len(found.missing(0)) + found.seen_per_panel[0] == found.grid.n_sections
    assert found.number(found.panel_ids[5]) == 5
    assert found.number("nowhere") is None


def test_without_photos_there_is_nothing_to_see_and_no_warning():
    found = coverage([], views(4, 2))
    assert found.sightings(0) == ()
    assert found.directions_deg(0) == ()
    assert np.nanmax(found.kept_promise()) == 0.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    write_photos(folder)
    return folder


def test_coverage_counted_again_is_that_of_reading_again(folder):
    one = site_model()
    facade = one.site.facades[0]
    moved = tuple((x + 2.0, y, z) for x, y, z in facade.panels[0].corners_enu_m)
    panels = (facade.panels[0], replace(facade.panels[0], id="X-2", corners_enu_m=moved))
    site = replace(one.site, facades=(Facade("X", panels),))
    two = replace(one, site=site, sha256=site_sha256(site))
    first = photo_intake(folder, one)
    again, anew = recounted(first, two, None), photo_intake(folder, two)
    assert (again.coverage.counts == anew.coverage.counts).all()
    assert again.findings == anew.findings
    assert photo_coverage(again, two.site).panel_ids == ("X-1", "X-2")
    with pytest.raises(ValueError, match="2 panels, got one with 1"):
        photo_coverage(again, one.site)


def test_a_site_without_panels_has_no_coverage_until_it_gets_some(folder):
    one = site_model()
    site = replace(one.site, facades=())
    bare = replace(one, site=site, sha256=site_sha256(site))
    intake = photo_intake(folder, bare)
    assert photo_coverage(intake, bare.site) is None
    again = recounted(intake, one, None)
    anew = photo_intake(folder, one)
    assert again.findings == anew.findings
    assert (again.coverage.counts == anew.coverage.counts).all()
