"""How good found panels are: what is written is read, and holds for panels that are where they were found."""

import json

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.site.records import Panel
from reconstruction.panels.solving.accuracy import PanelAccuracy, facades_path, read_facades
from reconstruction.panels.solving.facades_file import facades_bytes, found_facades
from tests.services.photo_cases import draft_of


@pytest.fixture(scope="module")
def draft():
    return draft_of()


def site_panel(solved, moved_m=0.0):
    corners = np.round(solved.corners_enu_m, 4) + np.array([moved_m, 0.0, 0.0])
    return Panel(solved.id, tuple(tuple(corner) for corner in corners.tolist()))


def test_what_is_written_is_read_and_says_what_the_covariances_say(draft, tmp_path):
    path = tmp_path / "a.facades.json"
    path.write_bytes(facades_bytes(draft.found, draft.photos))
    read, made = read_facades(path), found_facades(draft.found, draft.photos)
    assert read.content == made.content == path.read_bytes()
    assert read.panels == made.panels
    assert len(read.panels) == 30
    for solved in draft.facade("A").panels:
        known = read.of(site_panel(solved))
        traces = np.trace(solved.covariance_m2, axis1=1, axis2=2)
        assert known.corner_sigma_m == pytest.approx(np.sqrt(traces.mean()), abs=2e-5)
        assert known.confidence == pytest.approx(solved.confidence, abs=1e-4)


def test_a_panel_that_was_moved_or_is_another_is_not_known(draft):
    found, solved = found_facades(draft.found, draft.photos), draft.facade("A").panels[0]
    assert found.of(site_panel(solved, 0.0005)) is not None
    assert found.of(site_panel(solved, 0.01)) is None
    assert found.of(Panel("other", site_panel(solved).corners_enu_m)) is None


def test_a_file_that_does_not_say_where_its_panels_are_is_read_and_tells_nothing(draft, tmp_path):
    content = json.loads(facades_bytes(draft.found, draft.photos))
    for panel in content["facades"][0]["panels"]:
        del panel["corners_enu_m"]
    path = tmp_path / "old.facades.json"
    path.write_text(json.dumps(content))
    assert read_facades(path).of(site_panel(draft.facade("A").panels[0])) is None


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("confidence", 1.5, "confidence: expected 0 to 1, got 1.5"),
        ("corner_sigmas_enu_m", [[-1.0, 0.0, 0.0]], "no negative standard deviation"),
        ("corner_sigmas_enu_m", [], "at least one corner"),
        ("corner_sigmas_enu_m", "none", "expected list"),
        ("id", 3, "expected text"),
    ],
)
def test_a_wrong_field_is_refused_by_its_name(draft, tmp_path, field, value, said):
    content = json.loads(facades_bytes(draft.found, draft.photos))
    content["facades"][0]["panels"][2][field] = value
    path = tmp_path / "a.facades.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=said) as refused:
        read_facades(path)
    assert str(path) in str(refused.value)
    assert "panels[2]" in str(refused.value) or "panels[...]" in str(refused.value)


def test_another_file_is_told_apart(tmp_path):
    path = tmp_path / "a.json"
    path.write_text('{"format": "reflight-site/1"}')
    with pytest.raises(InputError, match="expected 'reflight-facades/1'"):
        read_facades(path)


def test_a_panel_with_corners_that_are_equally_good_is_as_good_as_one_of_them():
    one = PanelAccuracy("A", 1.0, ((0.003, 0.004, 0.0),) * 4)
    assert one.corner_sigma_m == pytest.approx(0.005)


@pytest.mark.parametrize("name", ["office.site.json", "office.json"])
def test_the_file_is_called_like_its_site(tmp_path, name):
    assert facades_path(tmp_path / name) == tmp_path / "office.facades.json"
