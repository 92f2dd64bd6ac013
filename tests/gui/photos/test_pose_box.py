"""Refined poses in the Photos tab: taken over, told about, and taken back."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.units import UnitSystem
from planning.base.findings import Severity
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refined_folder import write_refined
from tests.services.photo_cases import write_photos
from tests.services.photos.test_poses import refinement


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Photos of which refined poses can be kept beside them."""
    folder = tmp_path_factory.mktemp("refined") / "photos"
    write_photos(folder)
    return folder


@pytest.fixture
def box(page, folder):
    """The tab's box for poses; nothing has been refined yet."""
    shutil.rmtree(folder.with_name("photos.refined"), ignore_errors=True)
    return page.tab.poses


@pytest.fixture
def kept(box, page, folder):
    """Refined poses lie beside the photos."""
    stated = page.tab.controller.intake.posed.photos
    write_refined(folder.with_name("photos.refined"), refinement(stated), stated, RefineParameters())
    return box


def test_refined_poses_are_taken_over_told_and_taken_back(page, kept):
    own = page.tab.controller.intake
    assert kept.refine.isEnabled()
    assert not kept.back.isEnabled()
    kept.refine.click()
    page.idle()
    refined = page.tab.controller.intake
    assert refined.photos[0].pose.heading_deg != own.photos[0].pose.heading_deg
    assert [card.posed for card in page.tab.controller.cards] == list(refined.photos)
    assert kept.outcome.isVisibleTo(page.tab.left)
    assert "Refined: 3 of 3 photos" in kept.outcome.text()
    assert "0.010 m" in kept.outcome.text()
    assert "0.50\u00b0" in kept.outcome.text()
    assert any("refined poses" in text for text in page.tab.findings.texts())
    assert not kept.refine.isEnabled()
    kept.back.click()
    page.idle()
    back = page.tab.controller.intake
    assert back.photos == own.photos
    np.testing.assert_array_equal(back.coverage.counts, own.coverage.counts)
    assert not kept.outcome.isVisibleTo(page.tab.left)
    assert kept.refine.isEnabled()


@pytest.mark.slow
def test_panels_that_were_found_stay_and_move_with_the_poses(found, kept):
    before = found.draft
    kept.refine.click()
    found.idle()
    after = found.draft
    assert after is not before
    assert after.found.grids is before.found.grids
    assert len(after.facade("A").panels) == len(before.facade("A").panels)
    assert found.tab.use.isEnabled()


@pytest.mark.slow
def test_lengths_follow_the_units(page, kept):
    kept.refine.click()
    page.idle()
    page.controller.context.set_units(UnitSystem.IMPERIAL)
    assert "0.033 ft" in kept.outcome.text()
    page.controller.context.set_units(UnitSystem.METRIC)


@pytest.mark.slow
def test_without_pycolmap_it_says_what_to_install_and_the_poses_stay(page, box, monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)
    own = page.tab.controller.intake
    box.refine.click()
    page.idle()
    assert page.tab.controller.intake is own
    said = [message.text for message in page.messages if message.severity is Severity.ERROR]
    assert any("pip install" in text for text in said)
    assert box.refine.isEnabled()


@pytest.mark.slow
def test_a_refinement_that_is_refused_says_so_and_changes_no_pose(page, box, folder):
    stated = page.tab.controller.intake.posed.photos
    found = refinement(stated)
    loose = [replace(photo, pose=replace(photo.pose, covariance=None)) for photo in found.photos]
    where = folder.with_name("photos.refined")
    write_refined(where, replace(found, photos=tuple(loose)), stated, RefineParameters())
    box.refine.click()
    page.idle()
    assert page.tab.controller.intake.photos == stated
    assert "0 of 3 photos" in box.outcome.text()
    assert any("refined poses were refused" in text for text in page.tab.findings.texts())
    assert box.back.isEnabled()
