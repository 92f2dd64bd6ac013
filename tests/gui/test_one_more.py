"""One more format of models or missions, training method or effect, as a row and a module, is everywhere at once."""

import argparse
import importlib.util
import io
import sys
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from groundstation.services.model import export as exports
from missions.formats import registry as registry_of_missions
from missions.formats.options import EncodedFiles, ExportOptions
from missions.mission.export_choices import HeightReference
from planning.base.errors import InputError
from reconstruction.scenes.effects import registry
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.training import method_registry
from tests.missions.plans import example_plan


def described(name, *words):
    """The module of a command, read anew, its parser, and its help."""
    spec = importlib.util.find_spec(f"groundstation.cli.commands.{name}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    parser = argparse.ArgumentParser()
    module.add_parser(parser.add_subparsers())
    told = io.StringIO()
    with redirect_stdout(told), pytest.raises(SystemExit):
        parser.parse_args([*words, "-h"])
    return module, parser, " ".join(told.getvalue().split())


@pytest.fixture
def voxels(monkeypatch):
    """A format more."""

    def write(export):
        export.out.write_text(f"{len(export.scene)} Gaussians")
        return ["coarse"]

    made = exports.ModelExporter((".voxels",), write, "Voxels", "Cubes for games.", "cubes", "no", "no")
    monkeypatch.setitem(exports.EXPORTERS, "voxels", made)
    exports.model_exporters.cache_clear()
    yield made
    exports.model_exporters.cache_clear()


def test_a_format_is_offered_by_command_window_and_docs_and_in_messages(voxels, application, tmp_path):
    from groundstation.gui.model.model_page import ExportDialog
    from tests.docs.generated import with_formats

    _, parser, told = described("export", "export")
    assert "voxels .voxels Cubes for games." in told
    assert parser.parse_args(["export", "a", "--format", "voxels", "-o", "b"]).format == "voxels"
    dialog = ExportDialog(())
    dialog.format.setCurrentIndex(dialog.format.findData("voxels"))
    assert (dialog.format.currentText(), dialog.about.text()) == ("Voxels", "Cubes for games.")
    assert dialog.wanted() == exports.ModelExport("voxels")
    page = Path("docs/reference/exports.md").read_text("utf-8")
    row = "| `voxels` | `.voxels` | cubes | no | no |"
    assert row in with_formats(page)
    assert row not in page
    with pytest.raises(InputError, match=r"known are: .*, voxels"):
        exports.model_exporter("absent")
    assert exports.with_ending(tmp_path / "a", "voxels").name == "a.voxels"


@pytest.fixture
def cards(monkeypatch):
    """A mission format more."""
    made = registry_of_missions.MissionFormat(
        (".cards",),
        lambda _plan, missions, options: EncodedFiles((options.height_reference.encode(),), ()),
        title="Cards",
        options=frozenset(("height_reference",)),
        heights=(HeightReference.AMSL,),
    )
    monkeypatch.setitem(registry_of_missions.FORMATS, "cards", made)
    registry_of_missions.mission_formats.cache_clear()
    yield made
    registry_of_missions.mission_formats.cache_clear()


def test_a_mission_format_is_offered_by_command_and_window_with_its_options(cards, application, tmp_path):
    from groundstation.gui.mission.export_dialog import ExportForm
    from groundstation.services.units import UnitSystem

    export, parser, told = described("export", "export")
    assert "csv, cards; of models below" in told
    words = ["export", "a", "--format", "cards", "-o", "b", "--heights", "amsl", "--autopilot", "px4"]
    assert export._left_out(parser.parse_args(words)) == ["--autopilot is left out: the format cards has no use for it"]
    form = ExportForm(UnitSystem.METRIC)
    form._format.setCurrentIndex(form._format.findData("cards"))
    assert form._format.currentText() == "Cards"
    assert form.value() == ("cards", ExportOptions(HeightReference.AMSL))
    encoded = registry_of_missions.encode(example_plan(), None, None, "cards", form.value()[1])
    assert registry_of_missions.write_files(encoded, tmp_path / "a.cards")[0].read_text() == "amsl"
    with pytest.raises(InputError, match=r"known are: .*, cards"):
        registry_of_missions.mission_format("absent")


GLOW = """
from reconstruction.training.methods.shader import Shader

class Glow(Shader):
    '''Harmonics, by another name.'''

def make_shader(config, surroundings):
    return Glow()
"""


@pytest.fixture
def glow(monkeypatch, tmp_path):
    """A training method more, with a shading of its own."""
    from reconstruction.training import methods

    (tmp_path / "glow.py").write_text(GLOW)
    monkeypatch.setattr(methods, "__path__", [*methods.__path__, str(tmp_path)])
    made = method_registry.Method("Glow", "nobody, never", "splats that glow", settings={"iterations": 7})
    monkeypatch.setitem(method_registry.METHODS, "glow", made)
    method_registry.training_methods.cache_clear()
    yield "Glow"
    method_registry.training_methods.cache_clear()
    sys.modules.pop("reconstruction.training.methods.glow", None)


def test_a_method_is_offered_by_command_window_and_settings_and_in_messages(glow, application):
    from groundstation.gui.reconstruct.choice_side import ChoiceForm
    from groundstation.services.reconstruct.training import config_of_request
    from reconstruction.training.methods.shader import Surroundings
    from reconstruction.training.methods.shaders import shader_of

    train, parser, told = described("train", "train")
    assert " glow Glow " in told
    asked = train.request_of(parser.parse_args(["train", "a", "-o", "b", "--method", "glow"]))
    config = config_of_request(asked)
    assert (config.method, config.iterations) == ("glow", 7)
    assert type(shader_of(config, Surroundings(None))).__name__ == glow
    form = ChoiceForm()
    form.method.setCurrentIndex(form.method.findData("glow"))
    assert (form.value().method, form.about.text()) == ("glow", "splats that glow")
    with pytest.raises(ValueError, match=r"expected .*, glow, got"):
        method_registry.method_named("absent")


@pytest.fixture
def haze(monkeypatch):
    """An effect more."""

    class Haze:
        """Air that is not clear."""

        name, what, tolerance, unit = "haze", "air that is not clear", 1.0, "grey levels"

        def assess(self, _probe):
            """Never worth it."""
            raise AssertionError("it is switched on")

    monkeypatch.setattr(registry, "EFFECTS", (*registry.EFFECTS, Haze()))


def test_an_effect_is_taken_by_the_command_decided_and_named_in_messages(haze):
    scene, parser, _ = described("scene", "scene", "render")
    words = ["scene", "render", "planar", "-o", "a", "--effects", "none", "--effects", "haze=on"]
    asked = scene._request(parser.parse_args(words))
    assert asked.settings.is_on("haze")
    assert not asked.settings.is_on("noise")
    with pytest.raises(InputError, match=r"--effects.*haze"):
        scene._request(parser.parse_args([*words, "--effects", "absent=on"]))
    with pytest.raises(InputError, match=r"there is no effect 'absent'; expected one of .*, haze"):
        registry.decide_effects(None, [None], RenderSettings(effects={"absent": "on"}))
