"""The brief on paper: pages of the right size with everything on them, translatable to the last word."""

import re
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from groundstation.services.map.shapes import plan_shapes, site_shapes
from groundstation.services.mission import brief_html as brief_html_module
from groundstation.services.mission.brief import flight_brief
from groundstation.services.mission.brief_html import brief_html, brief_pictures
from groundstation.services.mission.readiness import FlightDay
from groundstation.services.mission.sunlight import flight_report
from groundstation.services.units import UnitSystem
from missions.formats.encode import takeoff_check
from missions.mission.export_choices import LinkLoss
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.insight.flight_profile import LowFlight
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.plan import BatteryWorth, FlightWorth
from tests.missions.plans import HONG_KONG, example_plan
from tests.planning.plan_cases import kiosk
from tests.services.map_files import tiles_around, write_map

MODEL = kiosk(home_enu_m=(3.0, -40.0, 1.5))
UNITS = UnitSystem.METRIC


@pytest.fixture
def document(application):
    from groundstation.gui.mission.brief_printer import BriefDocument

    def made(findings=()):
        brief = flight_brief(MODEL, example_plan(), findings, "today")
        pictures = brief_pictures(MODEL, example_plan(), UNITS)
        return BriefDocument(brief_html(brief, UNITS, {name: name for name in pictures}), pictures)

    return made


@pytest.mark.few(1)
@pytest.mark.parametrize(("is_letter", "size_mm"), [(False, (210.0, 297.0)), (True, (215.9, 279.4))])
def test_pdf_has_pages_of_the_paper_that_was_asked_for(document, tmp_path, is_letter, size_mm):
    from groundstation.gui.mission.brief_printer import write_pdf

    path = tmp_path / "brief.pdf"
    n_pages = write_pdf(document(), path, is_letter)
    content = path.read_bytes()
    assert content.startswith(b"%PDF-")
    assert n_pages == (3 if is_letter else 2), "the map begins a page"
    box = re.search(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)", content)
    assert [float(v) / 72.0 * 25.4 for v in box.groups()] == pytest.approx(size_mm, abs=0.5)


def test_pages_hold_text_map_and_profiles(document):
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QImage, QPainter

    from groundstation.gui.mission.brief_printer import lay_out, paint_page

    image = QImage(700, 1000, QImage.Format.Format_RGB32)
    image.setDotsPerMeterX(3780)
    image.setDotsPerMeterY(3780)
    brief = document()
    painter = QPainter(image)
    n_pages = lay_out(brief, painter, 700.0, 1000.0)
    shares = []
    for page in range(n_pages):
        painter.fillRect(image.rect(), Qt.GlobalColor.white)
        paint_page(brief, painter, page)
        pixels = np.frombuffer(image.constBits(), np.uint8).reshape(1000, 700, 4)[..., :3]
        shares.append((pixels < 250).any(axis=2).mean())
        coloured = (np.ptp(pixels.astype(int), axis=2) > 60).mean()
        assert (coloured > 0.002) == (page == 1), "the map and the profiles stand on the second page"
    painter.end()
    assert len(shares) == 2
    assert all(share > 0.02 for share in shares)


@pytest.mark.slow
def test_long_lists_of_findings_go_on_over_the_page(document, tmp_path):
    from groundstation.gui.mission.brief_printer import write_pdf

    findings = [Finding(Severity.WARNING, "settle", f"finding {i}", "v0001", 1.0, 2.0, "s") for i in range(120)]
    assert write_pdf(document(findings), tmp_path / "brief.pdf", False) >= 4


def test_a_pdf_that_cannot_be_written_is_an_error(document, tmp_path):
    from groundstation.gui.mission.brief_printer import write_pdf

    with pytest.raises(InputError, match="cannot be written"):
        write_pdf(document(), tmp_path / "none" / "brief.pdf", False)


def test_every_word_of_the_page_is_there_for_the_translators(application):
    from groundstation.gui.mission.brief_printer import WORDS

    said = set()

    def translate(text):
        said.add(text)
        return text

    plan = example_plan()
    errors = (
        Finding(Severity.ERROR, "x", "error"),
        Finding(Severity.WARNING, "x", "w"),
        Finding(Severity.NOTE, "x", "n"),
    )
    full = flight_brief(MODEL, plan, errors, "today", day=FlightDay(datetime(2027, 6, 21, 10, 30, tzinfo=UTC), -5.0))
    empty = flight_brief(kiosk(obstacles=()), replace(plan, sorties=(), viewpoints=()), (), "today")
    bare = replace(full, findings=(), link_loss=LinkLoss.GO_HOME)
    warned = replace(full, findings=errors[1:])
    low = replace(takeoff_check(plan, MODEL.site, 1), is_upper_edge=False, above_edge_m=-2.0)
    high = replace(low, is_upper_edge=True, above_edge_m=2.0)
    sorties = tuple(replace(full.sorties[0], takeoff_check=check) for check in (low, high))
    sun = flight_report(MODEL, plan, datetime(2027, 6, 21, 10, 30, tzinfo=UTC))
    pictures = brief_pictures(MODEL, plan, UNITS, translate, sun)
    sunny = flight_brief(MODEL, plan, errors, "today", sun=sun)
    near = replace(full, low=LowFlight(6.0, 12.0, 100.0))
    sharp = replace(full, sharp_share=0.8, wanted_gsd_mm=5.0, coarsest_gsd_mm=9.0)
    worth = replace(full, worth=FlightWorth((BatteryWorth(1, 11.0, 40, 31.0),), None, 0.7))
    stated = [GroundRiskRequest(population=each) for each in (None, "controlled", "city", "assembly")]
    known = replace(plan, profile="m3e")
    risky = [flight_brief(MODEL, known, (), "today", ground_risk=each) for each in stated]
    for brief in (full, empty, bare, warned, near, sharp, worth, sunny, *risky, replace(full, sorties=sorties)):
        brief_html(brief, UNITS, dict.fromkeys(pictures, "x"), translate)
    assert said <= set(WORDS)
    assert set(WORDS) - said == {"Page {0} of {1}"}
    assert brief_html_module.MAP in pictures


def test_map_with_tiles_shows_them_under_the_site(application, tmp_path):
    from groundstation.gui.mission.brief_printer import painted_map

    tiles = write_map(tmp_path / "m.mbtiles", tiles_around(22.3372, 114.2636, range(14, 19), reach=3))
    shapes = site_shapes(MODEL), plan_shapes(example_plan(), HONG_KONG)
    picture = painted_map(*shapes, tiles, UNITS)
    corner = picture.pixelColor(picture.width() // 2, 5)
    assert corner.name() != "#ffffff"
    with pytest.raises(InputError, match="no such file"):
        painted_map(*shapes, tmp_path / "none.mbtiles", UNITS)
