"""The Reconstruct tab: what can be done when, what is said, and what the process is told."""

import json
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from groundstation.services.jobs.channel import ProcessEnded
from groundstation.services.project.steps import Act, Step, guidance
from groundstation.services.reconstruct.messages import (
    AskScene,
    CancelTraining,
    Chosen,
    Devices,
    Ended,
    FirstLook,
    Measured,
    Pause,
    PhotoError,
    Stage,
    Stepped,
    Stop,
    Subject,
    Train,
    ViewAnswer,
    ViewRequest,
    WatchErrors,
)
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.findings import Severity
from tests.cli.test_photos_without_a_site import write_project
from tests.gui.driving import choose, clicked, escape, shut, turn_until

TRAINING = Subject("training")
STEP = Stepped("training", 12, 30.0, 0.1, 45.0, 970, {"colour": 0.2, "high frequency": 0.5})


def take(page, *messages):
    for message in messages:
        page.controller._take(message)


def begin(page):
    page.side.train.click()
    return page.told.of(Train)[-1]


def enabled(page):
    side = page.side
    names = ("train", "pause", "stop", "cancel_training", "choose", "choose_out")
    return {name for name in names if getattr(side, name).isEnabled()} | ({"form"} if side.form.isEnabled() else set())


@pytest.mark.slow
def test_without_a_data_set_it_says_what_to_do(page):
    assert enabled(page) == {"choose", "choose_out", "form"}
    assert "Choose a data set" in page.pane.view.note()
    assert page.side.data_set.text() == "None is chosen."


def test_a_folder_that_is_no_data_set_is_told_and_can_be_followed_by_one_that_is(application, page, data, tmp_path):
    page.controller.read(tmp_path)
    turn_until(application, lambda: not page.controller.is_reading and bool(page.messages))
    assert page.messages[-1].severity is Severity.ERROR
    assert "has no dataset.json" in page.messages[-1].text
    page.controller.read(data)
    turn_until(application, lambda: page.controller.card is not None)
    assert "6 photos" in page.side.data_set.text()
    assert page.side.train.isEnabled()


def test_a_folder_of_colmap_is_made_a_data_set_of_plain_splats(application, page, tmp_path):
    write_project(tmp_path / "wall")
    page.controller.read(tmp_path / "wall")
    turn_until(application, lambda: page.controller.card is not None)
    assert page.controller.card.folder == tmp_path / "wall.dataset"
    assert "plain splats" in page.messages[-1].text
    assert any("one unit of it counts as" in each.text for each in page.messages)
    assert page.controller.choice.method == page.side.form.value().method == "3dgs"
    assert page.side.train.isEnabled()
    assert "Some unseen views" in headings(page)


def headings(page):
    from PySide6.QtWidgets import QLabel

    return [label.text() for label in page.progress.findChildren(QLabel)]


def test_a_chosen_data_set_is_shown_and_its_first_photo_looked_at(chosen):
    assert len(chosen.pane.strip.names()) == 6
    assert "Facades of some unseen views" in headings(chosen)
    assert chosen.pane.strip.current() == chosen.pane.strip.names()[0]
    look = chosen.told.of(ViewRequest)[-1]
    assert (look.place, look.subject.kind, look.subject.name) == ("right", "photo", chosen.pane.strip.current())
    assert look.camera.intrinsics.is_straight
    assert "The model is shown here once it learns" in chosen.pane.view.note()


def test_a_training_goes_from_preparing_to_its_end_and_buttons_follow(chosen, tmp_path):
    assert not chosen._context.is_busy
    ongoing = []
    chosen._context.ongoingChanged.connect(ongoing.append)
    told = begin(chosen)
    assert chosen._context.is_busy, "nothing may hold the window up that can wait"
    assert (told.dataset, told.out, told.resume) == (chosen.controller.card.folder, tmp_path / "model", False)
    assert enabled(chosen) == {"pause", "stop", "cancel_training"}
    assert chosen.details.currentWidget() is chosen.progress
    take(chosen, Stage("learning reflections", 3, 80))
    assert chosen.progress.text() == "Learning reflections"
    chosen.controller.training.begun_s -= 65.0
    take(chosen, Stage("learning reflections", 4, 80))
    assert 65.0 <= ongoing[-1].elapsed_s < 95.0
    longest_s = chosen.controller.choice.longest_s
    assert ongoing[-1].elapsed_s + ongoing[-1].remaining_s == pytest.approx(longest_s)
    assert ongoing[-1].share == pytest.approx(ongoing[-1].elapsed_s / longest_s), "one bar for all stages"
    chosen.side.pause.click()
    waiting_s = chosen.controller.training.elapsed_s
    chosen.controller.training.waits_since_s -= 40.0
    chosen.side.pause.click()
    assert chosen.controller.training.elapsed_s == pytest.approx(waiting_s - 40.0, abs=5.0), (
        "while it waits no time goes"
    )
    assert "The model is shown here once it learns" in chosen.pane.view.note()
    take(chosen, STEP)
    assert chosen.told.of(ViewRequest)[-1].subject == TRAINING
    take(chosen, STEP, Measured(30.0, 21.5))
    assert "12 steps, 970 splats; 21.50 dB" in chosen.progress.text()
    assert ongoing[-1].remaining_s == STEP.left_s
    assert ongoing[-1].share == pytest.approx(STEP.seconds / (STEP.seconds + STEP.left_s))
    chosen.side.pause.click()
    assert chosen.told.of(Pause)[-1].is_on
    assert chosen.side.pause.text() == "Resume"
    assert "Paused" in chosen.progress.text()
    chosen.side.pause.click()
    assert not chosen.told.of(Pause)[-1].is_on
    chosen.side.stop.click()
    assert len(chosen.told.of(Stop)) == 1
    assert enabled(chosen) == {"cancel_training"}
    assert "rates fall" in chosen.progress.text()
    chosen._context.note(is_model_open=True)  # another one, on the Model tab
    take(chosen, Ended("done", None, {}))
    assert guidance(Step.MODEL, chosen._context.milestones).act is Act.OPEN_MODEL
    assert enabled(chosen) == {"train", "choose", "choose_out", "form"}
    assert "finished" in chosen.progress.text()
    assert "The model is written" in chosen.messages[-1].text
    # It can be looked at all the same.
    assert chosen.pane.bar.value()[0] == ""
    assert chosen.pane.bar.model.itemText(0) == "trained last"


def test_what_a_training_begins_with_is_shown_before_its_first_step_each_time_there_is_more(chosen):
    begin(chosen)
    take(chosen, Stage("learning reflections", 0, 80))
    assert TRAINING not in [look.subject for look in chosen.told.of(ViewRequest)]
    for n_looks in (1, 2):
        take(chosen, FirstLook())
        looks = [look for look in chosen.told.of(ViewRequest) if look.subject == TRAINING]
        assert len(looks) == n_looks
        answer = ViewAnswer(looks[-1], np.zeros((12, 16, 3), np.uint8), seconds=0.1)
        chosen.controller.viewAnswered.emit(answer)
    assert chosen.pane.view._words[0] == "before the first step"
    assert chosen.pane.bar.model.itemText(0) == "in training"
    assert not chosen.pane.pictures_in_view._again.isActive(), "nothing changes by itself yet"
    take(chosen, Ended("kept"))
    assert not chosen.controller.has_model


def test_stopped_before_there_is_a_model_it_says_when_it_stops(chosen):
    begin(chosen)
    take(chosen, Stage("learning reflections", 3, 80))
    chosen.side.stop.click()
    assert chosen.progress.text() == "Stops as soon as there is a model: learning reflections"


def test_broken_off_it_offers_to_go_on_with_what_was_begun(chosen, tmp_path):
    begin(chosen)
    take(chosen, STEP)
    chosen.side.cancel_training.click()
    assert len(chosen.told.of(CancelTraining)) == 1
    assert enabled(chosen) == set()
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "checkpoint.safetensors").write_bytes(b"")
    take(chosen, Ended("kept"))
    assert "resume it" in chosen.messages[-1].text
    assert chosen.side.train.text() == "Resume"
    assert "form" not in enabled(chosen)
    assert begin(chosen).resume


def test_an_error_is_told_and_the_tab_is_ready_again(chosen):
    begin(chosen)
    take(
        chosen, Ended("failed", InputError("x: shows other panels; name the data set that the training was begun with"))
    )
    assert chosen.messages[-1].severity is Severity.ERROR
    assert "shows other panels" in chosen.messages[-1].text
    assert "failed" in chosen.progress.text()
    assert "train" in enabled(chosen)
    begin(chosen)
    take(chosen, Ended("failed", ZeroDivisionError("by nothing")))
    assert "please report it" in chosen.messages[-1].text


def test_a_process_that_ends_by_itself_is_an_error_message_and_not_the_end(chosen):
    begin(chosen)
    take(chosen, STEP, ProcessEnded(-signal.SIGKILL))
    assert "memory ran out" in chosen.messages[-1].text
    assert "train" in enabled(chosen)
    n_messages = len(chosen.messages)
    take(chosen, ProcessEnded(0))
    assert len(chosen.messages) == n_messages


def test_what_stands_in_the_folder_is_said(chosen, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    (other / "letter").write_text("")
    chosen.controller.choose_out(other)
    assert "something else" in chosen.side.there.text()
    (other / "model.json").write_text("{}")
    chosen.controller.check_folders()
    assert "finished model" in chosen.side.there.text()


def test_the_scene_is_asked_and_its_decisions_are_shown_and_overruled(chosen):
    chosen.light.ask.click()
    assert isinstance(chosen.told.messages[-1], AskScene)
    assert not chosen.side.train.isEnabled()
    near = Decision("near-field light", True, "scene", "mirror images", 2.0, 0.3, "dB", 1.0)
    take(chosen, Chosen("radiance-grid", (near,)), Ended("done"))
    assert "The scene calls for: near things" in chosen.light.text()
    assert "near-field light" in chosen.light.effects.card("near-field light").text()
    assert chosen.side.train.isEnabled()
    chosen.light.light.setCurrentIndex(chosen.light.light.findData("mlp"))
    assert begin(chosen).request.light == "mlp"


def test_a_method_that_has_its_own_light_says_so(chosen):
    chosen.side.form.method.setCurrentIndex(chosen.side.form.method.findData("refglass-gs"))
    assert chosen.light.light.itemText(0) == "as the method has it: network by place and direction (paper)"
    assert begin(chosen).request.light is None
    take(chosen, Chosen("mlp", ()))
    assert chosen.light.text() == "It is learned as: network by place and direction (paper)."


def test_a_method_without_panels_has_no_light_to_choose(chosen):
    chosen.side.form.method.setCurrentIndex(chosen.side.form.method.findData("2dgs"))
    assert not chosen.light.light.isEnabled()
    assert not chosen.light.ask.isEnabled()
    request = begin(chosen).request
    assert (request.method, request.light) == ("2dgs", None)


def test_the_computer_page_says_what_is_there_and_what_follows(chosen):
    take(chosen, Devices(()))
    texts = [label.text() for label in chosen._machine_lines if not label.isHidden()]
    assert any("cores" in text for text in texts)
    assert any("No graphics card" in text for text in texts)
    assert any("6 photos of 40 x 30 pixels" in text for text in texts)
    assert not chosen.side.form._form.isRowVisible(chosen.side.form.device)
    take(chosen, Devices((), ("Intel UHD 620 (Vulkan)",)))
    texts = [label.text() for label in chosen._machine_lines if not label.isHidden()]
    assert any("Graphics card: Intel UHD 620 (Vulkan). It draws splats where" in text for text in texts)
    take(chosen, Devices(("H200, 141 GiB",)))
    assert chosen.side.form._form.isRowVisible(chosen.side.form.device)
    chosen.side.form.device.setCurrentIndex(1)
    assert begin(chosen).request.device == "cuda"


def test_short_memory_and_a_full_disk_are_told_before_it_starts(chosen):
    chosen.controller.machine = replace(chosen.controller.machine, free_bytes=100 << 20)
    chosen.controller.standing = replace(chosen.controller.standing, free_bytes=5 << 20)
    chosen.controller.stateChanged.emit()
    words = chosen.side.wrong.text()
    assert "Memory is short" in words
    assert "5 MiB are free on the disk" in words
    assert not chosen.side.wrong.isHidden()
    assert begin(chosen).request.memory_bytes < 1 << 30


def test_a_data_set_of_another_site_is_told(application, page, data, controller):
    from tests.planning.plan_cases import kiosk

    before = controller.context.document
    controller.context.amend(replace(before, site=kiosk()))
    try:
        page.controller.read(data)
        turn_until(application, lambda: page.controller.card is not None)
        assert page.messages[-1].severity is Severity.WARNING
        assert "other panels than the site that is open" in page.messages[-1].text
        assert page.side.train.isEnabled()
    finally:
        controller.context.amend(before)


def test_photos_are_judged_and_sorted_the_worst_first(application, chosen):
    begin(chosen)
    names = chosen.pane.strip.names()
    take(chosen, *(PhotoError(TRAINING, name, 20.0 + (k * 7) % 5) for k, name in enumerate(names)))
    take(chosen, PhotoError(Subject("model", Path("other")), names[0], 99.0))
    turn_until(application, lambda: bool(chosen.pane.strip.errors()))
    assert "20.00 dB" in chosen.pane.strip.words(chosen.pane.strip.photos()[0])
    chosen.pane.worst.click()
    worst = [20.0 + (names.index(name) * 7) % 5 for name in chosen.pane.strip.names()]
    assert worst == sorted(worst)
    assert chosen.pane.strip.current() == names[0]


def test_a_photo_that_is_judged_later_takes_its_place_among_the_worst(application, chosen):
    begin(chosen)
    names = chosen.pane.strip.names()
    chosen.pane.worst.click()
    take(chosen, *(PhotoError(TRAINING, name, 30.0) for name in names[:-1]))
    turn_until(application, lambda: len(chosen.pane.strip.errors()) == len(names) - 1)
    take(chosen, PhotoError(TRAINING, names[-1], 12.0))
    turn_until(application, lambda: chosen.pane.strip.names()[0] == names[-1])


def test_when_it_pauses_it_is_looked_at_once_more(application, chosen):
    begin(chosen)
    take(chosen, STEP)
    turn_until(application, lambda: answered(chosen) and chosen.pane.pictures_in_view.is_at_rest())
    n_looks = len(chosen.told.of(ViewRequest))
    chosen.side.pause.click()
    assert len(chosen.told.of(ViewRequest)) == n_looks + 1
    assert chosen.told.of(ViewRequest)[-1].subject == TRAINING


def answered(page):
    """Answer what was asked; True."""
    for look in page.told.of(ViewRequest):
        take(page, seen(look))
    return True


def seen(look, seconds=0.01, **more):
    lens = look.camera.intrinsics
    return ViewAnswer(look, np.zeros((lens.height_px, lens.width_px, 3), np.uint8), seconds=seconds, **more)


def test_while_the_camera_is_led_only_the_newest_wish_is_asked_for(application, chosen):
    begin(chosen)
    take(chosen, STEP)
    looks = [look for look in chosen.told.of(ViewRequest) if look.subject == TRAINING]
    before = len(looks)
    for _ in range(20):
        chosen.pane.view.orbited.emit(0.05, 0.0)
    looks = [look for look in chosen.told.of(ViewRequest) if look.subject == TRAINING]
    # One was on its way already; none is added until it is back.
    assert len(looks) == before
    take(chosen, seen(looks[-1], seconds=2.0, depth_m=9.0))
    looks = [look for look in chosen.told.of(ViewRequest) if look.subject == TRAINING]
    assert len(looks) == before + 1
    newest = looks[-1]
    np.testing.assert_allclose(newest.camera.pose.position_enu_m, chosen.pane.camera().pose.position_enu_m)
    coarse_px = newest.camera.intrinsics.width_px
    take(chosen, seen(newest, seconds=2.0, depth_m=9.0))
    turn_until(application, lambda: len([x for x in chosen.told.of(ViewRequest) if x.subject == TRAINING]) > before + 1)
    fine = chosen.told.of(ViewRequest)[-1]
    assert fine.camera.intrinsics.width_px > 2 * coarse_px
    np.testing.assert_array_equal(fine.camera.pose.cam_from_enu, newest.camera.pose.cam_from_enu)


def test_a_look_that_another_window_has_replaced_is_asked_for_again(chosen):
    begin(chosen)
    take(chosen, STEP)
    lost = next(look for look in reversed(chosen.told.of(ViewRequest)) if look.place == "left")
    n_looks = len(chosen.told.of(ViewRequest))
    take(chosen, seen(replace(lost, number=lost.number - 1)))
    assert len(chosen.told.of(ViewRequest)) == n_looks
    take(chosen, seen(replace(lost, number=lost.number + 1000)))
    again = chosen.told.of(ViewRequest)[-1]
    assert (again.place, again.subject) == ("left", TRAINING)
    assert len(chosen.told.of(ViewRequest)) == n_looks + 1


def test_an_answer_to_an_older_view_of_something_else_is_not_shown(chosen):
    begin(chosen)
    take(chosen, STEP)
    old = next(look for look in reversed(chosen.told.of(ViewRequest)) if look.subject == TRAINING)
    chosen.controller.training.stepped = None
    chosen.controller.phase = type(chosen.controller.phase).IDLE
    chosen.pane.offer_models()
    take(chosen, seen(old))
    assert chosen.pane.view.pictures()[0] is None


def test_the_photo_is_beside_the_model_from_its_own_place_only(chosen):
    begin(chosen)
    take(chosen, STEP)
    pane = chosen.pane
    pane.bar.setValue("", "picture", "photo")
    for place in ("left", "right"):
        look = next(each for each in reversed(chosen.told.of(ViewRequest)) if each.place == place)
        take(chosen, seen(look))
    assert all(picture is not None for picture in pane.view.pictures())
    assert not pane.line.isHidden()
    pane.line.setValue(250)
    assert pane.view.value() == 0.25
    pane.view.setValue(0.75)
    assert pane.line.value() == 750
    pane.view.moved.emit(0.1, 0.0, 0.0)
    assert pane.view.pictures()[1] is None
    assert "0 goes back" in pane.view.note()
    pane.view.homeRequested.emit()
    assert "0 goes back" not in pane.view.note()


def test_finished_models_of_the_data_set_are_compared(application, chosen, tmp_path):
    panels = [{"corners_enu_m": each} for each in chosen.controller.card.source.panels.corners_enu_m.tolist()]
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        content = {"format": "reflight-model/1", "method": "2dgs", "n_splats": 5, "site": {"panels": panels}}
        (tmp_path / name / "model.json").write_text(json.dumps(content))
    chosen.controller.check_folders()
    turn_until(application, lambda: len(chosen.controller.others) == 2)
    bar = chosen.pane.bar
    assert "2DGS" in bar.model.itemText(0)
    bar.setValue(str(tmp_path / "one"), "normals", str(tmp_path / "two"))
    for place in ("left", "right"):
        # What was on its way before is for nothing now.
        take(chosen, seen(next(each for each in reversed(chosen.told.of(ViewRequest)) if each.place == place)))
    looks = chosen.told.of(ViewRequest)
    assert {look.place: look.subject.folder for look in looks[-2:]} == {
        "left": tmp_path / "one",
        "right": tmp_path / "two",
    }
    assert {look.layer for look in looks[-2:]} == {"normals"}
    assert chosen.pane.view._words == ("one (2DGS)", "two (2DGS)")
    assert chosen.told.of(WatchErrors)[-1].subject == Subject("model", tmp_path / "one")
    look = next(each for each in reversed(looks) if each.place == "left")
    take(chosen, ViewAnswer(look, None, problem=f"{tmp_path / 'one'}: holds no finished model"))
    assert "holds no finished model" in chosen.pane.view.note()


@pytest.mark.slow
def test_folders_are_chosen_and_nothing_happens_without_one(application, page, data, tmp_path):
    for no in ("Cancel", escape, shut):
        for button in (page.side.choose, page.side.choose_out):
            with clicked(no):
                button.click()
    assert page.controller.card is None
    assert page.messages == []
    with clicked(choose(data)):
        page.side.choose.click()
    turn_until(application, lambda: page.controller.card is not None and not page._context.jobs())
    with clicked(choose(tmp_path / "my model")):
        page.side.choose_out.click()
    turn_until(application, lambda: not page._context.jobs())
    assert page.controller.out == tmp_path / "my model"


@pytest.mark.slow
def test_closing_asks_while_a_model_is_trained_and_lets_the_process_go(chosen):
    from PySide6.QtGui import QCloseEvent

    begin(chosen)
    for no in ("Cancel", escape, shut):
        event = QCloseEvent()
        with clicked(no) as asked:
            chosen._window_closing(event)
        assert "Closing the window breaks the training off" in asked[0]
        assert not event.isAccepted()
        assert "closed" not in chosen.told.messages
    event = QCloseEvent()
    with clicked("Yes"):
        chosen._window_closing(event)
    assert event.isAccepted()
    assert chosen.told.messages[-1] == "closed"


@pytest.mark.slow
def test_as_a_user_trains_looks_around_and_stops(application, controller, data, tmp_path):
    """With the real process; the window's thread is never held for long."""
    import time

    controller.show()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.window.show_tab("reconstruct")
    page = controller.window.tab("reconstruct")
    page.controller.read(data)
    turn_until(application, lambda: page.controller.card is not None and page.controller.cuda is not None)
    page.controller.choose_out(tmp_path / "model")
    page.side.form.method.setCurrentIndex(page.side.form.method.findData("2dgs"))
    page.controller.choose_out(tmp_path / "model")
    page.side.train.click()
    longest = 0.0

    def turn(condition):
        nonlocal longest
        end = time.monotonic() + 240.0
        while not condition():
            begun = time.thread_time()
            application.processEvents()
            longest = max(longest, time.thread_time() - begun)
            time.sleep(0.002)
            assert time.monotonic() < end

    turn(lambda: page.controller.training.stepped is not None and page.controller.training.stepped.step > 5)
    for _ in range(20):
        page.pane.view.orbited.emit(0.02, 0.01)
        turn(lambda: page.pane.pictures_in_view._on_way == {} or True)
    turn(lambda: page.pane.view.pictures()[0] is not None and len(page.controller.errors) == 6)
    page.side.stop.click()
    turn(lambda: page.controller.phase.name == "IDLE")
    assert (tmp_path / "model" / "model.json").is_file()
    turn(page.pane.pictures_in_view.is_at_rest)
    assert page.pane.view.note() == ""
    assert longest < 0.05
