"""Online tiles from a server of our own on this computer: consent, politeness, the disk, and hostile answers."""

import contextlib
import gzip
import socket
import threading
import time

import pytest

from groundstation.services.map import online as module
from groundstation.services.map.online import DEFAULT_AGE_S, MIN_STEP_S, OnlineMap, OnlineTiles, TileCache
from groundstation.services.map.tile_source import MAX_TILE_BYTES, TileNotReached
from groundstation.services.map.web_mercator import Tile
from planning.base.errors import InputError
from tests.services.map_files import picture, square, vector_layer
from tests.services.map_server import TILE, Server, send


@pytest.fixture
def server():
    with contextlib.closing(Server()) as found:
        yield found


@pytest.fixture
def opened(server, tmp_path):
    with contextlib.ExitStack() as stack:

        def make(path="/{z}/{x}/{y}.png", clock=time.time, sleep=lambda _: None, **settings):
            online = OnlineMap(server.url + path, "© testers", is_on=True, **settings)
            return stack.enter_context(contextlib.closing(OnlineTiles(online, tmp_path, clock, sleep)))

        yield make


def test_nothing_is_asked_for_before_the_user_agrees(server, tmp_path):
    online = OnlineMap(server.url + "/{z}/{x}/{y}.png", "© testers")
    assert not OnlineMap().is_on
    with pytest.raises(InputError, match="off"):
        OnlineTiles(online, tmp_path)
    assert server.asked == []


def test_tiles_are_fetched_once_by_name_and_kept(server, opened):
    source = opened()
    assert server.asked == []
    assert source.info.attribution == "© testers"
    for _ in range(3):
        assert source.image(TILE) == picture(TILE)
    assert opened().image(TILE) == picture(TILE)
    ((path, agent),) = server.asked
    assert path == "/3/2/1.png"
    assert agent.startswith("Reflight/")
    assert source.image(Tile(20, 0, 0)) is None


def test_rows_may_count_from_the_south_and_stand_in_a_query(server, opened):
    opened("/map?l={z}&c={x}&r={-y}").image(TILE)
    assert server.asked[0][0] == "/map?l=3&c=2&r=6"


def test_requests_are_spaced(server, opened):
    waits, ticks = [], [1000.0]

    def sleep(seconds):
        waits.append(seconds)
        ticks[0] += seconds

    source = opened(clock=lambda: ticks[0], sleep=sleep)
    for column in range(4):
        source.image(TILE._replace(column=column))
    assert waits == pytest.approx([MIN_STEP_S] * 3)


@pytest.mark.parametrize(("control", "age_s"), [("", DEFAULT_AGE_S), ("max-age=7200", 7200.0), ("max-age=1", 3600.0)])
def test_old_tiles_are_fetched_anew_and_shown_where_the_network_is_gone(server, opened, control, age_s):
    server.answer = lambda handler: send(handler, picture(TILE), Cache_Control=control)
    now = [time.time()]
    source = opened(clock=lambda: now[0])
    source.image(TILE)
    now[0] += age_s - 60.0
    source.image(TILE)
    assert len(server.asked) == 1
    now[0] += 120.0
    source.image(TILE)
    assert len(server.asked) == 2
    now[0] += age_s + 60.0
    server.answer = lambda handler: send(handler, b"", 503)
    assert source.image(TILE) == picture(TILE)
    with pytest.raises(TileNotReached, match="busy or broken"):
        source.image(TILE._replace(column=0))


def test_places_without_a_tile_are_asked_for_once(server, opened):
    server.answer = lambda handler: send(handler, b"no", 404)
    source = opened()
    assert source.image(TILE) is None
    assert source.image(TILE) is None
    assert len(server.asked) == 1


def redirect(handler):
    send(handler, b"", 302, Location="http://127.0.0.1:1/elsewhere")


def cut_off(handler):
    handler.send_response(200)
    handler.send_header("Content-Length", "5000")
    handler.end_headers()
    handler.wfile.write(picture(TILE)[:100])
    handler.close_connection = True


def endless(handler):
    handler.send_response(200)
    handler.end_headers()
    for _ in range(MAX_TILE_BYTES // 2**16 + 2):
        handler.wfile.write(bytes(2**16))
    handler.close_connection = True


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (lambda h: send(h, b"<html>", Content_Type="text/html"), r"something else than a map tile \(text/html"),
        (lambda h: send(h, b""), r"something else than a map tile \(no type"),
        (redirect, "sends elsewhere; enter the address"),
        (lambda h: send(h, b"", 403), "does not let Reflight in"),
        (lambda h: send(h, b"", 429), "busy or broken"),
        (lambda h: send(h, gzip.compress(bytes(2**23)), Content_Encoding="gzip"), "something else"),
        (cut_off, "cannot be reached"),
        (endless, "more than 4 MiB"),
        (lambda h: h.wfile.write(b"\x00\xff nonsense\r\n\r\n"), "cannot be reached"),
        (lambda h: h.connection.shutdown(socket.SHUT_RDWR), "cannot be reached"),
    ],
)  # fmt: skip
def test_hostile_answers_are_no_tiles_and_nothing_of_them_is_kept(server, opened, answer, says):
    source = opened()
    server.answer = answer
    with pytest.raises(TileNotReached, match=says):
        source.image(TILE)
    server.answer = lambda handler: send(handler, picture(TILE))
    assert source.image(TILE) == picture(TILE)


def test_a_server_that_sends_drop_by_drop_is_left(server, opened, monkeypatch):
    monkeypatch.setattr(module, "MAX_ANSWER_S", 0.3)
    stop = threading.Event()

    def drip(handler):
        handler.send_response(200)
        handler.end_headers()
        while not stop.wait(0.02):
            handler.wfile.write(b"\x89")

    server.answer = drip
    started = time.perf_counter()
    with pytest.raises(TileNotReached, match="does not answer"):
        opened().image(TILE)
    stop.set()
    assert time.perf_counter() - started < 10.0


def test_a_server_that_says_nothing_is_left(server, opened, monkeypatch):
    monkeypatch.setattr(module, "MAX_WAIT_S", 0.2)
    stop = threading.Event()
    server.answer = lambda handler: stop.wait(30.0)
    with pytest.raises(TileNotReached, match="does not answer"):
        opened().image(TILE)
    stop.set()


def test_a_server_that_is_not_there_is_told(tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    online = OnlineMap(f"http://127.0.0.1:{port}/{{z}}/{{x}}/{{y}}.png", "© testers", is_on=True)
    with pytest.raises(TileNotReached, match="cannot be reached"):
        OnlineTiles(online, tmp_path).image(TILE)


def test_closing_ends_a_request_that_is_on_its_way(server, opened):
    arrived, stop = threading.Event(), threading.Event()

    def wait(_handler):
        arrived.set()
        stop.wait(60.0)

    server.answer = wait
    source, ended = opened(), threading.Event()

    def ask():
        with contextlib.suppress(TileNotReached):
            source.image(TILE)
        ended.set()

    threading.Thread(target=ask, daemon=True).start()
    assert arrived.wait(30.0)
    source.close()
    assert ended.wait(8.0)
    stop.set()
    assert source.image(TILE) is None


def test_a_connection_that_the_server_closed_is_made_once_more(server, opened):
    def once(handler):
        send(handler, picture(TILE))
        handler.close_connection = True

    server.answer = once
    source = opened()
    for column in range(3):
        assert source.image(TILE._replace(column=column)) == picture(TILE)
    assert len(server.asked) == 3


def test_vector_tiles_are_known_by_the_address(server, opened):
    tile = gzip.compress(vector_layer("water", [(3, square(0, 9), {})]))
    server.answer = lambda handler: send(handler, tile, Content_Encoding="gzip")
    source = opened("/{z}/{x}/{y}.pbf")
    assert source.info.is_vector
    assert source.image(TILE) == tile
    server.answer = lambda handler: send(handler, b"<html>")
    with pytest.raises(TileNotReached, match="something else"):
        source.image(TILE._replace(row=0))


def test_the_disk_is_not_filled(tmp_path):
    now = [1e9]
    cache = TileCache(tmp_path / "c", 10_000, clock=lambda: now[0])
    for column in range(30):
        now[0] += 1.0
        cache.put(Tile(9, column, 0), bytes(1000), 100.0)
        assert cache.n_bytes() <= 10_000
    kept = [column for column in range(30) if cache.get(Tile(9, column, 0)) is not None]
    assert kept == list(range(kept[0], 30))
    assert len(kept) >= 8
    assert TileCache(tmp_path / "c", 10_000).n_bytes() == cache.n_bytes()
    cache.put(Tile(9, 29, 0), bytes(10), 100.0)
    assert cache.get(Tile(9, 29, 0)) == (bytes(10), True)


def test_damaged_tiles_on_the_disk_are_fetched_anew(server, opened, tmp_path):
    source = opened()
    source.image(TILE)
    (kept,) = tmp_path.rglob("*.tile")
    kept.write_bytes(bytes(MAX_TILE_BYTES + 1))
    assert source.image(TILE) == picture(TILE)
    kept.unlink()
    kept.mkdir()
    assert source.image(TILE) == picture(TILE)


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("", "expected an address"), ("ftp://a/{z}/{x}/{y}", "expected an address"), ("https:///{z}/{x}/{y}", "an ad"),
        ("file:///etc/{z}{x}{y}", "expected an address"), ("https://a.org/{z}/{x}.png", "once each"),
        ("https://a.org/{z}/{x}/{y}/{y}.png", "once each"), ("https://{z}.org/{x}/{y}.png", "once each"),
        ("https://a.org/{z}/{x}/{y}/{key}", "once each"), ("https://me:secret@a.org/{z}/{x}/{y}", "password"),
        ("https://a.org/{z}/{x}/{y}.png HTTP/1.1", "a space"), ("https://a.org/\r\n{z}/{x}/{y}", "a space|address"),
    ],
)  # fmt: skip
def test_addresses_that_cannot_be_used_are_refused(url, says):
    with pytest.raises(InputError, match=says):
        OnlineMap(url, "© testers").check()


def test_a_map_without_its_licence_is_refused():
    for attribution in ("", "  ", "<b></b>"):
        with pytest.raises(InputError, match="licence is missing"):
            OnlineMap("https://a.org/{z}/{x}/{y}.png", attribution).check()
