"""Sending missions to cards and remote controllers: found by their folders, read back, and never half there."""

import errno
import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.mission import sending
from groundstation.services.mission.sending import (
    Payload,
    payload_of_files,
    payload_of_plan,
    route_name,
    send,
    targets_of,
)
from groundstation.services.mission.storages import (
    FLY_ROUTES,
    App,
    find_storages,
    mounted_volumes,
    storage_at,
)
from missions.formats.registry import read_missions
from planning.base.errors import InputError, MissionError
from planning.base.findings import Severity
from planning.plan import write_plan
from planning.site.bundled import SCENES
from tests.missions.plans import example_plan, make_plan, ring

IDS = ("1A2B3C4D-0000-4000-8000-00000000000A", "1A2B3C4D-0000-4000-8000-00000000000B")


@pytest.fixture(scope="module")
def unready():
    """Two sorties of a plan that hangs in the air, where no flight is ready."""
    model = SCENES["single-panel"]()
    plan = replace(example_plan(), origin=model.site.origin, home_enu_m=(3.0, -40.0, 1.5))
    site = replace(model.site, home_enu_m=(3.0, -40.0, 1.5))
    return payload_of_plan(plan, replace(model, site=site), "office.flight_2")


@pytest.fixture(scope="module")
def payload(unready):
    """The same as if it were ready: what is sent does not depend on a building."""
    return replace(unready, findings=tuple(each for each in unready.findings if each.code != "not-ready"))


@pytest.fixture(scope="module")
def one(payload):
    """The first sortie alone, as a file that somebody else made."""
    return replace(payload, contents=payload.contents[:1], missions=payload.missions[:1], plan=None, site_model=None)


@pytest.fixture
def controller(tmp_path, payload):
    """Storage of a remote controller with two routes of DJI Fly, the second one newer."""
    root = tmp_path / "RC2"
    for age_s, name in enumerate(reversed(IDS)):
        folder = root / FLY_ROUTES / name
        folder.mkdir(parents=True)
        (folder / f"{name}.kmz").write_bytes(b"old " + name.encode())
        os.utime(folder / f"{name}.kmz", (1e9 - age_s, 1e9 - age_s))
    (root / FLY_ROUTES / "map_preview" / IDS[0]).mkdir(parents=True)
    return root


@pytest.fixture
def card(tmp_path):
    folder = tmp_path / "CARD"
    folder.mkdir()
    return folder


def sent(payload, storage, tmp_path, *routes, **options):
    targets, findings = targets_of(payload, storage, routes, **options)
    return send(payload, storage, targets, tmp_path / "kept", clock=lambda: 0.0), findings


def test_what_is_sent_to_a_card_is_the_plan_when_it_is_read_there(payload, card, tmp_path):
    files, findings = sent(payload, storage_at(card), tmp_path)
    assert [each.path for each in files] == [card / "office-flight-2.kmz", card / "office-flight-2-2.kmz"]
    assert sorted(card.iterdir()) == sorted(each.path for each in files)
    assert [each.path.read_bytes() for each in files] == list(payload.contents)
    assert sum(mission.n_photos for each in files for mission in read_missions(each.path)) == 10
    assert [found.code for found in findings if found.code == "route-name"] == ["route-name"]


def test_a_plan_that_is_not_ready_is_sent_only_where_the_pilot_says_so(unready, card, tmp_path):
    with pytest.raises(
        MissionError, match=r"^not sent\. NOT ready to fly: v0006: viewpoints outside the airspace.*4 more"
    ) as no:
        sent(unready, storage_at(card), tmp_path)
    assert "--despite-errors" in str(no.value)
    assert not list(card.iterdir())
    prepared = sending.prepare_sending(unready, storage_at(card), ())
    assert (prepared.refusal, prepared.is_ready_to_fly) == ("", False)
    files, findings = sent(unready, storage_at(card), tmp_path, despite_errors=True)
    assert len(files) == 2
    (warned,) = (found for found in findings if found.code == "not-ready")
    assert warned.severity is Severity.WARNING


def test_the_same_mission_again_is_there_already_and_another_one_is_not_overwritten(payload, card, tmp_path):
    storage = storage_at(card)
    sent(payload, storage, tmp_path)
    assert all(each.was_there and each.backup is None for each in sent(payload, storage, tmp_path)[0])
    # On a card Office.kmz and office.kmz are one file.
    (card / "office-flight-2.kmz").rename(card / "OFFICE-flight-2.KMZ")
    (card / "OFFICE-flight-2.KMZ").write_bytes(b"another")
    with pytest.raises(InputError, match="another mission of this name is there"):
        targets_of(payload, storage)
    files, _ = sent(payload, storage, tmp_path, may_replace=True)
    assert files[0].path == card / "OFFICE-flight-2.KMZ"
    assert files[0].backup.read_bytes() == b"another"
    assert len(list(card.iterdir())) == 2


def test_routes_of_dji_fly_are_replaced_in_place_and_kept(payload, controller, tmp_path):
    storage = storage_at(controller)
    assert (storage.app, [route.id for route in storage.routes]) == (App.DJI_FLY, [IDS[1], IDS[0]])
    assert [route.n_waypoints for route in storage.routes] == [None, None]
    files, findings = sent(payload, storage, tmp_path, IDS[0].lower(), IDS[1])
    assert [each.path.stem for each in files] == list(IDS)
    assert [each.backup.read_bytes() for each in files] == [b"old " + name.encode() for name in IDS]
    assert {path.name for path in (controller / FLY_ROUTES).rglob("*.*")} == {f"{name}.kmz" for name in IDS}
    warned = {found.code for found in findings if found.severity is Severity.WARNING}
    assert {"route-replaced", "other-app"} <= warned
    assert [route.n_waypoints for route in storage_at(controller).routes] != [None, None]


@pytest.mark.parametrize(
    ("routes", "why"),
    [
        ((), "choose 2 of the 2 routes"),
        ((IDS[0],), "choose 2 of the 2 routes"),
        (("1A2B", IDS[1]), "2 begin so"),
        (("9", IDS[1]), "none begins so"),
        (("", IDS[1]), "expected the beginning of one route's id"),
        ((IDS[0], IDS[0]), "named twice"),
    ],
)
def test_routes_to_replace_are_named_exactly_and_never_guessed(payload, controller, routes, why):
    with pytest.raises(InputError, match=why):
        targets_of(payload, storage_at(controller), routes)


def test_a_route_that_others_wrote_goes_as_it_is(one, card, tmp_path):
    path = tmp_path / "theirs.kmz"
    path.write_bytes(one.contents[0])
    theirs = payload_of_files([path])
    files, _ = sent(theirs, storage_at(card), tmp_path)
    assert files[0].path.read_bytes() == one.contents[0]
    with pytest.raises(InputError, match="routes are named for DJI Fly only"):
        targets_of(theirs, storage_at(card), ["1A2B"])


def test_other_files_are_refused_with_what_is_expected(tmp_path):
    from missions.formats.registry import encode, write_files

    plan = example_plan()
    path = write_files(encode(plan, None, None, "mavlink-plan"), tmp_path / "m.plan")[0]
    with pytest.raises(InputError, match=r"expected a plan or a DJI mission \(\.kmz\)"):
        payload_of_files([path])
    write_plan(tmp_path / "lonely.plan.json", plan)
    with pytest.raises(InputError, match="name its file, too"):
        payload_of_files([tmp_path / "lonely.plan.json"])


def test_a_plan_for_an_aircraft_of_others_is_not_sent():
    model = SCENES["single-panel"]()
    plan = make_plan([(ring(3), {})], origin=model.site.origin, profile_name="px4", home=model.site.home_enu_m)
    with pytest.raises(MissionError, match="DJI"):
        payload_of_plan(plan, model, "m")


# Devices that fail


def removed(path, *_):
    shutil.rmtree(path)
    raise OSError(errno.EIO, "Input/output error")


def test_a_card_that_is_pulled_out_gives_one_clear_line(payload, card, tmp_path, monkeypatch):
    storage = storage_at(card)
    targets, _ = targets_of(payload, storage)
    monkeypatch.setattr(sending.os, "fsync", lambda _file: removed(card))
    with pytest.raises(InputError, match=r"the device was removed, or no longer answers .*; connect it and send again"):
        send(payload, storage, targets, tmp_path / "kept")


@pytest.mark.parametrize(
    ("code", "why"),
    [(errno.ENOSPC, "is full"), (errno.EROFS, "locked by its slider"), (errno.EFBIG, "cannot be written")],
)
@pytest.mark.parametrize("nth", [0, 1])
def test_a_card_that_cannot_be_written_is_as_it_was(payload, controller, tmp_path, monkeypatch, code, why, nth):
    storage = storage_at(controller)
    targets, _ = targets_of(payload, storage, IDS)
    real, calls = os.replace, []

    def failing(source, target):
        calls.append(source)
        if len(calls) == nth + 1:
            raise OSError(code, os.strerror(code))
        return real(source, target)

    monkeypatch.setattr(Path, "replace", lambda self, target: failing(self, target))
    with pytest.raises(InputError, match=why):
        send(payload, storage, targets, tmp_path / "kept")
    for name in IDS:
        assert [path.name for path in (controller / FLY_ROUTES / name).iterdir()] == [f"{name}.kmz"]
        assert (controller / FLY_ROUTES / name / f"{name}.kmz").read_bytes() == b"old " + name.encode()


def test_what_comes_back_damaged_is_not_called_sent(payload, card, tmp_path, monkeypatch):
    storage = storage_at(card)
    targets, _ = targets_of(payload, storage)
    real = os.write
    monkeypatch.setattr(sending.os, "write", lambda file, view: real(file, bytes(view[:-1]) + b"#"))
    with pytest.raises(InputError, match=f"differs from byte {len(payload.contents[0]) - 1} on"):
        send(payload, storage, targets, tmp_path / "kept")
    assert list(card.iterdir()) == []


def test_a_mission_that_reads_otherwise_than_planned_is_not_called_sent(payload, card, tmp_path):
    moved = replace(payload.plan, viewpoints=tuple(replace(v, heading_deg=0.0) for v in payload.plan.viewpoints))
    with pytest.raises(InputError, match="not the plan when it is read; do not fly it"):
        sent(replace(payload, plan=moved), storage_at(card), tmp_path)


def test_too_little_space_is_said_before_anything_is_touched(payload, controller, tmp_path):
    storage = replace(storage_at(controller), free_bytes=1000)
    with pytest.raises(InputError, match=r"has 0\.0 MB free"):
        sent(payload, storage, tmp_path, *IDS)
    assert not (tmp_path / "kept").exists()


def test_what_was_left_half_written_before_is_removed(one, card, tmp_path):
    storage = storage_at(card)
    targets, _ = targets_of(one, storage)
    left = targets[0].path.with_name(sending.PART.format(targets[0].path.name))
    left.write_bytes(b"half")
    send(one, storage, targets, tmp_path / "kept")
    assert list(card.iterdir()) == [targets[0].path]


@pytest.mark.parametrize("fails", [False, True])
def test_by_mtp_files_are_deleted_and_written_anew(payload, controller, tmp_path, monkeypatch, fails):
    """Renaming over a file does not work there, and neither does syncing."""
    device = tmp_path / "gvfs" / "mtp:host=DJI_RC_2"
    device.mkdir(parents=True)
    shutil.move(controller, device / "Internal shared storage")
    storage = storage_at(device)
    assert storage.is_mtp
    assert storage.name == "DJI_RC_2 Internal shared storage"
    monkeypatch.setattr(Path, "replace", lambda *_: pytest.fail("renamed"))

    def unsynced(_file):
        raise OSError(errno.ENOTSUP, "Operation not supported")

    monkeypatch.setattr(sending.os, "fsync", unsynced)
    if fails:
        real = os.write
        n_writes = iter(range(100))
        # Backups are the first two files.
        monkeypatch.setattr(
            sending.os,
            "write",
            lambda file, view: real(file, bytes(view[:-9]) + b"#" * 9 if next(n_writes) == 3 else view),
        )
        with pytest.raises(InputError, match="not what was written"):
            sent(payload, storage, tmp_path, *IDS)
        content = [b"old " + name.encode() for name in IDS]
    else:
        sent(payload, storage, tmp_path, *IDS)
        content = list(payload.contents)
    assert [(storage.folder / name / f"{name}.kmz").read_bytes() for name in IDS] == content


# Where devices are


def test_mounted_volumes_of_each_system(tmp_path):
    made = [
        "media/me/CARD", "run/media/me/OTHER", "mnt/plain", "Volumes/CARD", "D:", "C:",
        f"run/user/{os.getuid()}/gvfs/mtp:host=DJI_RC_2/Internal shared storage",
        f"run/user/{os.getuid()}/gvfs/sftp:host=x/home",
    ]  # fmt: skip
    for name in made:
        (tmp_path / name).mkdir(parents=True)
    mounted = {tmp_path / name for name in ("media/me/CARD", "run/media/me/OTHER", "Volumes/CARD", "D:", "C:")}
    volumes = {
        system: [
            path.relative_to(tmp_path).as_posix() for path in mounted_volumes(system, tmp_path, mounted.__contains__)
        ]
        for system in ("linux", "darwin", "win32")
    }
    assert volumes == {"linux": [made[0], made[1], made[6]], "darwin": ["Volumes/CARD"], "win32": ["D:"]}


def test_controllers_come_first_and_what_vanishes_is_left_out(controller, card, tmp_path):
    pilot = tmp_path / "RC Plus"
    (pilot / "DJI/com.dji.industry.pilot").mkdir(parents=True)
    camera = tmp_path / "CAMERA"
    (camera / "DCIM").mkdir(parents=True)
    found = find_storages(lambda: iter((card, camera, pilot, controller, tmp_path / "gone")))
    assert [(each.name, each.app.value) for each in found] == [
        ("RC2", "dji-fly"), ("RC Plus", "pilot2"), ("CAMERA", "pilot2"), ("CARD", "pilot2"),
    ]  # fmt: skip
    assert [each.is_aircraft_card for each in found] == [False, False, True, False]


def test_the_folder_of_the_routes_itself_may_be_named(controller):
    for path in (controller, controller / FLY_ROUTES, controller / FLY_ROUTES / IDS[0]):
        storage = storage_at(path)
        assert (storage.root, storage.folder, len(storage.routes)) == (controller, controller / FLY_ROUTES, 2)


def test_flighthub_has_a_folder_of_its_own_which_is_made(one, card, tmp_path):
    files, _ = sent(one, storage_at(card, App.FLIGHTHUB), tmp_path)
    assert files[0].path.parent == card / "waylines"
    assert storage_at(card / "waylines", App.FLIGHTHUB).folder == card / "waylines"


def test_no_routes_no_folder(card, tmp_path):
    with pytest.raises(InputError, match="make one route in DJI Fly"):
        storage_at(card, App.DJI_FLY)
    with pytest.raises(InputError, match="no such folder or device"):
        storage_at(tmp_path / "nothing")


@given(st.text(max_size=100))
def test_names_are_such_as_the_apps_take(text):
    name = route_name(text)
    assert name
    assert len(name) <= sending.MAX_NAME
    assert not set(name) & set('<>:"/|?*._\\')
    assert name == name.strip(" -")
    assert route_name(name) == name


def test_a_payload_of_nothing_is_no_plan(tmp_path):
    (tmp_path / "x.kmz").write_bytes(b"PK\x03\x04 no archive")
    with pytest.raises(MissionError, match="no zip archive"):
        payload_of_files([tmp_path / "x.kmz"])
    assert Payload("x", (), ()).plan is None
