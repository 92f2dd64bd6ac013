"""The manual: every page of the contents is there, every link leads somewhere, long pages come in parts."""

import re

import pytest

from groundstation.services.glossary import TERMS, terms_by_word
from groundstation.services.manual import (
    CHECKOUT,
    CONTENTS,
    FIRST,
    LONG_PAGE,
    anchor,
    chapters,
    found_in,
    manual_folder,
    page_part,
    title_of,
)
from planning.base.parameters import declared
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.parameters import CameraSettings

LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)")


def pages():
    return [name for chapter in chapters(CHECKOUT) for name, _ in chapter.pages]


def test_the_contents_are_those_of_the_docs_in_their_order():
    assert manual_folder() == CHECKOUT
    titles = [chapter.title for chapter in chapters(CHECKOUT)]
    assert titles[:2] == ["Begin", "Guide by tab"]
    assert FIRST in pages()
    assert len(set(pages())) == len(pages())
    on_disk = {path.relative_to(CHECKOUT).as_posix() for path in CHECKOUT.rglob("*.md") if "_build" not in path.parts}
    assert set(pages()) == on_disk - {CONTENTS}
    assert title_of(CHECKOUT / "guide" / "plan.md") == "The Plan tab"


@pytest.mark.lint
@pytest.mark.parametrize("name", pages())
def test_every_link_of_a_page_leads_to_a_page_or_a_heading(name):
    page = CHECKOUT / name
    for link in LINK.findall(re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.S | re.M)):
        if link.startswith(("http://", "https://")):
            continue
        path, _, heading = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{name}: {link}"
        if heading and target.suffix == ".md":
            assert f"{heading}\n" in [f"{anchor(line)}\n" for line in headings(target)], f"{name}: {link}"


def headings(page):
    return re.findall(r"^#{1,6}\s+(.*?)\s*$", page.read_text("utf-8"), re.M)


@pytest.mark.long
def test_a_long_page_comes_in_parts_that_together_are_the_page():
    page = CHECKOUT / "benchmarks.md"
    whole = page.read_text("utf-8")
    assert len(whole) > LONG_PAGE
    first, parts = page_part(page)
    assert len(parts) > 5
    pieces = [first, *(page_part(page, mark)[0] for mark, _ in parts)]
    assert "".join(pieces) == whole
    short, none = page_part(CHECKOUT / "guide" / "plan.md")
    assert none == ()
    assert short.startswith("# The Plan tab")


def test_what_only_the_site_of_the_docs_understands_is_left_out():
    assert "toctree" in (CHECKOUT / CONTENTS).read_text("utf-8")
    assert "toctree" not in page_part(CHECKOUT / CONTENTS)[0]


def test_a_search_finds_pages_with_all_words_those_with_them_in_the_title_first():
    found = list(found_in(CHECKOUT, "mission tab"))
    assert found[0] == ("guide/mission.md", "The Mission tab")
    assert list(found_in(CHECKOUT, "no-such-word-anywhere")) == []
    assert list(found_in(CHECKOUT, "  ")) == []


def test_a_search_of_the_manual_minds_neither_case_nor_accents_nor_sharp_s(tmp_path):
    (tmp_path / CONTENTS).write_text("```{toctree}\n:caption: Teil\nfenster\n```\n", encoding="utf-8")
    (tmp_path / "fenster.md").write_text("# Größe\nWeißes Glas in Zürich\n", encoding="utf-8")
    for words in ("WEISS zurich", "weiß Zürich", "grosse"):
        assert list(found_in(tmp_path, words)) == [("fenster.md", "Größe")]


def test_each_term_is_said_once_and_its_page_exists():
    words = [word.casefold() for term in TERMS for word in (term.name, *term.also)]
    assert len(set(words)) == len(words)
    assert terms_by_word(str)["target coverage"].name == "Coverage"
    for term in TERMS:
        assert (CHECKOUT / term.page.partition("#")[0]).is_file(), term.name
        assert len(term.says.split()) <= 35


def test_what_only_the_trade_calls_so_has_a_term_beside_its_field_and_leads_to_a_heading_that_is_there():
    words = terms_by_word(str)
    plain = {"Wind", "Take-off mass in kg", "Height by", "Arc tolerance"}
    plain |= {"People from a raster", "Raster counts people", "Ground from a raster"}
    asked = {each.parameter.label for kind in (GroundRiskRequest, CameraSettings) for each in declared(kind).values()}
    assert {label for label in asked - plain if label.casefold() not in words} == set()
    for term in TERMS:
        page, _, heading = term.page.partition("#")
        headings = re.findall(r"^#+ (.*)$", (CHECKOUT / page).read_text("utf-8"), re.MULTILINE)
        assert not heading or heading in map(anchor, headings), term.name
