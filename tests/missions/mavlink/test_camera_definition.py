"""Camera definition files: read as they are meant, and never trusted."""

import lzma
import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.camera_definition import (
    MAX_BYTES,
    CameraOption,
    CameraParameter,
    find_parameter,
    parse_definition,
    read_definition,
    value_of,
)
from planning.base.errors import InputError


def definition(
    *parameters: str, head: str = "<definition version='1'><model>T100</model><vendor>Foo</vendor></definition>"
):
    return f"<mavlinkcamera>{head}<parameters>{''.join(parameters)}</parameters></mavlinkcamera>".encode()


GUIDE = definition(
    '<parameter name="CAM_EXPMODE" type="uint32" default="0"><description>Exposure Mode</description><options>'
    '<option name="Auto" value="0"><exclusions><exclude>CAM_ISO</exclude></exclusions></option>'
    '<option name="Manual" value="1"/></options></parameter>',
    '<parameter name="CAM_SHUTTERSPD" type="float" default="0.016666" control="1"><description>Shutter Speed'
    '</description><options><option name="1/60" value="0.016666"/><option name="1/500" value="0.002"/></options>'
    "</parameter>",
    '<parameter name="CAM_EV" type="float" default="0" min="-3" max="3" step="0.33"><description>EV</description>'
    "</parameter>",
    '<parameter name="CAM_NAME" type="string" default=""/>',
)
"""After the example of MAVLink's guide."""


def test_the_guides_example_is_read_packed_or_not(tmp_path):
    found = parse_definition(GUIDE, "guide")
    assert (found.vendor, found.model) == ("Foo", "T100")
    mode, shutter, compensation, name = found.parameters
    assert mode == CameraParameter(
        "CAM_EXPMODE", 5, "Exposure Mode", (CameraOption("Auto", 0), CameraOption("Manual", 1)), default=0.0
    )
    assert (shutter.kind, [option.value for option in shutter.options]) == (9, [0.016666, 0.002])
    assert (compensation.least, compensation.most) == (-3.0, 3.0)
    assert not name.is_settable
    assert parse_definition(lzma.compress(GUIDE), "guide") == found
    (tmp_path / "camera.xml").write_bytes(GUIDE)
    assert read_definition(tmp_path / "camera.xml") == found


RANGES = definition(
    '<parameter name="CAM_MODE" type="uint32" default="1"><options><option name="Photo" value="0"/>'
    '<option name="Video" value="1"><exclusions><exclude>CAM_PHOTOFMT</exclude></exclusions><parameterranges>'
    '<parameterrange parameter="CAM_ISO" condition="CAM_EXPMODE=1"><roption name="100" value="100"/>'
    '<roption name="200" value="200"/></parameterrange><parameterrange parameter="CAM_EV" '
    'condition="CAM_EXPMODE!=1 AND CAM_WBMODE=0 OR CAM_EXPMODE=7"><roption name="0" value="0"/></parameterrange>'
    "</parameterranges></option></options></parameter>",
    '<parameter name="CAM_EXPMODE" type="uint8" default="0"><options><option name="Auto" value="0"/>'
    '<option name="Manual" value="1"/></options></parameter>',
    '<parameter name="CAM_ISO" type="uint32"><options><option name="100" value="100"/><option name="200" value="200"/>'
    '<option name="6400" value="6400"/></options></parameter>',
    '<parameter name="CAM_EV" type="float" min="-3" max="3"/>',
    '<parameter name="CAM_PHOTOFMT" type="uint8"><options><option name="Raw" value="0"/></options></parameter>',
)
"""After the guide's section on ranges."""


def left(name, **values):
    """What is left of a parameter's options; None where it has no effect."""
    found = parse_definition(RANGES, "guide")
    parameter = next(each for each in found.parameters if each.name == name)
    rest = found.left_of(parameter, values)
    return None if rest is None else [option.value for option in rest.options]


def test_what_a_parameter_can_have_goes_by_the_values_of_others():
    whole = [100.0, 200.0, 6400.0]
    assert left("CAM_ISO") == whole, "nothing is known of the mode"
    assert left("CAM_ISO", CAM_MODE=0, CAM_EXPMODE=1) == whole
    assert left("CAM_ISO", CAM_MODE=1, CAM_EXPMODE=0) == whole
    assert left("CAM_ISO", CAM_MODE=1, CAM_EXPMODE=1) == [100.0, 200.0]
    assert left("CAM_PHOTOFMT", CAM_MODE=0) == [0.0]
    assert left("CAM_PHOTOFMT", CAM_MODE=1) is None
    free, nought = [], [0.0]
    assert left("CAM_EV", CAM_MODE=1, CAM_EXPMODE=0, CAM_WBMODE=0) == nought
    assert left("CAM_EV", CAM_MODE=1, CAM_EXPMODE=0, CAM_WBMODE=4) == free
    assert left("CAM_EV", CAM_MODE=1, CAM_EXPMODE=1, CAM_WBMODE=0) == free
    assert left("CAM_EV", CAM_MODE=1, CAM_EXPMODE=7) == nought
    found = parse_definition(RANGES, "guide")
    assert found.defaults == {"CAM_MODE": 1.0, "CAM_EXPMODE": 0.0}
    assert found.rulers_of(["CAM_ISO"]) == ("CAM_MODE", "CAM_EXPMODE")
    assert found.rulers_of(["CAM_WBMODE"]) == ()


def test_a_condition_that_cannot_be_read_limits():
    found = parse_definition(RANGES.replace(b"CAM_EXPMODE=1", b"the sun shines"), "x")
    (iso,) = (each for each in found.parameters if each.name == "CAM_ISO")
    assert len(found.left_of(iso, {"CAM_MODE": 1.0}).options) == 2
    assert len(found.left_of(iso, {"CAM_MODE": 0.0}).options) == 3


ENTITIES = b"""<?xml version="1.0"?><!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>
<mavlinkcamera><definition version="1"><model>&b;</model></definition></mavlinkcamera>"""
ABROAD = b"""<?xml version="1.0"?><!DOCTYPE m [<!ENTITY x SYSTEM "file:///etc/passwd">]>
<mavlinkcamera><definition version="1"><model>&x;</model></definition></mavlinkcamera>"""


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (ENTITIES, "declares a document type or entities; no camera needs that"),
        (ABROAD, "declares a document type or entities"),
        (b"<mavlinkcamera>" + b"<a>" * 2000 + b"</a>" * 2000 + b"</mavlinkcamera>", "nested"),
        (b" " * (MAX_BYTES + 1), "larger than 1024 kB"),
        (lzma.compress(b"<mavlinkcamera>" + b" " * (8 << 20)), "larger than 1024 kB"),
        (lzma.compress(GUIDE)[:40], "no XML"),
        (b"\xfd7zXZ\0 and no more", "cannot be unpacked"),
        (b"", "no XML"),
        (b"<html/>", "expected <mavlinkcamera>, got <html>"),
        (definition('<parameter name="A" type="uint8"/>' * 2), "names the parameter 'A' twice"),
        (definition(*(f'<parameter name="P{n}" type="uint8"/>' for n in range(501))), "names 501 parameters"),
        (definition('<parameter name="A" type="uint9"/>'), "has the type 'uint9'"),
        (definition('<parameter name="" type="uint8"/>'), "without a name"),
        (definition('<parameter name="A_NAME_OF_MORE_THAN_16" type="uint8"/>'), "without a name"),
        (definition('<parameter name="A" type="float" min="3" max="1"/>'), "a range that is none"),
        (definition('<parameter name="A" type="float" min="nan"/>'), "a range that is none"),
        (
            definition('<parameter name="A" type="uint8"><options><option name="x" value="?"/></options></parameter>'),
            "an option that is no number",
        ),
        (
            definition(
                '<parameter name="A" type="uint8"><options>'
                + '<option name="x" value="1"/>' * 1001
                + "</options></parameter>"
            ),
            "has 1001 options",
        ),
    ],
)
def test_what_is_hostile_or_no_definition_is_refused(content, told):
    with pytest.raises(InputError, match=told) as refused:
        parse_definition(content, "camera 100")
    assert str(refused.value).startswith("camera 100: ")


@given(st.integers(0, 2**32 - 1))
def test_a_damaged_definition_is_read_or_refused_and_nothing_else(seed):
    rng = random.Random(seed)
    content = bytearray(GUIDE if rng.random() < 0.7 else lzma.compress(GUIDE))
    for _ in range(rng.randint(1, 8)):
        at = rng.randrange(len(content))
        if rng.random() < 0.3:
            del content[at : at + rng.randint(1, 30)]
        else:
            content[at] = rng.randrange(256)
        content = content or bytearray(b"<")
    try:
        found = parse_definition(bytes(content), "camera")
    except InputError:
        return
    for parameter in found.parameters:
        assert 1 <= len(parameter.name) <= 16
        assert all(math.isfinite(option.value) for option in parameter.options)


def test_texts_of_a_definition_are_one_short_line():
    head = "<definition version='1'><model>Q\n7 \u202e" + "x" * 500 + "</model></definition>"
    model = parse_definition(definition(head=head), "camera").model
    assert len(model) <= 100
    assert model.startswith("Q 7  x")


@pytest.mark.parametrize(
    ("names", "wanted", "absolute", "number"),
    [
        (["1/60", "1/500 s"], 1 / 500, 0.0, 1),
        (["0.5", "2.0"], 2.0, 0.0, 1),
        (["ISO 100", "ISO 125", "ISO 200"], 125.0, 0.0, 1),
        (["f/5.6", "F6.3"], 6.3, 0.0, 1),
        (["-0.3", "0", "+0.3 EV"], 1 / 3, 0.06, 2),
        (["-0.3", "0", "+0.3 EV"], 0.0, 0.06, 1),
        (["1/60", "1/500"], 1 / 640, 0.0, None),
        (["Auto", "Manual mode"], "manual", 0.0, 1),
        (["Automatic", "Daylight"], "sunny", 0.0, 1),
        (["A", "B"], "sunny", 0.0, None),
        (["1/0", "1/500"], 1 / 500, 0.0, 1),
    ],
)
def test_an_option_is_told_by_its_name(names, wanted, absolute, number):
    options = tuple(CameraOption(name, 10.0 + n) for n, name in enumerate(names))
    found = value_of(CameraParameter("A", 5, options=options), wanted, absolute)
    assert found == (None if number is None else options[number])


def test_without_names_the_values_tell_and_without_options_the_range():
    options = (CameraOption("slow", 1 / 60), CameraOption("fast", 1 / 1000))
    assert value_of(CameraParameter("A", 9, options=options), 1 / 1000) == options[1]
    free = CameraParameter("A", 9, least=2.8, most=11.0)
    assert value_of(free, 5.6).value == 5.6
    assert value_of(free, 16.0) is None
    assert value_of(free, "manual") is None


def test_a_parameter_is_found_by_name_or_by_what_is_said_of_it_alone():
    found = parse_definition(GUIDE, "guide")
    assert find_parameter(found, ("EXP", "CAM_EV"), ()).name == "CAM_EV"
    assert find_parameter(found, ("EXP",), ("^shutter",)).name == "CAM_SHUTTERSPD"
    assert find_parameter(found, ("EXP",), ("e",)) is None, "several are none"
    assert find_parameter(found, ("CAM_NAME",), ()) is None, "a text is no number to set"
