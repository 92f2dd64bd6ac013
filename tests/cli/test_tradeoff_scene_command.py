"""`tradeoff scene`: table, picture, and what it refuses."""

import csv

import pytest

QUICK = (
    "--width",
    48,
    "--views",
    1,
    "--truth-rays",
    0,
    "--samples",
    "1",
    "--widths",
    "24",
    "--effects",
    "near-field-reflection=on",
)


@pytest.mark.slow
def test_a_table_and_a_picture_are_written(reflight, tmp_path):
    out = tmp_path / "out"
    done = reflight("tradeoff", "scene", "planar-far", "-o", out, *QUICK, "--turn", "shadow")
    assert "truth: embedded" in done.out
    rows = list(csv.DictReader((out / "tradeoff-scene.csv").read_text(encoding="utf-8").splitlines()))
    assert [row["setting"] for row in rows][:4] == ["the truth", "as the scene decides", "samples 1", "width 24"]
    assert (out / "tradeoff-scene.png").stat().st_size > 10_000


@pytest.mark.slow
def test_it_speaks_json(reflight, tmp_path):
    found = reflight("tradeoff", "scene", "planar-far", "-o", tmp_path, *QUICK, "--turn", "none", "--json").json
    assert found["truth"]["error"] == 0.0
    assert [row["setting"] for row in found["settings"]] == [
        "the truth",
        "as the scene decides",
        "samples 1",
        "width 24",
    ]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--turn", "fog"), "there is no effect 'fog'"),
        (("--widths", "8"), "--widths: expected 16 or more"),
        (("--truth-rays", "-1"), "--truth-rays: expected 0 or more"),
        (("--width", "3"), "--width: expected 16 to 20000"),
        (("--views", "0"), "--views"),
    ],
)
def test_wrong_values_are_refused_in_the_words_of_the_options(reflight, tmp_path, arguments, said):
    done = reflight("tradeoff", "scene", "planar-far", "-o", tmp_path, *QUICK, *arguments)
    assert done.status == 1
    assert said in done.err
