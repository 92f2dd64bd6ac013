"""Measured tilts come from a table, are written with the site, and make no plan one of another site."""

from dataclasses import replace

import pytest

from groundstation.services.site.tilts import read_tilts, tilts_text, with_tilts, without_tilts, write_tilted
from planning.base.errors import InputError
from planning.site.bundled import write_scene
from planning.site.file import is_planned_on, read_site, site_sha256
from planning.site.records import RallyPoint


@pytest.fixture
def site(tmp_path):
    path = write_scene("single-panel", tmp_path)
    return path, read_site(path)


def table(tmp_path, text):
    path = tmp_path / "tilts.csv"
    path.write_text(text, "utf-8")
    return path


def test_tilts_are_written_and_read_back_and_plans_stay_of_that_site(tmp_path, site):
    path, model = site
    (panel,) = model.site.panels
    tilts = read_tilts(table(tmp_path, f"panel,right_deg,up_deg\n{panel.id},0.3,-0.4\n"))
    out = tmp_path / "other" / "tilted.site.json"
    out.parent.mkdir()
    written = write_tilted(model, path, tilts, out)
    found = read_site(out)
    assert found.site.panels[0].tilt_deg == (0.3, -0.4)
    assert found.sha256 == written.sha256 != model.sha256
    # A tilt of 0.5 degrees turns what is mirrored by 1 degree: 4 minutes of the sun.
    assert tilts_text(found).endswith(
        "1 of 1 panes have measured tilts, up to 0.50 degrees: they shift their glare by up to 4.0 min"
    )
    assert is_planned_on(model.sha256, found)
    marked = replace(found.site, rally_points=(RallyPoint("r", (1.0, 2.0, 0.0)),))
    assert is_planned_on(model.sha256, replace(found, site=marked, sha256=site_sha256(marked)))
    moved = replace(found.site, home_enu_m=(9.0, -20.0, 0.0))
    assert not is_planned_on(model.sha256, replace(found, site=moved, sha256=site_sha256(moved)))
    assert write_tilted(found, out, None, tmp_path / "flat.site.json").site == model.site


def test_panes_that_the_table_leaves_out_keep_their_tilts(site):
    _, model = site
    tilted = with_tilts(model, {model.site.panels[0].id: (1.0, 0.0)})
    assert with_tilts(tilted, {}).site == tilted.site
    assert without_tilts(tilted).site == model.site
    assert tilts_text(model) == "no pane has a measured tilt"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected the first line panel,right_deg,up_deg"),
        ("id,right,up\n", "expected the first line panel,right_deg,up_deg"),
        ("panel,right_deg,up_deg\nA,1\n", "line 2: expected 3 values, got 2"),
        ("panel,right_deg,up_deg\n\nA,1,x\n", "line 3: expected -10 to 10 degrees, got 'x'"),
        ("panel,right_deg,up_deg\nA,nan,0\n", "line 2: expected -10 to 10 degrees, got 'nan'"),
        ("panel,right_deg,up_deg\nA,11,0\n", "got '11'"),
        ("panel,right_deg,up_deg\nA,1,0\nA,1,0\n", "line 3: panel 'A' stands there twice"),
    ],
)
def test_tables_that_are_none_are_refused_with_the_line(tmp_path, text, message):
    with pytest.raises(InputError) as error:
        read_tilts(table(tmp_path, text))
    assert message in str(error.value)
    assert "tilts.csv" in str(error.value)


def test_other_bytes_and_other_panels_are_refused(tmp_path, site):
    path = tmp_path / "t.csv"
    path.write_bytes(b"panel,right_deg,up_deg\n\xff,1,1\n")
    with pytest.raises(InputError, match="UTF-8"):
        read_tilts(path)
    with pytest.raises(InputError, match="no panel 'B-0007'"):
        with_tilts(site[1], {"B-0007": (0.0, 0.0)})
