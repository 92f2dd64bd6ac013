"""The pages of docs/ are true of the repository: generated ones are up to date, and what pages name exists."""

import re
from pathlib import Path

import pytest

from tests.docs.__main__ import remote_references
from tests.docs.generated import generated_pages

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
HOUSES = "groundstation|planning|missions|reconstruction|tests"


def names(page):
    """Everything in backticks, outside of blocks of code."""
    text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.S | re.M)
    return re.findall(r"`([^`\n]+)`", text)


def test_generated_pages_are_those_of_the_code():
    for path, text in generated_pages(ROOT / "docs").items():
        assert path.read_text("utf-8") == text, f"{path.name} is out of date: run `make docs`"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_files_and_modules_that_a_page_names_exist(page):
    for name in names(page):
        path = re.fullmatch(rf"(?:{HOUSES}|docs|\.ci)/[\w./*-]+", name)
        if path:
            assert list(ROOT.glob(name.rstrip("/"))), f"{page.name}: there is no {name}"
        dotted = re.match(rf"(?:python -m )?((?:{HOUSES})(?:\.\w+)+)(?:\(|$| )", name)
        if dotted:
            assert exists(dotted[1].split(".")), f"{page.name}: there is no {name}"


def exists(parts):
    """Whether dotted names are a module, or something that is written in one."""
    for length in range(len(parts), 1, -1):
        path = ROOT.joinpath(*parts[:length])
        source = path.with_suffix(".py") if path.with_suffix(".py").exists() else path / "__init__.py"
        if source.exists() or path.is_dir():
            text = source.read_text("utf-8") if source.exists() else ""
            return all(re.search(rf"\b{re.escape(part)}\b", text) for part in parts[length:])
    return False


def written():
    """Pages that people write, and the text of each."""
    texts = {page: page.read_text("utf-8") for page in PAGES[1:]}
    return {page: text for page, text in texts.items() if "do not edit by hand" not in text[:400].lower()}


def test_pages_are_short_enough_to_be_read():
    words = {page: len(text.split()) for page, text in written().items()}
    assert sum(words.values()) <= 40_000
    assert max(words.values()) <= 2500, max(words, key=words.get)
    for page, text in written().items():
        for block in re.split(r"\n\s*\n", text):
            if not block.lstrip().startswith(("|", "```", "- |")):
                assert len(block.split()) <= 120, (
                    f"{page.name}: a paragraph of {len(block.split())} words: {block[:60]}"
                )
    assert PAGES[0].read_text("utf-8").count("\n") <= 120


MEASURED = re.compile(r"(?<![\w.])\d[\d ]*\.?\d*\s(?:dB|ms|GiB|MiB|GB|MB|fps|M pairs/s)\b")


def test_prose_repeats_no_figure_of_a_generated_table():
    tables = " ".join(
        line.replace("|", " | ")
        for name in ("benchmarks.md", "tables.md")
        for line in (ROOT / "docs" / name).read_text("utf-8").splitlines()
        if line.startswith("|")
    )
    known = {" ".join(figure.split()) for figure in MEASURED.findall(tables)}
    for page, text in written().items():
        prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
        for line in prose.splitlines():
            for figure in [] if line.startswith("|") else MEASURED.findall(line):
                assert " ".join(figure.split()) not in known, f"{page.name} repeats {figure} of a table: {line[:80]}"


def test_every_page_is_linked_from_the_contents():
    listed = set()
    for page, text in written().items():
        for block in re.findall(r"```\{toctree\}\n(.*?)```", text, re.S):
            for line in block.splitlines():
                if line and not line.startswith(":"):
                    listed |= {path.with_suffix("") for path in page.parent.glob(f"{line}.md")}
    pages = {page.with_suffix("") for page in PAGES[1:]}
    assert pages - listed == {ROOT / "docs" / "index"}


def test_a_name_that_is_nowhere_is_found_out():
    assert exists(["planning", "plan", "Constraints"])
    assert exists(["planning", "geo"])
    assert not exists(["planning", "plan", "NoSuchRecord"])
    assert not exists(["planning", "no_such_room", "file"])


def test_what_a_browser_would_fetch_from_elsewhere_is_found_out(tmp_path):
    asks = {
        "script.html": '<script src="https://cdn.example/x.js"></script>',
        "style.html": '<link rel="stylesheet" href="//fonts.example/css">',
        "picture.html": '<img alt="" src="http://example/x.png">',
        "font.css": "@font-face { src: url(https://fonts.example/x.woff2) }",
    }
    clean = {
        "link.html": '<a href="https://example.org">more</a><link rel="canonical" href="https://example.org/x">',
        "own.html": '<script src="_static/x.js"></script><img src="_images/a.png">',
        "data.css": "a { background: url(data:image/svg+xml;charset=utf-8,abc) }",
    }
    for name, text in {**asks, **clean}.items():
        (tmp_path / name).write_text(text, "utf-8")
    found = remote_references(sorted(tmp_path.iterdir()))
    assert len(found) == len(asks)
    assert all(any(name in line for name in asks) for line in found)
