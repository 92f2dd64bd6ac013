"""A parameter that is new in the record of planning is everywhere at once: what it costs is one field and its use."""

import argparse
from dataclasses import dataclass
from pathlib import Path

import pytest

from planning.base.errors import InputError
from planning.base.json_file import settings_over
from planning.base.parameters import check, parameter
from planning.parameters import HOW, PlanParameters
from planning.request import PlanRequest

NEW = {"help": "how long to wait for better views", "label": "Patience", "unit": "s", "least": 0.0, "most": 9.0}


@dataclass(frozen=True, slots=True)
class Wanted(PlanParameters):
    """Parameters of planning with one more."""

    patience_s: float = parameter(3.0, option="--patience", metavar="S", group=HOW, row="more", **NEW)

    def __post_init__(self):
        check(self)


@dataclass(frozen=True, slots=True)
class WantedRequest(PlanRequest):
    """A request with one parameter more."""

    patience_s: float = parameter(3.0, option="--patience", metavar="S", group=HOW, row="more", **NEW)

    def __post_init__(self):
        check(self)


@pytest.fixture
def command(monkeypatch):
    """`plan`, in a program whose record of planning has one more field."""
    from groundstation.cli.commands import plan

    monkeypatch.setattr(plan, "PlanParameters", Wanted)
    monkeypatch.setattr("planning.request.PlanRequest", WantedRequest)
    parser = argparse.ArgumentParser()
    plan.add_request_arguments(parser)
    return lambda *words: plan.request_of(parser.parse_args(words)), parser


def test_the_command_line_describes_takes_and_checks_it(command):
    request_of, parser = command
    assert "--patience S" in parser.format_help()
    assert "how long to wait for better views (default 3 s)" in " ".join(parser.format_help().split())
    assert request_of().patience_s == 3.0
    assert request_of("--patience", "4").patience_s == 4.0
    with pytest.raises(InputError, match="--patience: expected 0 to 9, got 10"):
        request_of("--patience", "10")


def test_settings_files_have_it_and_options_go_before_them(command, tmp_path):
    request_of, _ = command
    file = tmp_path / "plan.toml"
    file.write_text("patience_s = 5.0\n[rules]\nwind_m_s = 2.0\n")
    found = request_of("--settings", str(file), "--wind", "6")
    assert (found.patience_s, found.rules.wind_m_s) == (5.0, 6.0)
    with pytest.raises(InputError, match=r"patience_s: expected 0 to 9, got -1"):
        settings_over(Wanted(), {"patience_s": -1}, Path("plan.toml"))


def test_the_form_has_a_row_for_it(application, monkeypatch):
    from groundstation.gui.plan import plan_form

    monkeypatch.setattr(plan_form, "PlanParameters", Wanted)
    monkeypatch.setattr(plan_form, "PlanRequest", WantedRequest)
    form = plan_form.PlanForm()
    box = form.box("patience_s")
    assert form._further.layout().labelForField(box).text() == "Patience"
    assert (box.minimum(), box.maximum(), box.suffix()) == (0.0, 9.0, " s")
    assert box.toolTip() == "How long to wait for better views"
    box.setValue(7.0)
    assert form.value().patience_s == 7.0


def test_the_docs_list_it_and_translators_are_asked_for_its_texts(monkeypatch):
    from tests.docs import parameter_texts, settings

    table = "\n".join(settings._tables(Wanted, None, "", set()))
    assert "| `patience_s` | number | `3` | 0 to 9 | `--patience` | how long to wait for better views" in table.replace(
        "How long", "how long"
    )
    monkeypatch.setattr(parameter_texts, "RECORDS", (Wanted,))
    assert 'QT_TRANSLATE_NOOP("Parameters", "Patience")' in parameter_texts.module()
