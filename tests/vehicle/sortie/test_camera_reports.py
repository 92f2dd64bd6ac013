"""Reports that the radio lost, asked for again by their index."""

import itertools

from groundstation.vehicle.sortie.sortie_run import ASK_EVERY_S, MAX_AT_ONCE, N_ASKS, CameraReports
from missions.mavlink.messages import Address, CameraCaptureStatus, CameraImageCaptured, Received

CAMERA = Address(1, 100)


def told(reports, *indices):
    for index in indices:
        message = CameraImageCaptured(0, 0, 0, 0, 0, 0, 0, (1.0, 0.0, 0.0, 0.0), index, 1)
        reports.receive(Received(message, CAMERA, 0.0))


def counted(reports, count):
    reports.receive(Received(CameraCaptureStatus(0, image_count=count), CAMERA, 0.0))


def asked(reports, until_s=30.0):
    """Everything asked for: time, message and index."""
    found = []
    for tick in range(round(until_s / 0.25)):
        now_s = 0.25 * tick
        found += [
            (now_s, command.param1, command.param2, command.target_component) for command in reports.tick(now_s, 1)
        ]
    return found


def test_nothing_is_asked_for_while_every_photo_is_told_of():
    reports = CameraReports()
    told(reports, 0, 1, 2)
    assert asked(reports) == []
    assert reports.is_settled


def test_a_gap_is_asked_for_of_the_camera_until_it_is_told_of():
    reports = CameraReports()
    told(reports, 4, 7)
    assert [request[1:] for request in reports.tick(0.0, 1) and asked(reports, 0.5)] == []
    assert [command.param2 for command in reports.tick(ASK_EVERY_S, 1)] == [5.0, 6.0]
    told(reports, 6)
    later = reports.tick(2.0 * ASK_EVERY_S, 1)
    assert [(command.command, command.param1, command.param2) for command in later] == [(512, 263.0, 5.0)]
    assert later[0].target_component == CAMERA.component
    told(reports, 5)
    assert reports.is_settled


def test_what_is_never_told_of_is_given_up():
    reports = CameraReports()
    told(reports, 0, 2)
    times = [when for when, *_ in asked(reports)]
    assert len(times) == N_ASKS
    assert min(b - a for a, b in itertools.pairwise(times)) >= ASK_EVERY_S
    assert reports.is_settled


def test_the_count_after_the_flight_tells_of_photos_behind_the_last_one():
    reports = CameraReports()
    counted(reports, 3)
    told(reports, 4)
    counted(reports, 7)
    assert sorted({index for _, _, index, _ in asked(reports)}) == [3.0, 5.0, 6.0]


def test_when_no_photo_is_told_of_the_two_counts_tell():
    reports = CameraReports()
    counted(reports, 10)
    counted(reports, 12)
    assert sorted({index for _, _, index, _ in asked(reports)}) == [10.0, 11.0]


def test_the_count_is_asked_for_some_times_only_and_of_all_components():
    reports = CameraReports()
    reports.ask_count()
    found = asked(reports)
    assert [request[1:] for request in found] == [(262.0, 0.0, 0)] * N_ASKS
    assert reports.is_settled
    assert reports.count is None


def test_a_long_gap_is_asked_for_bit_by_bit_and_a_camera_that_counts_anew_is_no_gap():
    reports = CameraReports()
    told(reports, 0, 21)
    assert len(reports.tick(0.0, 1)) == MAX_AT_ONCE
    reports = CameraReports()
    told(reports, 0, 5000, 1)
    assert reports.is_settled
