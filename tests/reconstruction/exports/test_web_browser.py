"""Web pages in browsers: what a user does by mouse, fingers and keys, and what hostile records cannot do."""

import contextlib
import socket
import threading
import time

import cv2
import numpy as np
import pytest

from reconstruction.exports.web import WebOptions, write_web
from tests.reconstruction.exports.firefox import Firefox
from tests.reconstruction.exports.test_web import HOSTILE, hostile_records, hostile_scene
from tests.reconstruction.exports.web_browser import axes_of, middle, opened, pixel
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

CAMERA = "return reflight.camera()"
PICKED = "return reflight.state().picked"


def of_pane(element, record, **fields):
    return {"global_id": element.global_id, "record": record, **fields}


def inspected(scene):
    panes = [element for _, element in scene.elements]
    rows = [
        of_pane(pane, "inspection", date=f"2026-0{i}-11", inspector="K. Weiß") for i, pane in enumerate(panes[:3], 1)
    ]
    rows.append(of_pane(panes[1], "defect", kind="Riß am Rand", severity=5, u=0.5, v=0.5, found_on="2026-02-01"))
    rows.append({"global_id": scene.global_id, "record": "document", "title": "plan", "place": "plan.pdf"})
    return rows


@pytest.mark.long
def test_hostile_records_are_text_in_a_page_that_works(browser, tmp_path):
    scene = hostile_scene()
    content = cv2.imencode(".png", np.zeros((5, 5, 3), np.uint8))[1].tobytes()
    panes = scene.components[0].elements
    records = [*hostile_records(scene), of_pane(panes[1], "defect", kind="a", picture="p")]
    browser.log("performance")
    page = opened(browser, tmp_path / "page", scene, records, (800, 300), content_of={"p": content}.get)
    state = browser.run("return reflight.state()")
    assert (state["isLoaded"], state["n"]) == (True, page.n_gaussians)
    counted = "return ['img', 'svg', 'iframe', 'a'].map((name) => document.querySelectorAll(name).length)"
    assert browser.run(counted) == [0, 0, 0, 0]
    assert browser.texts(".row b")[:3] == HOSTILE[:3]
    browser.run("document.querySelector('.row').click()")
    # One drawing of a place, and one link, to the web.
    assert browser.run(counted) == [0, 1, 0, 1]
    assert browser.run("return document.querySelector('a').href") == "https://example.org/b.pdf"
    is_shown = "return arguments[0].map((text) => document.getElementById('content').textContent.includes(text))"
    assert browser.run(is_shown, [*HOSTILE[:5], "javascript:alert(5)", "nowhere"]) == [True] * 6 + [False]
    for choice in range(browser.run("return document.getElementById('colour').options.length") - 1):
        browser.choose("colour", str(choice))
    assert browser.run(counted) == [0, 1, 0, 1]
    browser.run("reflight.pick(arguments[0])", panes[1].global_id)
    decoded = "const image = document.querySelector('img'); await image.decode(); return image.naturalWidth"
    assert browser.run(decoded) == 5
    assert browser.alert() is None
    assert browser.errors() == []
    asked = [line["message"] for line in browser.log("performance") if "requestWillBeSent" in line["message"]]
    assert any('"url":"file:' in line for line in asked)
    assert not any(f'"url":"{scheme}:' in line for line in asked for scheme in ("http", "https", "ws", "wss"))


@pytest.mark.slow
def test_clicks_pick_what_is_seen_and_not_what_a_wall_hides(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((400, 400),), n_background=1)
    facade, background = scene.components
    # Panes at y = 0, seen from the south; a wall of one large disc stands before the left one.
    for element in facade.elements:
        corners = np.asarray(element.corners_enu_m) - scene.origin_enu_m
        u, v = np.random.default_rng(0).random((2, 400, 1))
        places = corners[0] + u * (corners[1] - corners[0]) + v * (corners[3] - corners[0])
        facade.gaussians.values["means"][element.start : element.stop] = places
    west, east = (middle(scene, element) for element in facade.elements)
    values = background.gaussians.values
    values["means"][0] = west + np.array([0, -1.5, 0])
    values["quats"][0] = (np.sqrt(0.5), np.sqrt(0.5), 0, 0)
    values["log_scales"][0] = np.log(0.25)
    values["opacity_logits"][0] = 8.0
    opened(any_browser, tmp_path / "page", scene)
    any_browser.run("reflight.look(...arguments)", (west + np.array([0.7, -8, 0])).tolist(), 0, 0)
    any_browser.settled()
    camera = any_browser.run(CAMERA)
    names = [element.global_id for element in facade.elements]
    assert any_browser.run("return reflight.at(...arguments)", *pixel(camera, west)) == names[0]
    assert any_browser.run("return reflight.seenAt(...arguments)", *pixel(camera, west)) is None
    beside = west + np.array([0, 0, 0.8])
    for place, expected in [(east, names[1]), (west, None), (beside, names[0])]:
        x, y = map(round, pixel(camera, place))
        any_browser.mouse(("move", x, y), ("down",), ("up",))
        assert any_browser.run(PICKED) == expected
    assert any_browser.run("return decodeURIComponent(location.hash.slice(1))") == names[0]
    # A drag is no click, and turns the model.
    x, y = map(round, pixel(camera, east))
    any_browser.mouse(("move", x, y), ("down",), ("move", 200, 100), ("up",))
    assert any_browser.run(PICKED) == names[0]
    assert any_browser.run(CAMERA)["heading"] != camera["heading"]


@pytest.mark.slow
def test_search_folds_accents_and_finds_all_fields(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((20, 20, 20), (20,)))
    opened(any_browser, tmp_path / "page", scene, inspected(scene))

    def found(text):
        any_browser.choose("search", text)
        return any_browser.texts(".row b")

    assert found("weiss") == found("WEISS") == ["A-0000", "A-0001", "A-0002"]
    assert found("  riss AM ") == ["A-0001"]
    assert found("2026-03-11") == ["A-0002"]
    assert found(scene.components[1].elements[0].global_id) == ["B-0000"]
    assert found("nowhere") == []
    assert len(found("")) == 4


def with_files(scene):
    """Records that name stored files: of a pane, its facade and the building; and what is beside the records."""
    facade, pane = scene.components[0], scene.components[0].elements[1]
    small = cv2.imencode(".png", np.full((6, 8, 3), 90, np.uint8))[1].tobytes()
    files = {"0a.pdf": b"%PDF-1.7 contract", "0b.png": small, "0c.png": b"\x89PNG\r\n\x1a\n no more"}
    rows = [
        of_pane(pane, "defect", kind="chip", severity=2, found_on="2026-01-02", picture="0b.png"),
        of_pane(pane, "defect", kind="leak", severity=3, found_on="2026-01-02", status="repaired", picture="0c.png"),
        of_pane(pane, "document", title="Glass data sheet", place="0d.pdf"),
        of_pane(facade, "document", title="Maintenance contract", place="0a.pdf"),
        of_pane(facade, "inspection", date="2026-03-31", inspector="Moreau", result="sound"),
        of_pane(scene, "document", title="Photo of the entrance", place="0b.png"),
        of_pane(scene, "document", title="Rules", place="https://example.org/rules.pdf"),
    ]
    return rows, files


@pytest.mark.slow
def test_documents_come_out_of_the_page_as_they_are_and_what_is_missing_is_named(browser, tmp_path):
    scene = synthetic_scene(sizes=((20, 20, 20), (20,)))
    rows, files = with_files(scene)
    page = opened(browser, tmp_path / "page", scene, rows, content_of=files.get)
    assert (page.n_pictures, page.n_documents) == (1, 1)
    assert (page.n_missing, page.n_damaged, page.n_large) == (1, 1, 0)
    got = tmp_path / "got"
    got.mkdir()
    browser.cdp("Page.setDownloadBehavior", behavior="allow", downloadPath=str(got))
    browser.run("reflight.pick(arguments[0])", scene.components[0].elements[1].global_id)
    assert browser.texts(".file button") == ["Maintenance contract.pdf · 1 kB"]
    browser.run("document.querySelector('.file button').click()")
    for _ in range(2000):
        if [path.name for path in got.iterdir()] == ["Maintenance contract.pdf"]:
            break
        time.sleep(0.05)
    assert (got / "Maintenance contract.pdf").read_bytes() == files["0a.pdf"]
    said = browser.texts("#content .sub")
    assert any("missing when this page was written (0d.pdf)" in text for text in said)
    assert any("could not be read when this page was written (0c.png)" in text for text in said)
    assert browser.texts(".file code") == ["Glass data sheet.pdf", "Photo of the entrance.png"]
    browser.run("document.querySelectorAll('#content details').forEach((each) => { each.open = true; })")
    shown = "return Promise.all([...document.images].map((image) => image.decode().then(() => image.naturalWidth)))"
    assert browser.run(shown) == [8, 8]
    assert browser.texts(".card a") == ["https://example.org/rules.pdf"]
    assert browser.errors() == []


@pytest.mark.slow
def test_what_is_shown_is_found_whatever_it_is_of(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((20, 20, 20), (20,)))
    rows, files = with_files(scene)
    opened(any_browser, tmp_path / "page", scene, rows, content_of=files.get)
    # Folded up below all panes: of the facade and the building.
    assert any_browser.texts("#content summary") == ["Facade A", "Building"]

    def found(text):
        any_browser.choose("search", text)
        opened_ = any_browser.run(
            "return [...document.querySelectorAll('#content details[open] > summary')].map((e) => e.textContent)"
        )
        return any_browser.texts(".count")[0], any_browser.texts(".row b"), opened_

    assert found("maintenance CONTRACT.pdf") == ("3 panes found", ["A-0000", "A-0001", "A-0002"], ["Facade A"])
    assert found("moreau")[2] == ["Facade A"]
    assert found("entrance") == ("Found in records of a facade or the building.", [], ["Building"])
    assert found("repaired")[1] == found("Mar 31, 2026")[1][1:2] == ["A-0001"]
    # Names of stored files are not shown, and are not found.
    assert found("0b.png") == ("No pane has this in its records.", [], [])


@pytest.mark.slow
def test_colours_show_on_panes_and_in_the_legend(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((0, 0, 0),), n_background=0)
    panes = [element for _, element in scene.elements]
    rows = [of_pane(pane, "attribute", name="maker", value=maker) for pane, maker in zip(panes, "aab", strict=True)]
    opened(any_browser, tmp_path / "page", scene, rows)
    any_browser.choose("colour", "0")
    any_browser.settled()
    camera = any_browser.run(CAMERA)
    shown = any_browser.pixels().astype(int)
    first, second, third = (shown[int(y), int(x)] for x, y in (pixel(camera, middle(scene, pane)) for pane in panes))
    assert np.array_equal(first, second)
    # Blue and orange, as the legend says.
    assert first[2] > first[0] + 60
    assert third[0] > third[2] + 60
    squares = "return [...document.querySelectorAll('#legend .square')].map((each) => each.style.backgroundColor)"
    assert any_browser.run(squares) == ["rgb(0, 114, 178)", "rgb(230, 159, 0)"]
    assert any_browser.texts("#legend .swatch") == ["a", "b"]


@pytest.mark.slow
def test_language_follows_the_browser_and_the_switch(browser, tmp_path):
    scene = synthetic_scene(sizes=((20, 20, 20),))
    browser.cdp("Emulation.setUserAgentOverride", userAgent="test", acceptLanguage="de-AT")
    opened(browser, tmp_path / "page", scene, inspected(scene))
    browser.cdp("Emulation.setUserAgentOverride", userAgent="test", acceptLanguage="en-GB")
    language = "return document.documentElement.lang"
    assert (browser.run(language), browser.texts(".count")) == ("de", ["3 Scheiben"])
    browser.run("document.getElementById('language').click()")
    assert (browser.run(language), browser.texts(".count")) == ("en", ["3 panes"])


@pytest.mark.slow
def test_fingers_turn_move_and_pick_on_a_tablet(browser, tmp_path):
    scene = synthetic_scene(sizes=((50, 50, 50),), n_background=0)
    browser.window(700, 900, touch=True)
    browser.open(write_web(scene, tmp_path / "page", inspected(scene)).path)
    browser.settled()
    before = browser.run(CAMERA)

    def touch(kind, *points):
        touches = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]
        browser.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=touches)

    touch("touchStart", (200, 300))
    touch("touchMove", (260, 300))
    touch("touchEnd")
    turned = browser.run(CAMERA)
    assert turned["heading"] > before["heading"] + 5
    touch("touchStart", (200, 300), (300, 300))
    touch("touchMove", (150, 300), (350, 300))
    touch("touchEnd")
    nearer = browser.run(CAMERA)
    pane = scene.components[0].elements[1]
    target = middle(scene, pane)
    assert np.linalg.norm(nearer["eye"] - target) < 0.8 * np.linalg.norm(turned["eye"] - target)
    browser.run("document.getElementById('home').click()")
    browser.settled()
    touch("touchStart", pixel(browser.run(CAMERA), target))
    touch("touchEnd")
    assert browser.run(PICKED) == pane.global_id
    assert browser.run("return document.body.classList.contains('open')")
    browser.window(900, 500)


@pytest.mark.slow
def test_keys_reach_everything(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((50, 50, 50),))
    opened(any_browser, tmp_path / "page", scene, inspected(scene))
    any_browser.run("document.getElementById('picture').focus()")
    start = any_browser.run(CAMERA)
    any_browser.press("\ue014", "w")  # arrow to the right, forward
    moved = any_browser.run(CAMERA)
    assert moved["heading"] != start["heading"]
    assert np.linalg.norm(np.subtract(moved["eye"], start["eye"])) > 0.01
    any_browser.press("f")
    assert any_browser.run("return document.getElementById('fly').getAttribute('aria-pressed')") == "true"
    any_browser.press("\ue00c", "0")  # escape
    any_browser.settled()
    np.testing.assert_allclose(any_browser.run(CAMERA)["heading"], start["heading"], atol=1e-6)
    any_browser.run("document.querySelector('.row').focus()")
    any_browser.press("\ue007")  # enter
    assert any_browser.run(PICKED) == scene.components[0].elements[0].global_id
    assert any_browser.texts("#said")[0].endswith("A-0000")


@pytest.mark.slow
def test_pages_open_at_the_pane_that_their_address_names(any_browser, tmp_path):
    scene = synthetic_scene(sizes=((3, 0, 5), (2,)))
    rows, files = with_files(scene)
    page = write_web(scene, tmp_path / "page", rows, WebOptions(content_of=files.get))
    wanted = scene.components[0].elements[1].global_id
    any_browser.open(page.path, f"#{wanted}")
    any_browser.settled()
    assert any_browser.run(PICKED) == wanted
    # Its picture is there, though it stands behind the script that shows it.
    assert (
        any_browser.run(
            "const image = document.querySelector('#content img'); await image.decode(); return image.naturalWidth"
        )
        == 8
    )
    any_browser.open(page.path, "#%E0%A4%A")
    any_browser.settled()
    assert any_browser.run("return reflight.state().isLoaded")


ATTEMPTS = """
const server = arguments[0];
const put = (name, fields) => document.body.append(Object.assign(document.createElement(name), fields));
const blocked = [];
document.addEventListener("securitypolicyviolation", (event) => blocked.push(event.effectiveDirective));
const attempts = [
  () => put("img", { src: `${server}a.png` }),
  () => put("iframe", { src: server }),
  () => put("script", { text: "window.bad = 1" }),
  () => { document.body.setAttribute("onclick", "window.bad = 1"); document.body.click(); },
];
const markup = () => { document.body.innerHTML += "<img src=x onerror='window.bad = 1'>"; };
const tried = (attempt) => { try { attempt(); return null; } catch (error) { return error.name; } };
const wait = () => new Promise((go) => setTimeout(go, 200));
attempts.forEach(tried);
const isFetched = await fetch(server).then(() => true, () => false);
await wait();
const byMarkup = tried(markup);
await wait();
return { blocked, byMarkup, isFetched, bad: window.bad ?? null, knowsTrustedTypes: "trustedTypes" in window };
"""


@pytest.mark.slow
@pytest.mark.parametrize("size", [(900, 500), (420, 700)])
def test_a_page_opens_square_before_the_largest_facade(any_browser, tmp_path, size):
    scene = synthetic_scene(sizes=((20, 20, 20), (20,)))
    opened(any_browser, tmp_path / "page", scene, size=size)
    any_browser.run("reflight.look([3, 3, 3], 77, 30)")
    any_browser.run("document.getElementById('home').click()")
    any_browser.settled()
    camera = any_browser.run("return reflight.camera()")
    corners = np.array([element.corners_enu_m for element in scene.components[0].elements])
    normal = np.cross(corners[0, 2] - corners[0, 0], corners[0, 3] - corners[0, 1])
    assert axes_of(camera)[2] @ normal / np.linalg.norm(normal) == pytest.approx(-1.0, abs=1e-9)
    places = np.array([pixel(camera, corner) for corner in corners.reshape(-1, 3) - scene.origin_enu_m])
    assert (places > 0.0).all()
    assert (places < (camera["width"], camera["height"])).all()
    assert (np.ptp(places, axis=0) / (camera["width"], camera["height"])).max() > 0.9


@pytest.fixture
def server():
    """A web server's address, and what it was asked: Chromium may connect for a frame that it then does not ask for."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        asked = []

        def listen():
            while True:
                try:
                    connection, _ = listening.accept()
                except OSError:
                    return
                connection.settimeout(5.0)
                with connection, contextlib.suppress(OSError):
                    if first := connection.recv(200):
                        asked.append(first)

        thread = threading.Thread(target=listen, daemon=True)
        thread.start()
        address = listening.getsockname()
        yield f"http://127.0.0.1:{address[1]}/", asked
        with socket.create_connection(address):
            pass
        listening.close()


@pytest.mark.long
def test_the_policy_blocks_network_scripts_and_markup_from_text(any_browser, tmp_path, server):
    opened(any_browser, tmp_path / "page", synthetic_scene())
    address, asked = server
    found = any_browser.run(ATTEMPTS, address)
    assert asked == []
    assert found["bad"] is None
    assert not found["isFetched"]
    # Firefox 140 does not have it yet; there, what the markup would run is blocked all the same.
    assert found["knowsTrustedTypes"] or isinstance(any_browser, Firefox)
    assert found["byMarkup"] == ("TypeError" if found["knowsTrustedTypes"] else None)
    # Of frames Firefox says nothing; that the server was not asked is above.
    told = {"img-src", "connect-src"} | ({"frame-src"} if found["knowsTrustedTypes"] else set())
    assert told <= set(found["blocked"])


@pytest.mark.slow
def test_a_page_that_was_cut_off_says_so(any_browser, tmp_path):
    page = write_web(synthetic_scene(), tmp_path / "page")
    content = page.path.read_bytes()
    page.path.write_bytes(content[: content.index(b'id="g0">') + 200])
    any_browser.open(page.path)
    any_browser.settled()
    assert "damaged" in any_browser.texts("#trouble")[0]
    assert len(any_browser.texts(".row")) == 4


@pytest.mark.slow
def test_without_webgl_the_records_are_still_there(browser, tmp_path):
    scene = synthetic_scene(sizes=((50, 50, 50),))
    page = write_web(scene, tmp_path / "page", inspected(scene))
    source = "HTMLCanvasElement.prototype.getContext = () => null"
    added = browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=source)
    browser.open(page.path)
    browser.settled()
    assert "WebGL 2" in browser.texts("#trouble")[0]
    browser.run("document.querySelectorAll('.row')[1].click()")
    assert "Riß am Rand" in browser.texts("#content")[0]
    browser.cdp("Page.removeScriptToEvaluateOnNewDocument", **added)


@pytest.mark.long
def test_a_page_of_a_model_without_panes_says_nothing_of_reflections(any_browser, tmp_path):
    opened(any_browser, tmp_path / "panes", synthetic_scene(sizes=((50,),)))
    assert "Reflections" in any_browser.texts("#note")[0]
    opened(any_browser, tmp_path / "none", synthetic_scene(sizes=(), n_background=200))
    assert any_browser.texts("#note") == any_browser.texts("#trouble") == [""]
    assert "0 panes" in any_browser.texts("#content")[0]
    assert any_browser.pixels().std() > 1.0
    assert any_browser.errors() == []
