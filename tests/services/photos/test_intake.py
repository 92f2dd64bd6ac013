"""Photos over a site: counted wherever its home is, and read where there is nothing to count yet."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.intake import NO_PANELS, intake_summary, photo_intake, recounted
from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, InputError
from planning.parameters import Constraints
from planning.viewpoints.prepare import prepare
from tests.services.photo_cases import site_model, write_photos


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    write_photos(folder)
    return folder


def bare():
    model = site_model()
    return replace(model, site=replace(model.site, facades=()))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("home_enu_m", "why"),
    [
        ((6.0, 4.0, 0.0), "10 m are required"),
        ((12.0, 4.0, 0.0), "inside a building"),
        ((90.0, 0.0, 0.0), "airspace"),
    ],
)
def test_photos_count_alike_where_home_suits_no_flight(folder, home_enu_m, why):
    model = site_model()
    moved = replace(model, site=replace(model.site, home_enu_m=home_enu_m))
    with pytest.raises(InfeasibleError, match=why):
        prepare(moved, profile("m3e").camera, Constraints())
    there, here = photo_intake(folder, moved), photo_intake(folder, model)
    assert here.coverage.covered > 0
    np.testing.assert_array_equal(there.coverage.counts, here.coverage.counts)


def test_photos_of_a_site_without_panels_are_read_and_counted_once_it_has_some(folder):
    intake, direct = photo_intake(folder, bare()), photo_intake(folder, site_model())
    assert (intake.coverage, intake.occlusion) == (None, None)
    assert len(intake.photos) == sum(intake.usable) == 3
    assert [finding.code for finding in intake.findings if finding.code == NO_PANELS] == [NO_PANELS]
    assert "covered" not in intake_summary(intake)
    with pytest.raises(InputError, match="has no panels yet"):
        recounted(intake, bare(), None)
    counted = recounted(intake, site_model(), None)
    np.testing.assert_array_equal(counted.coverage.counts, direct.coverage.counts)
    assert NO_PANELS not in {finding.code for finding in counted.findings}
    assert intake_summary(counted)["covered"] == direct.coverage.covered
