"""Corrections of casters over TLS: certificates that are trusted, and words for those that are not."""

import shutil
import socket
import ssl
import subprocess
import threading
import time

import pytest

from groundstation.services.fly.corrections import Corrections
from missions.mavlink.link import TlsChannel, tls_problem
from missions.mavlink.ntrip import Caster
from missions.mission.model import GeoPoint
from planning.base.errors import LinkError, LinkRejected
from tests.missions.mavlink.test_rtk import EXAMPLE
from tests.services.fly.test_corrections import until

PLACE = GeoPoint(22.3372, 114.2636, 62.0)

pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl, which makes certificates, is missing")


@pytest.fixture(scope="module")
def pems(tmp_path_factory):
    """Certificate and key for 127.0.0.1, and for another name, each signed by itself."""
    folder = tmp_path_factory.mktemp("tls")
    found = {}
    for name, subject in (("here", "IP:127.0.0.1"), ("other", "DNS:rtk.example.org")):
        paths = folder / f"{name}.pem", folder / f"{name}.key"
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
             "-days", "2", "-subj", f"/CN={name}", "-addext", f"subjectAltName={subject}",
             "-out", paths[0], "-keyout", paths[1]],
            check=True, capture_output=True,
        )  # fmt: skip
        found[name] = paths
    return found


class Server:
    """A caster on this machine that answers every connection in the same way, over TLS where it has a certificate."""

    def __init__(self, pem, *answer, greeting=b""):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port, self.asked, self.n = self.server.getsockname()[1], [], 0
        self.context = None
        if pem is not None:
            self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            self.context.load_cert_chain(*pem)
        self.answer, self.greeting = answer, greeting
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self):
        while True:
            try:
                plain, _ = self.server.accept()
            except OSError:
                return
            self.n += 1
            plain.settimeout(5.0)
            try:
                if self.context is None:
                    plain.recv(4096)
                    plain.sendall(self.greeting)
                    plain.close()
                    continue
                with self.context.wrap_socket(plain, server_side=True) as connection:
                    asked = b""
                    while b"\r\n\r\n" not in asked:
                        asked += connection.recv(4096)
                    self.asked.append(asked)
                    for piece in self.answer:
                        connection.sendall(piece)
                    time.sleep(0.2)
            except OSError:
                plain.close()

    def close(self):
        self.server.close()


@pytest.fixture
def serve():
    servers = []

    def begin(*arguments, **options):
        servers.append(Server(*arguments, **options))
        return servers[-1]

    yield begin
    for server in servers:
        server.close()


def trusting(pem):
    return ssl.create_default_context(cafile=str(pem[0]))


def test_corrections_come_over_tls_and_the_password_is_not_readable(serve, pems):
    server = serve(pems["here"], b"ICY 200 OK\r\n\r\n", EXAMPLE)
    context = trusting(pems["here"])
    found = Corrections(
        Caster("127.0.0.1", server.port, "VRS", "me", is_tls=True), "pass", PLACE,
        connect=lambda host, port: TlsChannel(host, port, context),
    )  # fmt: skip
    found.start()
    until(lambda: found.status().types == (1005,))
    found.close()
    found._thread.join(5.0)
    assert b"Authorization: Basic" in server.asked[0]


def test_the_file_that_the_environment_names_is_trusted_and_a_caster_with_tls_is_asked_over_it(
    serve, pems, monkeypatch
):
    monkeypatch.setenv("SSL_CERT_FILE", str(pems["here"][0]))
    server = serve(pems["here"], b"ICY 200 OK\r\n\r\n", EXAMPLE)
    found = Corrections(Caster("127.0.0.1", server.port, "VRS", is_tls=True), "", PLACE)
    found.start()
    until(lambda: found.status().types == (1005,))
    found.close()
    found._thread.join(5.0)


@pytest.mark.parametrize(
    ("pem", "trusted", "words"),
    [
        ("here", None, "nobody whom this computer trusts vouches for its certificate"),
        ("other", "other", "its certificate is for another name than '127.0.0.1'"),
        (None, None, "it speaks no TLS at this port: ask for its TLS port, or leave ntrips:// out"),
    ],
)
def test_what_is_none_to_trust_is_said_and_not_asked_again(serve, pems, pem, trusted, words):
    server = serve(None if pem is None else pems[pem], greeting=b"HTTP/1.1 400 Bad Request\r\n\r\n")
    context = ssl.create_default_context() if trusted is None else trusting(pems[trusted])
    found = Corrections(
        Caster("127.0.0.1", server.port, "VRS", "me", is_tls=True), "secret", PLACE,
        connect=lambda host, port: TlsChannel(host, port, context),
    )  # fmt: skip
    found.start()
    until(lambda: not found._thread.is_alive())
    assert words in found.status().problem
    assert server.asked == []
    assert server.n == 1


def test_a_caster_that_hangs_up_or_says_nothing_is_no_matter_of_certificates(serve, pems):
    server = serve(None)
    with pytest.raises(LinkError) as caught:
        TlsChannel("127.0.0.1", server.port, trusting(pems["here"]))
    assert "TLS" in str(caught.value)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (10, "its certificate is over: is the clock of this computer right?"),
        (9, "its certificate is not valid yet: is the clock"),
        (23, "was revoked"),
        (62, "another name than 'h'"),
        (64, "another name than 'h'"),
        (20, "SSL_CERT_FILE"),
        (99, "its certificate is refused (odd)"),
    ],
)
def test_each_fault_of_a_certificate_has_words_that_say_what_to_do(code, words):
    error = ssl.SSLCertVerificationError()
    error.verify_code, error.verify_message = code, "odd"
    assert words in tls_problem(error, "h")


def test_bytes_that_were_decrypted_already_are_read_at_once(serve, pems):
    """One record holds more than one read takes: no socket becomes ready for the rest."""
    server = serve(pems["here"], b"x" * 16000)
    channel = TlsChannel("127.0.0.1", server.port, trusting(pems["here"]))
    channel.write(b"GET / HTTP/1.1\r\n\r\n")
    got = b""
    while len(got) < 16000:
        chunk = channel.read(2.0)
        assert chunk is not None
        got += chunk.data
    assert got == b"x" * 16000
    until(lambda: _is_closed(channel))
    channel.close()


def _is_closed(channel):
    try:
        channel.read(0.1)
    except LinkRejected:
        raise
    except LinkError:
        return True
    return False
