"""What flights are worth: tables and curves of results, what is kept, and a whole small comparison."""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from groundstation.services.worth import (
    WORTH,
    WORTH_PLANNERS,
    FlightResult,
    FlightTrial,
    WorthRequest,
    kept_folder,
    run_trial,
    summary_rows,
    worth_panels,
    worth_tradeoff,
)
from planning.base.errors import InputError
from planning.plan import ViewpointArrays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.splats.surfels import known_scene
from reconstruction.tradeoff.flight_worth import shots_of


def result(planner: str, n_views: int, seed: int, decibels: float, minutes: float = 6.0) -> FlightResult:
    """One whose kinds of views differ by 1 dB."""
    kinds = {"random": decibels + 1.0, "hemisphere": decibels, "walk": decibels - 1.0}
    return FlightResult("planar", planner, "planned", seed, n_views, n_views, minutes, 1, 0.5, {"radiance-grid": kinds})


def test_seeds_are_averaged_and_their_spread_is_told():
    found = [result("random", 50, 0, 28.0), result("random", 50, 1, 30.0), result("image-error", 50, 0, 31.0, 5.0)]
    by_planner = {row["planner"]: row for row in summary_rows(found)}
    assert by_planner["random"]["mean_db"] == pytest.approx(29.0)
    assert by_planner["random"]["spread_db"] == pytest.approx(1.41)
    assert (by_planner["random"]["seeds"], by_planner["random"]["walk_db"]) == (2, 28.0)
    assert by_planner["image-error"]["spread_db"] == ""


def test_curves_fall_with_minutes_in_the_air():
    found = [result("random", 50, 0, 28.0), result("random", 100, 0, 30.0, 11.0), result("sections", 50, 0, 29.0)]
    (panel,) = worth_panels(found)
    lines = {line.name: line.curve for line in panel.lines}
    assert [point.t_s for point in lines["random"].points] == [360.0, 660.0]
    assert lines["random"].final_gap == pytest.approx(10.0 ** (-30.0 / 20.0))
    assert lines["random"].gap_at(400.0) > lines["sections"].gap_at(400.0)


def test_what_is_finished_is_not_done_again(tmp_path):
    known = result("random", 50, 0, 28.0)
    trial = FlightTrial("random", 50, 0, "planned")
    place = tmp_path / trial.name
    place.mkdir()
    with_another = replace(known, psnr_db={**known.psnr_db, "mlp": {"random": 24.0}})
    (place / "result.json").write_text(json.dumps(asdict(with_another)))
    assert run_trial(WorthRequest("no such scene", lights=("radiance-grid",)), trial, tmp_path) == known


@pytest.mark.long
def test_other_scenes_and_settings_have_folders_of_their_own(tmp_path):
    base = WorthRequest("planar")
    others = [replace(base, scene="curved"), replace(base, width_px=64), replace(base, n_unseen=9)]
    folders = {kept_folder(request, tmp_path) for request in (base, *others)}
    assert len(folders) == 4
    assert kept_folder(replace(base, planners=("random",), views=(9,), lights=("mlp",)), tmp_path) in folders
    assert kept_folder(replace(base, n_seeds=1, flown=("single",)), tmp_path) in folders


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"planners": ("ants",)}, "there is no 'ants'; known are: random, orbit"),
        ({"lights": ("candle",)}, "there is no 'candle'; known are: radiance-grid, mlp, splats"),
        ({"flown": ("by hand",)}, "there is no 'by hand'; known are: planned, rtk-fixed, single"),
        ({"views": (1,)}, "expected numbers of photos from 2 on"),
    ],
)
def test_what_does_not_exist_is_refused_in_words(changes, words):
    with pytest.raises(InputError, match=words):
        WorthRequest("planar", **changes)


def test_a_scene_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="neither a site file nor a bundled scene"):
        worth_tradeoff(WorthRequest("no such scene"), tmp_path)


def test_every_method_compared_is_one_of_the_planner():
    from groundstation.cli.commands import tradeoff
    from planning.viewpoints.methods import METHODS

    assert tuple(tradeoff.WORTH_PLANNERS.split(",")) == tuple(WORTH_PLANNERS)
    assert {method for method, _ in WORTH_PLANNERS.values()} == set(METHODS)


def test_the_table_has_a_row_for_each_flight_light_and_kind_of_unseen_views():
    rows = WORTH.rows((result("random", 50, 3, 28.0),))
    columns = {"scene", "planner", "views", "minutes", "light", "unseen", "seed", "db"}
    assert all(columns <= set(row) for row in rows)
    assert {(row["unseen"], row["db"], row["seed"]) for row in rows} == {
        ("random", 29.0, 3),
        ("hemisphere", 28.0, 3),
        ("walk", 27.0, 3),
    }


@pytest.mark.slow
def test_a_flight_is_planned_flown_photographed_and_learned_from(tmp_path):
    request = WorthRequest(
        "planar",
        ("random", "image-error"),
        (4,),
        ("radiance-grid",),
        ("planned", "single"),
        n_seeds=1,
        n_unseen=12,
        width_px=96,
        plan_s=5.0,
    )
    compared = worth_tradeoff(request, tmp_path)
    assert len(compared.found) == 4
    assert compared.csv_path == tmp_path / "worth.csv"
    rows = list(csv.DictReader(compared.csv_path.read_text("utf-8").splitlines()))
    assert {(row["planner"], row["flown"]) for row in rows} == {
        (planner, flown) for planner in ("random", "image-error") for flown in ("planned", "single")
    }
    assert all(10.0 < float(row["db"]) < 50.0 and float(row["minutes"]) > 0.5 for row in rows)
    assert all(path.is_file() for path in compared.paths)
    assert worth_tradeoff(request, tmp_path).found == compared.found
    # What a data set of such a flight has for splats to begin at, and to hide points by.
    flights = sorted(tmp_path.glob("worth/*/*-4-*/photos"))
    assert len(flights) == 4
    assert all(len(known_scene(read_photo_set(flight)).mesh.triangles) > 0 for flight in flights)
    # Another light of the same flights learns from the photos that are there.
    photos = sorted(tmp_path.glob("worth/*/*/photos/images/*"))
    taken = [path.stat().st_mtime_ns for path in photos]
    both = worth_tradeoff(replace(request, lights=("radiance-grid", "mlp")), tmp_path).found
    assert [path.stat().st_mtime_ns for path in photos] == taken
    for before, after in zip(compared.found, both, strict=True):
        assert after.psnr_db["radiance-grid"] == before.psnr_db["radiance-grid"]
        assert after.n_taken == 4
        assert set(after.psnr_db) == {"radiance-grid", "mlp"}


def test_headings_beyond_a_half_turn_are_shots_all_the_same():
    views = ViewpointArrays(np.zeros((3, 3)), np.radians([-180.4, 180.0, 540.0]), np.zeros(3))
    assert [shot.view.heading_deg for shot in shots_of(views)] == pytest.approx([179.6, 180.0, 180.0])
