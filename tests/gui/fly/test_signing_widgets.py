"""The signing of a link in the window: the choice beside the address, the key's menu, and what becomes of both."""

import threading

import pytest

from groundstation.services.fly import signing
from groundstation.services.fly.connection import VehicleAt
from groundstation.services.fly.options import ConnectionChoice, LinkKind, choice_path, read_choice
from groundstation.services.project.document import Document, PlanEntry
from missions.mavlink.link import open_link
from missions.mavlink.messages import Address, Heartbeat, SetupSigning
from missions.mavlink.signing import KeyStore, Signer, key_from_passphrase
from tests.gui.driving import clicked, close_controller, escape, press, shut, turn_until, turn_until_idle, type_into
from tests.services.live_cases import planned

PASSPHRASE = "correct horse battery staple"
HEARTBEAT = Heartbeat(2, 3, 81, 0, 4)


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    monkeypatch.setattr(signing, "key_store", lambda: KeyStore(tmp_path, may_use_system=False))


class Autopilot:
    """The other end of a link: heartbeats, signed with the key that it has."""

    def __init__(self, key=None):
        self.key, self.ended = key, threading.Event()
        self.link = open_link("tcpin:127.0.0.1:0", Address(1, 1), None if key is None else Signer(key))
        self.url = f"tcp:127.0.0.1:{self.link.channel.port}"
        self.thread = threading.Thread(target=self._run)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        self.link.close()

    def _run(self):
        while not self.ended.is_set():
            self.link.send(HEARTBEAT)
            received = self.link.receive(0.1)
            if received is not None and isinstance(received.message, SetupSigning):
                key = bytes(received.message.secret_key)
                self.key = key if any(key) else None
                self.link.sign_with(None if self.key is None else Signer(self.key))


@pytest.fixture
def controller(application, worker):
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    model, plan = planned()
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    controller.window.show_tab("fly")
    turn_until_idle(application, controller)
    yield controller
    close_controller(controller)


@pytest.fixture
def page(controller):
    return controller.window.tab("fly")


def choose(application, controller, page, url):
    kind, _, address = url.partition(":")
    page.connection.setValue(ConnectionChoice(LinkKind(kind), address))
    page.connection.valueChanged.emit(page.connection.value())
    turn_until_idle(application, controller)


def act(application, controller, page, action, *steps):
    """Choose an action of the key's menu, and work the dialog that it brings up."""
    with clicked(*steps) as asked:
        page.connection.signing.action(action).trigger()
    turn_until_idle(application, controller)
    return asked[-1]


def typed(first, second=None, button="OK"):
    """A step: type a passphrase twice, and press a button."""

    def step(dialog):
        type_into(dialog.first, first)
        type_into(dialog.second, first if second is None else second)
        press(button)(dialog)

    return step


@pytest.mark.slow
def test_signed_is_remembered_for_each_address_and_offered_for_none_in_the_simulation(application, controller, page):
    box = page.connection
    assert box.signing.isHidden()
    choose(application, controller, page, "tcp:127.0.0.1:5760")
    assert not box.signing.isHidden()
    assert not box.value().is_signed
    box.signing.signed.click()
    assert box.value().is_signed
    box.address.setText("127.0.0.1:5770")
    box.address.editingFinished.emit()
    assert not box.signing.value()
    box.address.setText("127.0.0.1:5760")
    box.address.editingFinished.emit()
    assert box.signing.value()
    assert read_choice(choice_path()).is_signed
    box.signing.signed.click()
    assert read_choice(choice_path()).signed == ()
    turn_until_idle(application, controller)


@pytest.mark.slow
def test_a_key_is_set_given_withdrawn_and_forgotten_and_never_shown(application, controller, page):
    from groundstation.gui.fly.connection_box import KeyAction

    key, box = key_from_passphrase(PASSPHRASE), page.connection.signing
    with Autopilot() as vehicle:
        choose(application, controller, page, vehicle.url)
        assert box.text() == "This computer keeps no key yet."
        assert not box.action(KeyAction.GIVE).isEnabled()
        act(application, controller, page, KeyAction.SET, typed(PASSPHRASE))
        assert box.text() == "This computer keeps a key."
        asked = act(application, controller, page, KeyAction.GIVE, "Yes")
        assert f"The key goes to the vehicle at {vehicle.url}" in asked
        assert vehicle.key == key
        assert page.controller.choice.is_signed
        assert box.value()
        asked = act(application, controller, page, KeyAction.WITHDRAW, "Yes")
        assert f"The vehicle at {vehicle.url} forgets the key" in asked
        turn_until(application, lambda: vehicle.key is None)
        assert not page.controller.choice.is_signed
        asked = act(application, controller, page, KeyAction.FORGET, "Yes")
        assert "Forget the key on this computer?" in asked
    assert not box.action(KeyAction.FORGET).isEnabled()
    told = controller.window.messages.texts()
    assert "has the key, and signs with it" in told
    assert key.hex() not in told
    assert PASSPHRASE not in told


@pytest.mark.slow
def test_nothing_is_done_when_the_pilot_thinks_better_of_it(application, controller, page):
    from groundstation.gui.fly.connection_box import KeyAction

    signing.set_passphrase(PASSPHRASE)
    choose(application, controller, page, "tcp:127.0.0.1:1")
    for no in ("Cancel", escape, shut):
        for action in KeyAction:
            act(application, controller, page, action, no)
    act(application, controller, page, KeyAction.SET, typed("another long passphrase", button="Cancel"))
    assert signing.link_signer().key == key_from_passphrase(PASSPHRASE)
    assert "cannot be opened" not in controller.window.messages.texts()


@pytest.mark.slow
def test_a_vehicle_that_cannot_be_given_the_key_is_told_of(application, controller, page):
    from groundstation.gui.fly.connection_box import KeyAction

    signing.set_passphrase(PASSPHRASE)
    choose(application, controller, page, "tcp:127.0.0.1:1")
    act(application, controller, page, KeyAction.GIVE, "Yes")
    assert "tcp:127.0.0.1:1 cannot be opened" in controller.window.messages.texts()
    assert not page.controller.choice.is_signed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("vehicle_key", "is_signed", "words"),
    [
        (None, True, "does not sign what it sends"),
        (bytes(range(32)), True, "signs with another key"),
        (bytes(range(32)), False, "may not obey a link that is not signed"),
    ],
)
def test_ends_that_sign_otherwise_are_told_apart_in_words(application, controller, page, vehicle_key, is_signed, words):
    signing.set_passphrase(PASSPHRASE)
    with Autopilot(vehicle_key) as vehicle:
        choose(application, controller, page, vehicle.url)
        page.connection.set_signed(vehicle.url, is_signed)
        turn_until_idle(application, controller)
        page.connection.button.click()
        turn_until(application, lambda: words in controller.window.messages.texts())
        if is_signed:
            turn_until(application, lambda: words in page._phase.text())
        page.controller.disconnect_vehicle()
        turn_until(application, lambda: not page.controller.is_connected)


@pytest.mark.slow
def test_a_signed_link_without_a_key_says_so_and_closes(application, controller, page):
    choose(application, controller, page, "tcp:127.0.0.1:1")
    page.connection.signing.signed.click()
    turn_until_idle(application, controller)
    page.connection.button.click()
    turn_until(application, lambda: "there is no signing key" in controller.window.messages.texts())
    turn_until(application, lambda: not page.controller.is_connected)


def test_a_link_that_is_opened_again_goes_on_with_the_same_time_stamps():
    """A signer of its own each time would put the stamps a minute ahead with every attempt."""
    import time

    signing.set_passphrase(PASSPHRASE)
    from functools import cache

    connection = VehicleAt("udpout:127.0.0.1:14999", signer=cache(signing.link_signer))
    opened = [connection.open(None, time.perf_counter, lambda *_: None) for _ in range(2)]
    assert opened[0].link.signer is opened[1].link.signer
    assert all(one.is_signed for one in opened)
    for one in opened:
        one.link.close()


def test_a_passphrase_must_be_long_enough_and_typed_alike_twice(application):
    from PySide6.QtWidgets import QDialogButtonBox, QLineEdit

    from groundstation.gui.fly.signing_controller import PassphraseDialog

    dialog = PassphraseDialog()
    ok = dialog.buttons.button(QDialogButtonBox.StandardButton.Ok)
    assert dialog.first.echoMode() == QLineEdit.EchoMode.Password
    for first, second, may in (("short", "short", False), (PASSPHRASE, "other", False), (PASSPHRASE, PASSPHRASE, True)):
        dialog.first.setText(first)
        dialog.second.setText(second)
        assert ok.isEnabled() is may
        assert bool(dialog.problem()) is not may
    assert dialog.value() == PASSPHRASE
    dialog.deleteLater()
