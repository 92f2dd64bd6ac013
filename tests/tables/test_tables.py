from dataclasses import replace

import numpy as np
import pytest

from tests.tables import trainings
from tests.tables.__main__ import main
from tests.tables.definitions import Above, tables
from tests.tables.measured import real_section
from tests.tables.page import gap_db, write_page
from tests.tables.results import Result, keep, of_case, read_results
from tests.tables.scales import PAPER, SCALES, SMALL, SMOKE
from tests.tables.trainings import Case, whole_panels

TABLE_5 = tables(SMALL)[-1]


def result(case, psnr_db, seed=0, scale=SMALL):
    made_with = case.made_with("curved", scale)
    return Result("curved", case.title, seed, scale.name, made_with, psnr_db, 20.0, 0.9, None, 60.0, 9, 9, "here")


def page(tmp_path, results):
    write_page(tmp_path / "tables.md", tables(SMALL), SMALL, results)
    return (tmp_path / "tables.md").read_text("utf-8")


@pytest.mark.few(1)
@pytest.mark.parametrize("scale", SCALES.values(), ids=SCALES)
def test_all_cases_can_be_trained_and_no_two_of_a_table_alike(scale):
    for table in tables(scale):
        made_with = [case.made_with(table.scenes[0], scale) for case in table.cases]
        assert len(set(made_with)) == len(made_with)
        titles = {case.title for case in table.cases}
        assert all({request.better, *request.others} <= titles for request in table.must_hold)


def test_a_case_is_another_one_with_other_settings_or_photos_but_not_with_another_seed():
    case = TABLE_5.cases[0]
    made_with = case.made_with("curved", SMALL)
    assert made_with == case.made_with("curved", SMALL)
    assert case.config(SMALL, 1) == replace(case.config(SMALL, 0), seed=1)
    assert case.made_with("planar", SMALL) != made_with != case.made_with("curved", SMOKE)
    assert replace(case, settings={"rates": {"means": 1e-3}}).made_with("curved", SMALL) != made_with
    assert replace(case, settings={**case.settings, "start_from": "points"}).made_with("curved", SMALL) != made_with
    assert replace(case, n_views=SMALL.n_views).made_with("curved", SMALL) == made_with


def test_a_case_with_more_photos_is_scored_on_the_same_views():
    case = TABLE_5.cases[0]
    more = replace(case, n_views=999)
    assert [each.photos("curved", SMALL)[0].n_views for each in (case, more)] == [SMALL.n_views, 999]
    assert case.photos("curved", SMALL)[1] == more.photos("curved", SMALL)[1]
    assert case.made_with("curved", SMALL) != more.made_with("curved", SMALL)


def test_a_case_is_another_one_after_the_program_changed_what_it_depends_on(monkeypatch):
    discs, ellipsoids = Case("2DGS", "2dgs"), Case("3DGS", "3dgs")
    before = [case.made_with("planar", SMALL) for case in (discs, ellipsoids)]
    monkeypatch.setattr(trainings, "_changes", lambda config: [])
    assert discs.made_with("planar", SMALL) != before[0]
    assert ellipsoids.made_with("planar", SMALL) == before[1]


def test_a_method_s_own_settings_of_a_scale_come_before_the_case_s():
    scale = replace(SMALL, own={"2dgs": {"rates": {"means": 1e-3, "scales": 1e-3}}})
    case = Case("2DGS", "2dgs", {"rates": {"means": 2e-3}})
    rates = case.config(scale, 0).rates
    assert (rates.means, rates.scales) == (2e-3, 1e-3)
    assert Case("3DGS", "3dgs").config(scale, 0).rates == SMALL.config.rates


def test_paper_scale_has_the_paper_s_network_and_steps():
    shape = PAPER.shape
    assert (shape.width, shape.layers, shape.position_order, shape.direction_order) == (512, 8, 12, 12)
    assert (PAPER.config.iterations, PAPER.n_views, PAPER.width_px) == (200_000, 600, 5280)


def test_results_are_kept_and_replaced_one_by_one(tmp_path):
    first, second = (result(case, 25.0) for case in TABLE_5.cases[:2])
    keep(tmp_path / "a.csv", [first, second])
    better = replace(first, psnr_db=26.0, lpips=0.25)
    keep(tmp_path / "a.csv", [better])
    assert read_results(tmp_path / "a.csv") == [better, second]
    assert read_results(tmp_path / "none.csv") == []


@pytest.mark.slow
def test_what_benchmarks_measured_stands_beside_the_paper_s_numbers(tmp_path):
    empty = page(tmp_path, [])
    assert "| Overall mIoU | not run |  | 0.9895 | 0.8597 |" in empty
    measured = tmp_path / "benchmarks"
    measured.mkdir()
    head = "scene,what,value,unit,ratio,against,target,met,seeds\n"
    panels = (
        "made-planar,overall mIoU (glass and the rest),0.9812,,,,,,50\n"
        'made-planar,coverage percentiles,"20 %: 1.0000, 10 %: 0.9000, 5 %: 0.7500",,,,,,50\n'
        "made-planar,individual mIoU,0.9700,,,,,,50\n"
    )
    (measured / "segmentation.csv").write_text(head + panels, "utf-8")
    photos = (
        '"glass, 4 photos",overall mIoU (glass and the rest),0.9,,,,,,4\n'
        '"glass, 4 photos",coverage percentiles,"20 %: 1.0000, 10 %: 0.9000, 5 %: 0.8000",,,,,,4\n'
        '"glass, 4 photos","individual mIoU, --network auto",0.85,,,,,,1\n'
    )
    (measured / "network.csv").write_text(head + photos, "utf-8")
    views = 'office,"100 views, PSO, 2.3 s",7175.7,sections,0.7722,the bound,,,3\n'
    (measured / "fig14.csv").write_text(head + views, "utf-8")
    gap = 'planar,"64 px, street of 28 m, mlp: our plan above NOTO",3.21,dB,,"NOTO 24.0, ours 27.2 dB",,,2\n'
    (measured / "plan-gap.csv").write_text(head + gap, "utf-8")
    text = page(tmp_path, [])
    assert "| 64 px, street of 28 m, mlp | 3.21 | NOTO 24.0, ours 27.2 dB |" in text
    assert text.index("How the gap grows") < text.index("## Table 3")
    assert "| Overall mIoU | 0.9812 | 50 | 0.9895 | 0.8597 |" in text
    assert "| Coverage, 5 % | 0.7500 | 50 | 1.0000 | 1.0000 |" in text
    assert "| Overall mIoU | not run |  | 0.9871 | 0.7316 |" in text
    assert "| | glass, 4 photos |\n| --- | ---: |\n| Overall mIoU | 0.9000 |" in text
    assert "| Individual mIoU | 0.8500 |" in text
    assert "| 100 | 77.2 % |  |  |  |" in text


def test_real_photos_have_a_row_for_each_method_on_each_set_that_is_there(tmp_path):
    assert "Not run." in "\n".join(real_section(tmp_path))
    (tmp_path / "benchmarks").mkdir()
    rows = (
        "scene,what,value,unit,ratio,against,target,met,seeds\n"
        'wall,2DGS,19.53,dB,,"whole pictures 19.82 dB; facades SSIM 0.678, LPIPS 0.389, FLIP 0.310; 9 steps",,,1\n'
        'wall,ours,19.4,dB,,"whole pictures 19.74 dB; facades SSIM 0.668, FLIP 0.316; 9 steps",,,1\n'
        "wall,ours against 2DGS,-0.13,dB,,,no more than 0.2 dB below,True,1\n"
        "castle,photos that found their place,11,,,of 11,,,1\n"
        'castle,2DGS,17.0,dB,,"whole pictures 17.00 dB; facades SSIM 0.8; 9 steps",,,1\n'
        "castle,ours,not run,,,no panels,,,1\n"
        "door,skipped,not run,,,it is not on this machine,,,1\n"
    )
    (tmp_path / "benchmarks" / "real-photos.csv").write_text(rows, "utf-8")
    text = "\n".join(real_section(tmp_path))
    assert "| | | PSNR | SSIM | LPIPS | FLIP |" in text
    assert "| wall | 2DGS | 19.53 | 0.678 | 0.389 | 0.310 |" in text
    assert "| wall | ours | 19.40 | 0.668 |  | 0.316 |" in text
    assert "| castle | 2DGS | 17.00 | 0.8 |  |  |" in text
    assert "| castle | ours | not run |  |  |  |" in text
    assert "found their place" not in text
    assert "| door" not in text
    assert "against" not in text


@pytest.mark.slow
def test_results_of_other_settings_are_said_to_be_older_and_not_compared(tmp_path):
    *others, whole = TABLE_5.cases
    oldest, old = (replace(result(whole, db), made_with=f"{db}") for db in (24.0, 25.0))
    assert of_case([old], "curved", whole.made_with("curved", SMALL)) == []
    text = page(tmp_path, [oldest, old, *(result(case, 26.0) for case in others)])
    assert f"| {whole.title} (older settings) | 25.00 |" in text
    assert "24.00" not in text
    assert f"{whole.title} above" not in text.partition("## Table 5")[2]
    assert f"| {whole.title} | not run |" in page(tmp_path, [replace(old, scale="smoke"), replace(old, scene="planar")])


@pytest.mark.slow
def test_a_training_that_several_tables_have_is_shown_in_each(tmp_path):
    whole = TABLE_5.cases[3]
    lines = [line for line in page(tmp_path, [result(whole, 27.0)]).splitlines() if "0: 27.00" in line]
    assert [line.split(" | ")[0] for line in lines] == [
        "| our plan, RefGlass-GS",
        "| RefGlass-GS",
        "| RefGlass-GS",
        "| RefGlass-GS",
    ]


@pytest.mark.slow
def test_the_page_has_means_seeds_and_the_paper_s_numbers(tmp_path):
    case = TABLE_5.cases[0]
    text = page(tmp_path, [result(case, 25.0, 1), result(case, 26.0, 0)])
    assert f"| {case.title} | 25.50 | 20.00 |  | 0.9000 |  | 60 | 9 | 0: 26.00, 1: 25.00 | 28.25 |" in text


@pytest.mark.slow
def test_glass_alone_is_shown_and_compared_where_it_is_known_of_all(tmp_path):
    *others, whole = TABLE_5.cases
    results = [replace(result(case, 25.0), glass_db=24.0) for case in others]
    text = page(tmp_path, [*results, replace(result(whole, 24.5), glass_db=26.5)])
    assert f"| {whole.title} | 24.50 | 20.00 | 26.50 |" in text
    assert f"- {whole.title} above {others[0].title}: -0.50 dB (at least 0: **missed**)" in text
    assert f"- {whole.title} above {others[0].title}, on glass alone: +2.50 dB (at least 0: met)" in text
    assert "on glass alone" not in page(tmp_path, [*results, result(whole, 24.5)])


def test_pixels_of_glass_alone_have_neighbours_of_the_same_panel():
    numbers = np.full((6, 9), -1)
    numbers[1:6, 1:4], numbers[1:6, 4:9] = 3, 4
    within = whole_panels(numbers)
    assert set(zip(*np.nonzero(within), strict=True)) == {(y, x) for y in (2, 3, 4) for x in (2, 5, 6, 7)}
    assert not whole_panels(np.full((4, 4), -1)).any()


@pytest.mark.slow
@pytest.mark.parametrize(("whole_db", "word"), [(25.5, "met"), (24.5, "**missed**")])
def test_what_must_hold_is_said_to_be_met_or_missed(tmp_path, whole_db, word):
    *others, whole = TABLE_5.cases
    results = [result(whole, whole_db), *(result(case, 25.0) for case in others)]
    request = TABLE_5.must_hold[0]
    assert gap_db(TABLE_5, request, "curved", SMALL, results) == pytest.approx(whole_db - 25.0)
    assert f"{whole_db - 25.0:+.2f} dB (at least 0: {word})" in page(tmp_path, results)


@pytest.mark.slow
def test_what_is_known_so_far_is_said_with_what_was_not_run(tmp_path):
    methods = tables(SMALL)[1]
    by_title = {case.title: case for case in methods.cases}
    known = [result(by_title[title], value) for title, value in (("RefGlass-GS", 25.0), ("2DGS", 23.0))]
    text = page(tmp_path, known)
    left = "3DGS, GaussianShader, Ref-Gaussian, Ref-GS"
    assert f"- RefGlass-GS above 2DGS: +2.00 dB (at least 3: **missed**; not run: {left})" in text
    assert "Reflight above" not in text


def test_nothing_is_said_of_what_was_not_run():
    request = Above(TABLE_5.cases[3].title, (TABLE_5.cases[0].title,), 0.0)
    assert gap_db(TABLE_5, request, "curved", SMALL, [result(TABLE_5.cases[3], 30.0)]) is None


@pytest.mark.slow
def test_plans_are_flown_photographed_learned_from_and_scored(tmp_path):
    arguments = ["--scale", "smoke", "--only", "2", "--scene", "planar", "--jobs", "1"]
    arguments += ["--work", str(tmp_path / "work"), "--out", str(tmp_path)]
    assert main(arguments) == 0
    kept = read_results(tmp_path / "tables" / "results.csv")
    assert {each.case for each in kept} == {case.title for case in tables(SMOKE)[0].cases}
    assert all(5.0 < each.psnr_db < 40.0 and each.n_steps == 12 for each in kept)
    assert all(each.glass_db is not None and 5.0 < each.glass_db < 40.0 for each in kept)
    for each in kept:
        views = [tuple(map(float, view.split(":"))) for view in each.views.split()]
        assert all(0.0 <= share <= 1.0 for share, _ in views)
        assert sum(psnr_db for _, psnr_db in views) / len(views) == pytest.approx(each.psnr_db, abs=0.01)
    assert (tmp_path / "tables" / "2-planar-smoke.png").is_file()
    before = (tmp_path / "tables" / "results.csv").read_bytes()
    assert main(arguments) == 0
    assert (tmp_path / "tables" / "results.csv").read_bytes() == before
