"""`route`: known optima are reached within the budget; wrong files and values are refused."""

import pytest

BERLIN = 7542
"""Length of the shortest tour of berlin52 (TSPLIB95)."""


@pytest.fixture
def berlin(shared_data):
    return shared_data / "routing" / "tsplib" / "berlin52.tsp"


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("method", "longest", "budget_s"),
    [("local-search", BERLIN, 60), ("pyvrp", 7974, 2)],
    ids=["ends by itself", "starts at 7974 and ends with its time"],
)
def test_json_gives_the_length_of_a_good_tour(reflight, berlin, method, longest, budget_s):
    done = reflight("route", berlin, "--method", method, "--time-budget", budget_s, "--json")
    assert (done.status, done.err) == (0, "")
    assert BERLIN <= done.json["length"] <= longest
    assert sorted(done.json["tour"]) == list(range(1, 53))
    assert done.json["lower_bound"] <= BERLIN
    assert done.json["seconds"] > 0.0


def test_text_compares_with_the_nearest_neighbour(reflight, berlin):
    done = reflight("route", berlin, "--method", "nearest-neighbour", "--time-budget", 1)
    assert done.status == 0
    assert done.out.startswith("berlin52: 8980 through 52 points, proven to be ")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--time-budget", 0], "--time-budget: expected a positive number of seconds, got 0"),
        (["--time-budget", -1], "got -1"),
        (["--seed", -1], "--seed: expected 0 to 9223372036854775807"),
        (["--seed", 2**63, "--method", "pyvrp"], "--seed: expected 0 to 9223372036854775807"),
    ],
)
def test_wrong_values_are_refused(reflight, berlin, options, message):
    assert message in reflight("route", berlin, *options).error


def test_files_that_are_no_instance_are_refused(reflight, bad_file, shared_data, tmp_path):
    assert str(bad_file) in reflight("route", bad_file).error
    tour = shared_data / "routing" / "tsplib" / "berlin52.opt.tour"
    assert "expected TSP, ATSP or CVRP" in reflight("route", tour).error
    assert "found a folder" in reflight("route", tmp_path).error
    assert "found nothing of that name" in reflight("route", tmp_path / "missing.tsp").error
