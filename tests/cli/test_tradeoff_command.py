"""`tradeoff`: a table, a picture and a winner; bad input is one clear line and leaves nothing behind."""

import csv
import json

import pytest

from groundstation.cli.main import main
from planning.parameters import GreedyParameters
from planning.plan import read_plan, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site

QUICK = ["--views", "8", "--time-budget", "20", "--candidates", "300"]
SQUARE = """NAME: square
TYPE: TSP
DIMENSION: 4
EDGE_WEIGHT_TYPE: EUC_2D
NODE_COORD_SECTION
1 0 0
2 10 10
3 10 0
4 0 10
EOF
"""


def command(*arguments):
    return main(["tradeoff", *map(str, arguments)], lambda _wish: 9)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return write_scene("roof", tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="module")
def plan(site, tmp_path_factory):
    path = tmp_path_factory.mktemp("plan") / "roof.plan.json"
    write_plan(
        path, plan_flight(read_site(site), PlanRequest(n_views=10, greedy=GreedyParameters(400, improve=False))).plan
    )
    return path


def rows_of(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_plan_writes_table_and_picture_and_names_the_winner(site, tmp_path, capsys):
    out = tmp_path / "new" / "folder"
    methods = ["--methods", "greedy,orbit", "--precisions", "f64", "--steps", "15"]
    assert command("plan", site, "-o", out, *methods, *QUICK, "--json") == 0
    printed = json.loads(capsys.readouterr().out)
    assert sorted(path.name for path in out.iterdir()) == ["tradeoff-plan.csv", "tradeoff-plan.png"]
    assert (out / "tradeoff-plan.png").read_bytes().startswith(b"\x89PNG")
    (found,) = printed["sites"]
    assert printed["failed"] == []
    names = [run["run"] for run in found["runs"]]
    assert names == ["greedy", "orbit", "greedy f64", "greedy 15°", "greedy 300 candidates"]
    assert found["winner"] in names
    best = max(run["share"] for run in found["runs"])
    assert next(run["share"] for run in found["runs"] if run["run"] == found["winner"]) >= best - 0.05
    rows = rows_of(out / "tradeoff-plan.csv")
    for name in names:
        own = [row for row in rows if row["run"] == name]
        times, counts = [float(row["t_s"]) for row in own], [int(row["covered"]) for row in own]
        assert times == sorted(times)
        assert counts == sorted(counts)
        assert [row["is_final"] for row in own] == ["0"] * (len(own) - 1) + ["1"]
        assert own[-1]["finest_step_deg"] == "15.0"
        assert int(own[-1]["finest_covered"]) > 0
    last = next(row for row in rows if row["run"] == "greedy 15°" and row["is_final"] == "1")
    assert last["covered"] == last["finest_covered"]


@pytest.mark.long
def test_plan_answers_both_questions_in_words_and_tells_what_could_not_be_done(site, tmp_path, capsys):
    options = ["--methods", "pso", "--precisions", "f32", "--steps", "30", "--candidates", "20000"]
    assert command("plan", site, "-o", tmp_path, *options, "--coverage", "0.9", "--time-budget", "600") == 0
    captured = capsys.readouterr()
    assert "'greedy' wins with" in captured.out
    assert "after  1 s: " in captured.out
    assert "90 % of what can be covered in sections of 30°: after " in captured.out
    assert "warning: roof, pso f32 30° seed 0: " in captured.err
    assert "--views" in captured.err


@pytest.mark.slow
def test_several_jobs_find_what_one_finds(site, tmp_path, capsys):
    options = ["--methods", "greedy,orbit", "--precisions", "f32", "--steps", "30", "--seeds", "2", *QUICK, "--json"]
    shares = []
    for jobs in ("1", "2"):
        assert command("plan", site, "-o", tmp_path, *options, "--jobs", jobs) == 0
        shares.append([run["share"] for run in json.loads(capsys.readouterr().out)["sites"][0]["runs"]])
    assert shares[0] == shares[1]


@pytest.mark.slow
def test_route_compares_tsplib_files_and_plans_with_their_bounds_and_optima(site, plan, tmp_path, capsys):
    instance = tmp_path / "square.tsp"
    instance.write_text(SQUARE)
    (tmp_path / "square.opt.tour").write_text("TOUR_SECTION\n1\n3\n2\n4\n-1\nEOF")
    out = tmp_path / "out"
    assert command("route", instance, plan, site, "-o", out, "--seconds", "0.2", "--json") == 0
    square, roof = json.loads(capsys.readouterr().out)["tours"]
    assert (square["case"], square["optimum"], square["points"]) == ("square", 40, 4)
    assert (roof["case"], roof["optimum"], roof["unit"]) == ("roof", None, "s")
    assert roof["points"] == 1 + len(read_plan(plan).viewpoints)
    for tour in (square, roof):
        assert len(tour["runs"]) == 4
        for run in tour["runs"]:
            assert run["length"] >= tour["lower_bound"] - 1e-3
            assert run["gap"] >= -1e-6
    rows = rows_of(out / "tradeoff-route.csv")
    assert {row["case"] for row in rows} == {"square", "roof"}
    assert (out / "tradeoff-route.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_plan_finds_the_site_beside_it_and_asks_for_one_where_there_is_none(site, plan, tmp_path, capsys):
    beside = site.parent / "beside.json"
    beside.write_bytes(plan.read_bytes())
    options = ["--seconds", "0.1", "--methods", "nearest-neighbour"]
    assert command("route", beside, "-o", tmp_path / "a", *options) == 0
    beside.unlink()
    capsys.readouterr()
    assert command("route", plan, "-o", tmp_path / "b", *options) == 1
    assert "name its site file" in capsys.readouterr().err
    assert not (tmp_path / "b").exists()


@pytest.mark.long
@pytest.mark.few(4)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plan", "SITE", "--methods", "greedy,ants"], "no planning method 'ants'"),
        (["plan", "SITE", "--precisions", "f16"], "no precision 'f16'"),
        (["plan", "SITE", "--steps", "30,7"], "divisor of 90"),
        (["plan", "SITE", "--time-budget", "-1"], "expected more than 0 s"),
        (["plan", "nowhere.json"], "nowhere.json"),
        (["plan", "SITE", "SITE"], "called 'roof'"),
        (["plan", "SITE", "--min-distance", "500"], "home"),
        (["plan", "SITE", "--profile", "kite"], "kite"),
        (["route", "nowhere.tsp"], "nowhere.tsp"),
        (["route", "SITE"], "name a plan as well"),
        (["route", "PLAN", "SITE", "--methods", "ants"], "no routing method 'ants'"),
    ],
)
def test_bad_input_is_one_line_and_leaves_no_folder(arguments, message, site, plan, tmp_path, capsys):
    names = {"SITE": site, "PLAN": plan}
    assert command(*(names.get(word, word) for word in arguments), "-o", tmp_path / "a" / "b") == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith("error: ")
    assert message in line
    assert list(tmp_path.iterdir()) == []


def test_folder_that_cannot_be_made_is_told_before_anything_is_run(site, tmp_path, capsys):
    (tmp_path / "file").write_text("in the way")
    assert command("plan", site, "-o", tmp_path / "file" / "deeper") == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot be made" in line


@pytest.mark.long
def test_files_of_others_in_the_folder_stay(site, tmp_path, capsys):
    (tmp_path / "notes.txt").write_text("mine")
    assert command("plan", site, "-o", tmp_path, "--min-distance", "500") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["plan"],
        ["plan", "x", "-o", "y", "--jobs", "0"],
        ["plan", "x", "-o", "y", "--steps", "a"],
        ["plan", "x", "-o", "y", "--candidates", "1.5"],
        ["route", "x", "-o", "y", "--seconds", "nan"],
        ["route", "x", "-o", "y", "--methods", ","],
    ],
)
def test_wrong_usage_is_status_2(arguments, capsys):
    assert command(*arguments) == 2
    assert "usage" in capsys.readouterr().err
