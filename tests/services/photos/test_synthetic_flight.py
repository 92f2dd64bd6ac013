"""The synthetic flight of the pictures: photos over a building, read like real ones."""

import numpy as np
import pytest

from groundstation.services.photos.grid_edits import panel_outlines
from groundstation.services.photos.intake import photo_coverage, photo_intake
from groundstation.services.photos.synthetic_flight import DIRECTIONS_DEG, write_synthetic_flight
from planning.base.findings import Severity
from planning.site.file import read_site
from planning.site.records import panel_corners


@pytest.mark.slow
def test_photos_are_read_and_show_every_panel_from_several_sides(tmp_path):
    site, photos = write_synthetic_flight(tmp_path)
    model = read_site(site)
    intake = photo_intake(photos, model)
    assert len(intake.photos) == sum(intake.usable) == len(DIRECTIONS_DEG)
    assert all(finding.severity in (Severity.OK, Severity.NOTE) for finding in intake.findings)
    coverage = photo_coverage(intake, model.site)
    assert coverage.seen_per_panel.min() >= 3
    for photo in intake.photos:
        assert len(panel_outlines(photo, tuple(panel_corners(model.site)))) == model.site.n_panels
    # The panels stand before the wall, not in it.
    assert np.abs(coverage.frames.centroids[:, 1] - model.building.vertices_enu_m[:, 1].min()).max() < 0.02
