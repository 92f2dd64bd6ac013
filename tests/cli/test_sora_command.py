"""`sora` writes a draft, and refuses what it cannot assess."""

import json

import numpy as np
import pytest

from tests.planning.insight.test_population import raster


def sora(reflight, pane, out, *arguments):
    return reflight("sora", pane / "plan.json", pane / "site.json", "-o", out, "--fly-aways", 9, *arguments)


def test_table_kml_and_geojson_are_written_and_people_hear_what_matters(reflight, pane, tmp_path):
    done = sora(reflight, pane, tmp_path / "out", "--population", "controlled", "--wind", "6", "--speed", "5")
    assert done.status == 0
    assert "ground risk class: 1 intrinsic, 1 final" in done.out
    assert "uninvolved people inside: nobody who is not involved (controlled ground area)" in done.out
    assert "9 of 9 ended inside" in done.out
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir()) == [".csv", ".geojson", ".html", ".kml", ".md"]
    assert len(json.loads((tmp_path / "out" / "sora.geojson").read_text())["features"]) == 3


def test_json_has_each_number_with_its_source(reflight, pane, tmp_path):
    done = sora(reflight, pane, tmp_path / "out", "--population", "1200", "--m2", "medium", "--json")
    assert (done.json["population"], done.json["intrinsic_grc"], done.json["final_grc"]) == ("suburban", 5, 4)
    numbers = {each["symbol"]: each for each in done.json["quantities"]}
    assert numbers["S_GPS"] == {
        "symbol": "S_GPS", "name": "GNSS error", "value": 3.0, "unit": "m", "formula": "",
        "source": "LBA guidance 1.7", "is_assumed": False,
    }  # fmt: skip
    assert numbers["w"]["value"] == 12.0
    assert done.json["fly_aways"]["share_inside"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--wind", "20"), "may fly in wind of up to 12 m/s, but 20 m/s are stated"),
        (("--population", "many"), "--population: expected one of controlled, remote"),
        (("--tilt", "60"), "--tilt: expected"),
        (("--m1a", "medium", "--m1b", "medium"), "--m1a: M1(A) medium and M1(B) count the same people"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(reflight, pane, tmp_path, arguments, said):
    done = sora(reflight, pane, tmp_path / "out", *arguments)
    assert said in done.error
    assert not (tmp_path / "out").exists()


def test_an_aircraft_nobody_described_has_to_be_described(reflight, pane, changed, tmp_path):
    plan = changed(pane / "plan.json", "profile", "")
    done = reflight("sora", plan, pane / "site.json", "-o", tmp_path / "out")
    assert "state largest dimension, take-off mass, full speed through the air, braking tilt" in done.error


def test_people_of_a_raster_make_the_class_and_a_raster_that_does_not_say_what_it_counts_is_refused(
    reflight, pane, tmp_path
):
    path = raster(tmp_path / "hkg_ppp_2020.tif", np.full((60, 60), 9.0))
    done = sora(reflight, pane, tmp_path / "out", "--population-raster", path, "--json")
    # 9 people on 86 m x 93 m.
    assert done.json["raster"]["most_per_km2"] == pytest.approx(1133.0, rel=0.02)
    assert (done.json["raster"]["product"], done.json["raster"]["counts"]) == ("WorldPop", "cell")
    assert done.json["population"] == "suburban"
    stated = sora(reflight, pane, tmp_path / "out", "--population-raster", path, "--population-counts", "km2", "--json")
    assert stated.json["raster"]["most_per_km2"] == 9.0
    unnamed = path.rename(tmp_path / "people.tif")
    refused = sora(reflight, pane, tmp_path / "no", "--population-raster", unnamed)
    assert refused.status == 1
    assert "people.tif: does not say whether it counts people in a cell" in refused.error
    assert not (tmp_path / "no").exists()
