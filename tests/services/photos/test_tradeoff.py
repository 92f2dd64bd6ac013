"""What accuracy costs in time: the same facade, searched in other ways."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.found_panels import PanelDraft, search_panels, solved_draft
from groundstation.services.photos.intake import photo_intake
from groundstation.services.photos.tradeoff import corner_sigma_m, facade_trials
from tests.reconstruction.synthetic_photos import coarse_model, made_photos, write_flight
from tests.services.photo_cases import draft_of, site_model


@pytest.mark.slow
def test_more_photos_cost_time_and_bring_accuracy(tmp_path):
    made = made_photos()
    write_flight(tmp_path, made)
    model = replace(site_model(), building=coarse_model(made[0].case.wall))
    intake = photo_intake(tmp_path, site_model())
    draft = search_panels(intake.photos, intake.metadata, model)
    assert isinstance(draft, PanelDraft)
    n_truth = len(made[0].panels)
    assert len(draft.facade("A").panels) == n_truth
    ticks = itertools.count()
    trials = facade_trials(draft, intake.metadata, "A", clock=lambda: float(next(ticks)))
    scales = [trial.value for trial in trials if trial.knob == "scale"]
    assert scales == sorted(scales)
    one, two = (trial for trial in trials if trial.knob == "photos")
    assert (one.value, two.value) == (1, 2)
    assert two.seconds == 2.0 * one.seconds
    assert two.n_panels == n_truth
    assert two.sigma_m < one.sigma_m < 0.1


def test_fewer_photos_make_corners_less_sure():
    draft = draft_of()
    alone = {key: grid for key, grid in draft.found.grids.items() if key[1] == 0}
    single = replace(draft, found=replace(draft.found, grids=alone), unsolved=frozenset({"A"}))
    few, all_ = corner_sigma_m(solved_draft(single).facade("A")), corner_sigma_m(draft.facade("A"))
    assert 0.005 < all_ < few < 0.2
    assert np.isfinite(few)
