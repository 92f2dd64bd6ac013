"""Web pages as files: whole or not at all, the same bytes each time, and nothing of a user's that is markup."""

import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
import torch

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports import page_records, web
from reconstruction.exports.component_parts import ellipsoids_of_all
from reconstruction.exports.web import PAGE, SIGN, WebOptions, first_view, plain_sky_light, sky_light, write_web
from reconstruction.splats.sky import Sky
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

HOSTILE = [
    '"><img src=x onerror=alert(1)>',
    "</script><script>alert(2)</script>",
    "<!--<script>",
    "]]></style><svg onload=alert(3)>",
    "@@SCRIPT@@",
    "\u2028alert(4)\u2029\x00\ud800",
]


def hostile_scene():
    scene = synthetic_scene()
    facade = scene.components[0]
    elements = tuple(replace(element, name=name) for element, name in zip(facade.elements, HOSTILE[:3], strict=True))
    facade = replace(facade, name=HOSTILE[3], elements=elements)
    return replace(scene, name=HOSTILE[0], components=(facade, *scene.components[1:]))


def hostile_records(scene):
    rows = [{"record": "attribute", "name": text, "value": text, "unit": text} for text in HOSTILE]
    rows += [{"record": "defect", "kind": text, "note": text, text: text} for text in HOSTILE]
    rows += [{"record": "document", "title": text, "place": text} for text in HOSTILE]
    rows.append({"record": "document", "title": "a", "place": "javascript:alert(5)"})
    rows.append({"record": "document", "title": "b", "place": "https://example.org/b.pdf"})
    rows.append({"record": "defect", "kind": "__proto__", "picture": "__proto__", "u": 0.5, "v": 0.5})
    pane = next(scene.elements)[1].global_id
    return [{"global_id": pane, **row} for row in rows]


class Page(HTMLParser):
    """Elements, and what is in scripts and styles, as HTML's rules have it."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.inside, self.is_inside = [], [], False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self.is_inside = tag in ("script", "style")
        if self.is_inside:
            self.inside.append([tag, dict(attrs), ""])

    def handle_endtag(self, tag):
        self.is_inside = False

    def handle_data(self, data):
        if self.is_inside:
            self.inside[-1][2] += data

    def of(self, tag, **attributes):
        return [text for name, found, text in self.inside if name == tag and attributes.items() <= found.items()]


def page_of(folder):
    return Page((folder / PAGE).read_text("utf-8"))


def test_nothing_of_a_user_becomes_markup(tmp_path):
    write_web(synthetic_scene(), tmp_path / "tame")
    scene = hostile_scene()
    write_web(scene, tmp_path / "wild", hostile_records(scene), WebOptions(title=HOSTILE[1]))
    tame, wild = page_of(tmp_path / "tame"), page_of(tmp_path / "wild")
    assert wild.elements == tame.elements
    assert wild.of("script")[1] == tame.of("script")[1]
    model = json.loads(wild.of("script", id="model")[0])
    assert model["title"] == HOSTILE[1]
    assert [pane["name"] for pane in model["panes"]][:3] == HOSTILE[:3]
    assert [row["value"] for row in model["records"][model["panes"][0]["id"]][: len(HOSTILE)]] == HOSTILE
    text = (tmp_path / "wild" / PAGE).read_text("utf-8").split('id="model">')[1].split("</script>")[0]
    assert not re.search(r"[^\x00-\x7f]|[<>&]", text)


def test_the_policy_allows_our_script_and_style_alone(tmp_path):
    write_web(synthetic_scene(), tmp_path / "page")
    page = page_of(tmp_path / "page")
    policy = next(found["content"] for tag, found in page.elements if found.get("http-equiv"))
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == "'none'"
    assert rules["script-src"] == hash_of(page.of("script")[1])
    assert rules["style-src"] == hash_of(page.of("style")[0])
    assert "unsafe" not in policy
    assert "http" not in policy
    runs = [found for tag, found in page.elements if tag == "script" and "type" not in found]
    assert runs == [{}]
    assert not any(set(found) & {"src", "href", "onload"} for tag, found in page.elements)


def hash_of(text):
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def test_pages_are_the_same_bytes_each_time_and_name_no_place_of_this_machine(tmp_path):
    scene = synthetic_scene()
    records = [
        {"global_id": scene.components[0].elements[0].global_id, "record": "defect", "kind": "a", "picture": "p"}
    ]
    content = cv2.imencode(".png", np.zeros((5, 5, 3), np.uint8))[1].tobytes()
    options = WebOptions(content_of={"p": content}.get)
    one = write_web(scene, tmp_path / "one", records, options)
    write_web(scene, tmp_path / "two", records, options)
    again = write_web(scene, tmp_path / "one", records, options)
    content = (tmp_path / "one" / PAGE).read_bytes()
    assert content == (tmp_path / "two" / PAGE).read_bytes()
    assert (one, one.n_bytes, one.n_pictures) == (again, len(content), 1)
    assert [path.name for path in (tmp_path / "one").iterdir()] == [PAGE]
    assert str(tmp_path).encode() not in content
    assert b"/work" not in content
    assert SIGN.encode() in content[:1000]


def test_chunks_of_the_page_hold_all_gaussians(tmp_path, monkeypatch):
    monkeypatch.setattr("reconstruction.exports.web.N_AT_ONCE", 4)
    scene = synthetic_scene()
    page = write_web(scene, tmp_path / "page", options=WebOptions(degree=1))
    found = page_of(tmp_path / "page")
    chunks = [base64.b64decode(text) for text in found.of("script", type="text/plain")]
    assert sum(map(len, chunks)) == page.n_gaussians * 41
    assert page.n_gaussians == scene.n_gaussians
    assert page.n_panes == 4


def test_an_interrupted_write_leaves_the_old_page_whole(tmp_path):
    folder = tmp_path / "page"
    write_web(synthetic_scene(), folder)
    before = (folder / PAGE).read_bytes()

    class Impatient:
        def report(self, stage, done, total):
            raise OperationCancelled("enough")

    with pytest.raises(OperationCancelled):
        write_web(synthetic_scene(seed=1), folder, monitor=Impatient())
    with pytest.raises(OperationCancelled):
        write_web(synthetic_scene(seed=1), tmp_path / "new", monitor=Impatient())
    assert (folder / PAGE).read_bytes() == before
    assert [path.name for path in tmp_path.rglob("*")] == ["page", PAGE]


def test_folders_of_others_are_refused_and_stay(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").write_text("mine")
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / PAGE).write_text("<title>my own page</title>")
    (tmp_path / "file").write_text("mine")
    for name, message in [("other", "other files"), ("site", "somebody else's"), ("file", "this is a file")]:
        with pytest.raises(InputError, match=message):
            write_web(synthetic_scene(), tmp_path / name)
    assert (tmp_path / "site" / PAGE).read_text() == "<title>my own page</title>"
    (tmp_path / "empty").mkdir()
    assert write_web(synthetic_scene(), tmp_path / "empty").path.is_file()


def test_scenes_that_no_page_bears_are_refused(tmp_path, monkeypatch):
    scene = synthetic_scene()
    monkeypatch.setattr(web, "MAX_GAUSSIANS", 10)
    with pytest.raises(InputError, match="14 Gaussians, a page bears 10; keep the most visible"):
        write_web(scene, tmp_path / "page")
    assert write_web(scene, tmp_path / "page", options=WebOptions(most=10)).n_gaussians == 10
    monkeypatch.setattr(web, "MAX_PANES", 3)
    with pytest.raises(InputError, match="4 panels, a page bears 3"):
        write_web(scene, tmp_path / "page")
    with pytest.raises(InputError, match="no components"):
        write_web(replace(scene, components=()), tmp_path / "page")
    monkeypatch.undo()
    monkeypatch.setattr(web, "MAX_TEXT_BYTES", 100)
    with pytest.raises(InputError, match="MiB of text"):
        write_web(scene, tmp_path / "page")


def test_too_many_pictures_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(page_records, "MAX_PICTURE_BYTES", 1)
    scene = synthetic_scene()
    records = [{"global_id": scene.global_id, "record": "defect", "kind": "a", "picture": "p"}]
    content = cv2.imencode(".png", np.zeros((5, 5, 3), np.uint8))[1].tobytes()
    with pytest.raises(InputError, match="after 1 of 1"):
        write_web(scene, tmp_path / "page", records, WebOptions(content_of={"p": content}.get))
    assert not (tmp_path / "page").exists()


def test_documents_for_which_there_is_no_room_are_named_the_largest_first(tmp_path, monkeypatch):
    scene = synthetic_scene()
    files = {"a.pdf": bytes(400), "b.pdf": bytes(300), "c.pdf": bytes(500), "d.txt": b"1"}
    rows = [
        {"global_id": scene.global_id, "record": "document", "title": f"{name[0]}/{name[0]}.pdf", "place": name}
        for name in (*files, "e.pdf")
    ]
    monkeypatch.setattr(page_records, "MAX_DOCUMENT_BYTES", 800)
    page = write_web(scene, tmp_path / "page", rows, WebOptions(content_of=files.get))
    assert (page.n_documents, page.n_missing, page.n_large) == (3, 1, 1)
    found = page_of(tmp_path / "page")
    model = json.loads(found.of("script", id="model")[0])
    assert {name: each.get("state") for name, each in model["files"].items()} == {
        **dict.fromkeys(("a.pdf", "b.pdf", "d.txt")),
        "c.pdf": "large",
        "e.pdf": "missing",
    }
    for name in ("a.pdf", "b.pdf", "d.txt"):
        part = found.of("script", id=f"d{model['files'][name]['document']}")
        assert base64.b64decode(part[0]) == files[name]
    assert [row["file"] for row in model["records"][scene.global_id]][::3] == ["a_a.pdf", "d_d.pdf.txt"]


@pytest.mark.parametrize("name", ["means", "opacity_logits", "sh"])
def test_numbers_that_are_not_finite_are_refused(tmp_path, name):
    scene = synthetic_scene()
    scene.components[-1].gaussians.values[name][1] = np.nan
    with pytest.raises(InputError, match="not finite"):
        write_web(scene, tmp_path / "page")
    assert not (tmp_path / "page").exists()


def test_one_facade_or_the_background_alone_is_a_page_too(tmp_path):
    scene = synthetic_scene()
    facade = replace(scene, components=scene.components[1:2])
    assert write_web(facade, tmp_path / "facade").n_panes == 1
    background = replace(scene, components=scene.components[-1:])
    assert write_web(background, tmp_path / "background").n_panes == 0
    panes = synthetic_scene(sizes=((0, 0),), n_background=0)
    assert write_web(panes, tmp_path / "panes").n_gaussians == 0


@pytest.mark.parametrize(
    "wrong",
    [{"degree": 4}, {"most": 0}, {"sky": np.zeros((4, 4, 3), np.float16)}, {"sky": np.zeros((4, 8, 3), np.uint8)}],
)
def test_wrong_options_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        WebOptions(**wrong)


def test_skies_are_pictures_of_all_directions():
    light = sky_light(Sky(8, 2.5))
    assert (light.shape, light.dtype) == ((8, 16, 3), np.float16)
    assert np.abs(light - 2.5).max() < 0.002
    plain = plain_sky_light()
    assert plain.shape == (64, 128, 3)
    assert plain[0, 0, 2] > plain[-1, 0, 2]


def place_on_the_page(directions):
    """Where the page's own lookup finds directions, shape (n, 2): its GLSL, read as Python."""
    source = (web.SOURCES / "shaders.js").read_text("utf-8").split("vec2 skyPlace(vec3 d) {")[1].split("}")[0]
    source = re.sub(
        r"(?<== )([^;?]+) \? ([^:]+) : ([^;]+)", r"np.where(\1, \2, \3)", source.replace("return", "place =")
    )
    lines = [line.strip().removeprefix("float ") for line in source.split(";")]
    names = {"np": np, "atan": np.arctan2, "asin": np.arcsin, "clamp": np.clip, "abs": np.abs}
    names |= {
        "vec2": lambda x, y: np.stack([x, y], axis=1),
        "d": SimpleNamespace(**dict(zip("xyz", directions.T, strict=True))),
    }
    exec("\n".join(lines), names)
    return names["place"]


def sampled(texels, places):
    """As WebGL reads a texture: linear between pixels, repeated across, held at the upper and the lower edge."""
    height, width = texels.shape[:2]
    x, y = (places * (width, height) - 0.5).T
    columns, rows, light = np.floor(x).astype(int), np.floor(y).astype(int), 0.0
    for i, share in ((0, 1.0 - x + columns), (1, x - columns)):
        for j, other in ((0, 1.0 - y + rows), (1, y - rows)):
            of_texels = texels[np.clip(rows + j, 0, height - 1), (columns + i) % width]
            light = light + (share * other)[:, None] * of_texels
    return light


def test_the_page_finds_the_sky_where_the_model_has_it():
    generator = torch.Generator().manual_seed(0)
    sky = Sky(16)
    with torch.no_grad():
        for level in sky.levels:
            level.copy_(1.5 * torch.randn(level.shape, generator=generator))
    around = np.random.default_rng(1).normal(size=(4000, 3))
    # Straight up and down, the four sides, and both sides of the seam, which is south.
    around = np.concatenate([around, np.eye(3), -np.eye(3), [(1e-4, -1.0, 0.3), (-1e-4, -1.0, 0.3)]])
    directions = around / np.linalg.norm(around, axis=1, keepdims=True)
    with torch.no_grad():
        expected = sky(torch.from_numpy(directions).float()).numpy()
    assert expected.std() > 0.2
    found = sampled(sky_light(sky).astype(float), place_on_the_page(directions))
    assert np.abs(found - expected).max() < 0.004
    texture = (web.SOURCES / "picture.js").read_text("utf-8").split("skyTexture({")[1].split("\n  }")[0]
    assert "TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE" in texture
    assert "WRAP_S" not in texture


def opening_of(scene):
    """Where the page begins, and the direction that it looks in."""
    view = first_view(scene, [element for _, element in scene.elements], ellipsoids_of_all(scene.components))
    sh, ch, sp, cp = (each(view[name]) for name in ("heading", "pitch") for each in (np.sin, np.cos))
    return view, np.array([cp * sh, cp * ch, sp])


def test_without_panels_a_page_begins_where_a_photo_in_the_midst_of_the_others_was_taken():
    scene = synthetic_scene((), n_background=60)
    means = scene.components[-1].gaussians.values["means"]
    means[:40] = np.random.default_rng(0).uniform((5.5, 7.5, 0.5), (6.5, 8.5, 1.5), (40, 3))
    means[40:] = (-30.0, -30.0, 2.0)
    places = np.array([(0.0, 0.0, 1.0), (-9.0, 0.0, 1.0), (9.0, 1.0, 1.0)]) + scene.origin_enu_m
    forwards = [(0.6, 0.8, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    view, forward = opening_of(replace(scene, training={"places_enu_m": places.tolist(), "forwards_enu": forwards}))
    np.testing.assert_allclose(forward, forwards[0], atol=1e-5)
    np.testing.assert_allclose(view["target"] - 10.0 * forward, (0.0, 0.0, 1.0), atol=0.3)
    assert view["half"][0] == pytest.approx(10.0 * web.HALF_FIELD, rel=0.05)
    unknown, _ = opening_of(replace(scene, training={}))
    assert unknown["heading"] == 0.0


def facade_of(n, width_m, height_m, turn):
    """A scene of one more facade beside the made one's: n panes side by side, turned from a plane that looks south."""
    scene = synthetic_scene(sizes=((0, 0, 0), (0,) * n), n_background=400)
    corners = np.array([element.corners_enu_m for element in scene.components[1].elements])
    low = corners.reshape(-1, 3).min(axis=0)
    scaled = (corners - low) / np.ptp(corners.reshape(-1, 3), axis=0).clip(1e-9) * (width_m, 0.0, height_m)
    placed = (scaled - (width_m / 2, 0.0, 0.0)) @ np.asarray(turn, float).T + scene.origin_enu_m
    elements = tuple(
        replace(element, corners_enu_m=tuple(map(tuple, each)))
        for element, each in zip(scene.components[1].elements, placed, strict=True)
    )
    # A fog of large discs, far behind everything.
    values = scene.components[-1].gaussians.values
    values["means"][:] = np.random.default_rng(0).uniform(-40.0, 40.0, (400, 3)) + 500.0 * np.array(turn)[:, 1]
    values["log_scales"][:] = np.log(2.0)
    values["opacity_logits"][:] = 3.0
    components = (scene.components[0], replace(scene.components[1], elements=elements), scene.components[-1])
    return replace(scene, components=components)


WEST = [(0, 1, 0), (-1, 0, 0), (0, 0, 1)]
ROOF = [(1, 0, 0), (0, 0, 1), (0, -1, 0)]
SOUTH = np.eye(3)


@pytest.mark.parametrize(
    ("turn", "forward"), [(SOUTH, (0, 1, 0)), (WEST, (1, 0, 0)), (ROOF, (0, 0, -1))], ids=["south", "west", "roof"]
)
def test_a_page_opens_square_before_the_facade_of_the_largest_area(turn, forward):
    # The other facade has more panes, of less area together.
    scene = facade_of(2, 30.0, 12.0, turn)
    view, looks = opening_of(scene)
    assert looks @ forward > 0.9995
    corners = np.array([element.corners_enu_m for element in scene.components[1].elements]).reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2.0 - scene.origin_enu_m
    np.testing.assert_allclose(view["target"], middle, atol=1e-3)
    np.testing.assert_allclose(view["half"], (15.0, 6.0), atol=0.3)
    assert view["free"] >= 15.0 / 0.46 - 0.1


def test_a_page_opens_from_before_what_stands_across_the_street():
    scene = facade_of(2, 30.0, 12.0, SOUTH)
    values, rng = scene.components[-1].gaussians.values, np.random.default_rng(1)
    # A wall 20 m before the facade.
    values["means"][:] = rng.uniform((-25.0, -20.1, -2.0), (25.0, -20.0, 14.0), (400, 3))
    values["quats"][:] = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
    view, _ = opening_of(scene)
    assert 12.0 < view["free"] < 20.1


def test_the_page_says_all_in_both_languages():
    english, german = (
        (web.SOURCES / "words.js").read_text("utf-8").split("  en: {")[1].split("\n};")[0].split("  de: {")
    )
    names = re.compile(r"(?:^|[{,]\s)\s*(\w+): [\"\[{]", re.MULTILINE)
    assert names.findall(english) == names.findall(german)
    assert len(names.findall(english)) > 80
    for path in web.SOURCES.glob("*.js"):
        for name in re.findall(r'\bsay\("(\w+)"', path.read_text("utf-8")):
            assert name in names.findall(english), (path.name, name)


def test_the_page_names_all_its_parts_and_asks_for_no_other():
    sources = {path.stem for path in web.SOURCES.glob("*.js")}
    assert sources == {*web.SCRIPTS, web.LAST}
    whole = "".join(path.read_text("utf-8") for path in web.SOURCES.iterdir())
    found = set(re.findall(r'https?://[^\s"\'`]+', whole)) - {"http://www.w3.org/2000/svg"}
    assert not found
    for name in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function"):
        assert name not in whole
