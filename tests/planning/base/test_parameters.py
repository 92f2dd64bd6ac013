"""What a field declares holds everywhere: checks, paths, changes, and the words of its range."""

import math
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.simulator.conditions import Conditions
from planning.base.errors import InputError
from planning.base.json_file import settings_over
from planning.base.parameters import Choice, Parameter, check, declared, like, parameter, with_values
from planning.parameters import METHOD_NAMES, Constraints, FlightRules, PlanParameters
from reconstruction.panels.search.parameters import SegmentationParameters

RECORDS = [PlanParameters, Conditions, SegmentationParameters]


@dataclass(frozen=True, slots=True)
class Inner:
    """A record in a record.

    Parameters
    ----------
    depth_m, width_m
        Of the hole.
    """

    depth_m: float = parameter(1.0, least=0.0, most=2.0)
    width_m: float = parameter(1.0, above=0.0)
    kind: str = parameter("round", choices=(Choice("round"), Choice("square", word="box")))

    def __post_init__(self):
        check(self)


@dataclass(frozen=True, slots=True)
class Outer:
    """Of a record with parameters and one without a declaration."""

    inner: Inner = Inner()
    n: int | None = parameter(None, "how many", least=1)
    plain: int = 3

    def __post_init__(self):
        check(self)


def test_parameters_of_records_within_are_found_by_their_paths():
    assert list(declared(Outer)) == ["inner.depth_m", "inner.width_m", "inner.kind", "n"]
    assert declared(Outer)["n"].kind is int
    assert declared(Outer)["inner.depth_m"].value_in(Outer(Inner(depth_m=2.0))) == 2.0
    assert with_values(Outer(), {("inner", "depth_m"): 2.0, ("n",): 4}) == Outer(Inner(depth_m=2.0), 4)


def test_help_that_is_not_declared_is_taken_from_the_docstring():
    assert declared(Inner)["depth_m"].parameter.help == declared(Inner)["width_m"].parameter.help == "Of the hole."


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"depth_m": -1.0}, "depth_m: expected 0 to 2, got -1.0"),
        ({"depth_m": math.nan}, "depth_m: expected 0 to 2, got nan"),
        ({"width_m": 0.0}, "width_m: expected more than 0, got 0.0"),
        ({"width_m": math.inf}, "width_m: expected more than 0, got inf"),
        ({"kind": "box"}, "kind: expected round or square, got 'box'"),
    ],
)
def test_values_out_of_range_are_refused_with_the_range(values, message):
    with pytest.raises(ValueError, match=message.replace(".", r"\.")):
        Inner(**values)


@given(st.floats(-10.0, 10.0), st.none() | st.floats(-5.0, 5.0), st.none() | st.floats(-5.0, 5.0), st.booleans())
def test_a_range_holds_what_lies_between_its_ends(value, low, high, is_open):
    known = Parameter(above=low, below=high) if is_open else Parameter(least=low, most=high)
    above = low is None or (value > low if is_open else value >= low)
    below = high is None or (value < high if is_open else value <= high)
    assert known.holds(value) == (above and below)


def test_a_parameter_like_another_has_its_facts_but_for_those_that_change():
    @dataclass(frozen=True)
    class Other:
        wind_m_s: float = like(FlightRules, "wind_m_s", 3.0, help="here")

    known = declared(FlightRules)["wind_m_s"].parameter
    assert declared(Other)["wind_m_s"].parameter == replace(known, help="here")
    assert Other().wind_m_s == 3.0


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_every_default_is_in_its_range_and_every_parameter_says_what_it_is(record):
    for name, each in declared(record).items():
        assert each.default is None or each.parameter.holds(each.default), name
        assert each.parameter.help, name
        assert not each.parameter.row or each.parameter.label, name
    options = [each.parameter.option for each in declared(record).values() if each.parameter.option]
    assert len(options) == len(set(options))


def test_the_methods_that_are_offered_are_those_there_are():
    from planning.viewpoints.methods import METHODS

    assert tuple(METHODS) == METHOD_NAMES


def test_a_settings_file_may_name_any_parameter_and_nothing_else():
    content = {"seed": 4, "constraints": {"min_distance_m": 7.0}, "greedy": {"n_candidates": 50}}
    found = settings_over(PlanParameters(), content, Path("plan.toml"))
    assert (found.seed, found.constraints, found.greedy.n_candidates) == (4, Constraints(7.0), 50)
    with pytest.raises(InputError, match=r"plan\.toml: rules\.wind: no such setting; known are: battery_reserve"):
        settings_over(PlanParameters(), {"rules": {"wind": 3.0}}, Path("plan.toml"))
    with pytest.raises(InputError, match=r"plan\.toml: greedy\.n_candidates: expected 1 to 1000000, got 0"):
        settings_over(PlanParameters(), {"greedy": {"n_candidates": 0}}, Path("plan.toml"))


def test_describing_commands_loads_no_numerics():
    code = (
        "import sys, planning.parameters, missions.simulator.conditions\n"
        "from groundstation.cli.main import build_parser\nbuild_parser()\n"
        "print([name for name in ('numpy', 'msgspec', 'torch') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60)
    assert done.stdout.strip() == "[]", done.stderr
