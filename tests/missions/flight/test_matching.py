"""Views tied to photos: in order, out of order, missing, twice, elsewhere, and never a wrong one in silence."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from missions.flight.matching import DEFAULT_GATES, Matching, _aligned, _gains, match_flight, n_lost
from missions.flight.outcome import Reason
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from planning.plan import Plan
from tests.missions.flight.flights import cut_at, flown_as_planned, moved, never_taken, with_photos
from tests.missions.plans import example_plan, make_plan, ring

PLAN = example_plan()
FLOWN = flown_as_planned(PLAN)


def reasons(matching: Matching) -> list[str]:
    """Reason of each view, in the order of the plan."""
    return [match.reason.value for match in matching.views]


def photo_of(matching: Matching, view_id: str, records: tuple[FlightRecord, ...]) -> TakenPhoto | None:
    """The photo of a view."""
    ref = next(match.photo for match in matching.views if match.view_id == view_id)
    return None if ref is None else records[ref.record].photos[ref.photo]


def test_a_flight_as_planned_has_a_photo_for_every_view() -> None:
    matching = match_flight(PLAN, FLOWN)
    assert reasons(matching) == ["taken"] * 10
    assert matching.sortie_of_record == (1, 2)
    assert not matching.extra
    assert [match.photo.photo for match in matching.views if match.photo] == [0, 1, 2, 3, 4, 5, 0, 1, 2, 3]


def test_a_photo_missing_in_the_middle_shifts_no_other() -> None:
    spoilt = (never_taken(FLOWN[0], 2), FLOWN[1])
    matching = match_flight(PLAN, spoilt)
    assert reasons(matching) == ["taken"] * 2 + ["no-photo"] + ["taken"] * 7
    photo = photo_of(matching, "v0003", spoilt)
    assert photo is not None
    assert photo.time_s == FLOWN[0].photos[3].time_s


def test_photos_before_the_first_view_and_between_are_extra() -> None:
    early = replace(FLOWN[0].photos[0], index=0, time_s=1.0, position_enu_m=PLAN.home_enu_m or (0.0, 0.0, 0.0))
    between = replace(FLOWN[0].photos[2], position_enu_m=(30.0, -30.0, 27.0), time_s=FLOWN[0].photos[2].time_s - 4.0)
    spoilt = (with_photos(FLOWN[0], lambda p: (early, *p[:2], between, *p[2:])), FLOWN[1])
    matching = match_flight(PLAN, spoilt)
    assert reasons(matching) == ["taken"] * 10
    assert [(ref.record, ref.photo) for ref in matching.extra] == [(0, 0), (0, 3)]


def test_of_a_view_flown_twice_the_better_photo_counts() -> None:
    worse = moved(FLOWN[0].photos[1], (1.0, 0.0, 0.0))
    spoilt = (with_photos(FLOWN[0], lambda photos: (photos[0], worse, *photos[1:])), FLOWN[1])
    matching = match_flight(PLAN, spoilt)
    assert reasons(matching) == ["taken"] * 10
    assert [(ref.record, ref.photo) for ref in matching.extra] == [(0, 1)]


def test_a_view_taken_again_at_the_end_is_found_out_of_order() -> None:
    again = replace(FLOWN[0].photos[2], time_s=FLOWN[0].photos[-1].time_s + 20.0)
    spoilt = (with_photos(FLOWN[0], lambda photos: (*photos[:2], *photos[3:], again)), FLOWN[1])
    matching = match_flight(PLAN, spoilt)
    assert reasons(matching) == ["taken"] * 10
    assert photo_of(matching, "v0002", spoilt) == again


def test_a_sortie_flown_backwards_is_matched_in_full() -> None:
    spoilt = (with_photos(FLOWN[0], lambda photos: photos[::-1]), FLOWN[1])
    assert reasons(match_flight(PLAN, spoilt)) == ["taken"] * 10


def test_swapped_sorties_are_told_apart_whatever_their_numbers_say() -> None:
    swapped = (replace(FLOWN[1], sortie=1), replace(FLOWN[0], sortie=2))
    matching = match_flight(PLAN, swapped)
    assert matching.sortie_of_record == (2, 1)
    assert reasons(matching) == ["taken"] * 10


def test_without_photos_the_track_tells_which_sortie_it_was() -> None:
    blind = tuple(replace(with_photos(record, lambda _: ()), sortie=0) for record in FLOWN[::-1])
    matching = match_flight(PLAN, blind)
    assert matching.sortie_of_record == (2, 1)
    assert reasons(matching) == ["no-photo"] * 10


def test_an_aborted_sortie_says_what_was_over_before() -> None:
    end_s = (FLOWN[0].photos[2].time_s + FLOWN[0].photos[3].time_s) / 2.0
    matching = match_flight(PLAN, (cut_at(FLOWN[0], end_s),))
    assert reasons(matching) == ["taken"] * 3 + ["flight-ended"] * 3 + ["not-flown"] * 4


def test_a_resumed_sortie_is_put_together_from_both_records() -> None:
    end_s = FLOWN[0].photos[2].time_s + 1.0
    again = with_photos(FLOWN[0], lambda photos: photos[2:])
    matching = match_flight(PLAN, (cut_at(FLOWN[0], end_s), again, FLOWN[1]))
    assert matching.sortie_of_record == (1, 1, 2)
    assert reasons(matching) == ["taken"] * 10
    assert len(matching.extra) == 1


def test_the_reason_names_a_photo_that_looks_elsewhere_or_was_taken_far_away() -> None:
    turned = moved(FLOWN[0].photos[1], (0.0, 0.0, 0.0), turned_deg=40.0)
    away = moved(FLOWN[0].photos[4], (0.0, 0.0, 9.0))
    spoilt = (with_photos(FLOWN[0], lambda p: (p[0], turned, p[2], p[3], away, p[5])), FLOWN[1])
    matching = match_flight(PLAN, spoilt)
    assert reasons(matching)[:6] == ["taken", "wrong-angle", "taken", "taken", "too-far", "taken"]
    assert [match.nearest.photo for match in matching.views if match.nearest] == [1, 4]


def test_a_view_that_was_passed_by_was_not_reached() -> None:
    shortened = make_plan([(ring(6)[:2] + ring(6)[4:], {})])
    flown = flown_as_planned(shortened)
    matching = match_flight(make_plan([(ring(6), {})]), flown)
    assert reasons(matching) == ["taken"] * 2 + ["not-reached"] * 2 + ["taken"] * 2


def test_a_flight_elsewhere_flew_no_sortie() -> None:
    track = FLOWN[0].track
    shifted = {name: getattr(track, name) for name in Track.__slots__}
    shifted["position_enu_m"] = track.position_enu_m + np.array([300.0, 0.0, 0.0])
    elsewhere = replace(
        FLOWN[0], track=Track(**shifted), photos=tuple(moved(p, (300.0, 0.0, 0.0)) for p in FLOWN[0].photos)
    )
    matching = match_flight(PLAN, (elsewhere,))
    assert matching.sortie_of_record == (0,)
    assert set(reasons(matching)) == {"not-flown"}
    assert len(matching.extra) == 6


def test_without_a_track_nothing_is_claimed_about_where_it_was() -> None:
    n = len(FLOWN[0].track.time_s)
    empty = replace(FLOWN[0].track, position_enu_m=np.full((n, 3), np.nan))
    matching = match_flight(PLAN, (replace(with_photos(FLOWN[0], lambda p: p[:2]), track=empty),))
    assert reasons(matching)[:6] == ["taken"] * 2 + ["no-track"] * 4


def test_no_records_and_no_views_are_no_special_cases() -> None:
    assert set(reasons(match_flight(PLAN, ()))) == {"not-flown"}
    nothing = replace(PLAN, viewpoints=(), sorties=())
    assert match_flight(nothing, FLOWN).views == ()


def test_angles_that_are_not_known_do_not_stand_in_the_way() -> None:
    blind = tuple(replace(photo, heading_deg=None, gimbal_pitch_deg=None) for photo in FLOWN[0].photos)
    matching = match_flight(PLAN, (replace(FLOWN[0], photos=blind), FLOWN[1]))
    assert reasons(matching) == ["taken"] * 10


@given(st.data())
def test_the_alignment_is_the_best_of_all_in_order(data: st.DataObject) -> None:
    n, m = data.draw(st.integers(0, 5)), data.draw(st.integers(0, 5))
    values = data.draw(st.lists(st.floats(0.0, 1.5), min_size=n * m, max_size=n * m))
    misfits = np.array(values, np.float64).reshape(n, m)
    gains = _gains(misfits, DEFAULT_GATES)
    best = 0.0
    for k in range(min(n, m) + 1):
        for rows in itertools.combinations(range(n), k):
            for columns in itertools.combinations(range(m), k):
                best = max(best, float(gains[list(rows), list(columns)].sum()))
    pairs, worth = _aligned(misfits)
    assert abs(worth - best) < 1e-9
    assert abs(sum(gains[i, j] for i, j in pairs) - worth) < 1e-9
    assert all(i < k and j < h for (i, j), (k, h) in itertools.pairwise(pairs))
    if n and m:
        rows, columns = linear_sum_assignment(gains, maximize=True)
        assert worth <= gains[rows, columns].sum() + 1e-9


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.5), st.floats(0.0, 0.4))
def test_noise_and_lost_photos_never_tie_a_view_to_another_ones_photo(seed: int, noise_m: float, lost: float) -> None:
    rng = np.random.default_rng(seed)
    plan: Plan = make_plan([(ring(24, 30.0), {})])
    (record,) = flown_as_planned(plan)
    kept = tuple(
        moved(photo, tuple(rng.normal(0.0, noise_m, 3).clip(-1.0, 1.0)), float(rng.normal(0.0, 1.0)))
        for photo in record.photos
        if rng.random() >= lost
    )
    matching = match_flight(plan, (replace(record, photos=kept),))
    for match, original in zip(matching.views, record.photos, strict=True):
        is_kept = any(photo.index == original.index for photo in kept)
        assert match.reason in ((Reason.TAKEN,) if is_kept else (Reason.NO_PHOTO, Reason.REPORT_LOST))
        if match.photo is not None:
            assert kept[match.photo.photo].index == original.index


def unheard(record: FlightRecord, first: int, last: int) -> FlightRecord:
    """A flight of which nothing was heard from behind one photo to shortly before another."""
    track, photos = record.track, record.photos
    keep = (track.time_s <= photos[first].time_s + 0.5) | (track.time_s >= photos[last].time_s - 0.5)
    names = Track.__dataclass_fields__
    heard = Track(**{name: getattr(track, name)[keep] for name in names})
    return replace(record, track=heard, photos=photos[: first + 1] + photos[last:])


def test_photos_taken_while_the_link_was_lost_are_told_as_lost_where_the_camera_counted_them() -> None:
    silent = unheard(FLOWN[0], 1, 4)
    matching = match_flight(PLAN, (silent, FLOWN[1]))
    assert reasons(matching)[:6] == ["taken"] * 2 + ["report-lost"] * 2 + ["taken"] * 2
    fewer = with_photos(silent, lambda p: (*p[:2], *(replace(photo, index=photo.index - 1) for photo in p[2:])))
    assert "report-lost" not in reasons(match_flight(PLAN, (fewer, FLOWN[1])))
    there = replace(FLOWN[0].track, position_enu_m=FLOWN[0].track.position_enu_m + np.array([0.0, 0.0, 30.0]))
    elsewhere = match_flight(PLAN, (replace(silent, track=there), FLOWN[1]))
    assert reasons(elsewhere)[:6] == ["taken"] * 2 + ["not-reached"] * 2 + ["taken"] * 2


@pytest.mark.parametrize("source", ["camera-feedback", "image-captured"])
def test_a_gap_in_the_cameras_count_tells_photos_whose_report_was_lost(source: str) -> None:
    heard = with_photos(FLOWN[0], lambda p: tuple(replace(photo, source=source) for photo in (*p[:2], *p[4:])))
    matching = match_flight(PLAN, (heard, FLOWN[1]))
    assert reasons(matching) == ["taken"] * 2 + ["report-lost"] * 2 + ["taken"] * 6
    assert n_lost(heard) == 2


def test_a_photo_that_was_never_taken_leaves_no_gap() -> None:
    silent = never_taken(FLOWN[0], 2, 3)
    assert reasons(match_flight(PLAN, (silent, FLOWN[1])))[2:4] == ["no-photo"] * 2
    assert n_lost(silent) == 0


def test_which_of_two_views_was_photographed_is_not_guessed() -> None:
    """Two views without a photo, one number left out: either may be the one."""
    one_short = with_photos(FLOWN[0], lambda p: (*p[:2], *(replace(photo, index=photo.index - 1) for photo in p[4:])))
    assert reasons(match_flight(PLAN, (one_short, FLOWN[1])))[2:4] == ["no-photo"] * 2
    assert n_lost(one_short) == 1


def test_a_failure_that_the_camera_told_of_is_no_lost_report() -> None:
    failed = FlightEvent(FLOWN[0].photos[2].time_s, "camera-failed", "the camera says that photo 3 failed")
    heard = replace(with_photos(FLOWN[0], lambda p: p[:2] + p[3:]), events=(failed,))
    assert reasons(match_flight(PLAN, (heard, FLOWN[1])))[2] == "no-photo"
    assert n_lost(heard) == 0


def test_photos_heard_in_between_are_not_counted_as_lost() -> None:
    """One report is lost, and a photo of no view was told of: the gap is one, not two."""
    first, second, third = FLOWN[0].photos[:3]
    stray = replace(second, index=second.index + 1, position_enu_m=(30.0, -30.0, 27.0), time_s=third.time_s - 1.0)

    def spoil(photos: tuple[TakenPhoto, ...]) -> tuple[TakenPhoto, ...]:
        return (first, stray, *(replace(photo, index=photo.index + 1) for photo in photos[2:]))

    heard = with_photos(FLOWN[0], spoil)
    assert reasons(match_flight(PLAN, (heard, FLOWN[1])))[:3] == ["taken", "report-lost", "taken"]


@pytest.mark.parametrize("source", ["log", "photo-file", "simulation"])
def test_numbers_of_files_and_logs_may_have_gaps_of_their_own(source: str) -> None:
    gap = with_photos(FLOWN[0], lambda p: tuple(replace(photo, source=source) for photo in (*p[:2], *p[4:])))
    assert reasons(match_flight(PLAN, (gap, FLOWN[1])))[2:4] == ["no-photo"] * 2
    assert n_lost(gap) == 0


def test_the_log_of_the_same_flight_fills_what_the_radio_lost() -> None:
    heard = with_photos(FLOWN[0], lambda p: (*p[:2], *p[4:]))
    logged = with_photos(FLOWN[0], lambda p: tuple(replace(photo, source="log") for photo in p))
    assert reasons(match_flight(PLAN, (logged, FLOWN[1]))) == ["taken"] * 10
    assert reasons(match_flight(PLAN, (heard, logged, FLOWN[1]))) == ["taken"] * 10


@given(st.sets(st.integers(1, 4)), st.integers(0, 60000))
def test_what_is_taken_and_what_is_lost_add_up(lost: set[int], first: int) -> None:
    """Whatever is lost between the first and the last photo is found, and nothing else."""
    heard = with_photos(
        FLOWN[0],
        lambda p: tuple(replace(photo, index=first + i) for i, photo in enumerate(p) if i not in lost),
    )
    found = reasons(match_flight(PLAN, (heard, FLOWN[1])))[:6]
    assert found == ["report-lost" if i in lost else "taken" for i in range(6)]
    assert n_lost(heard) == len(lost)
