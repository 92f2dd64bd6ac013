"""The manual: the docs' own pages, as they come with the program, to be read in the window without a network.

A wheel has them in the folder `manual` beside this package's other data; a checkout has them in `docs`.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from planning.base.files import ANY_FILE, read_input_file
from planning.base.searching import folded

PACKAGED = Path(__file__).parents[1] / "manual"
CHECKOUT = Path(__file__).parents[2] / "docs"

CONTENTS, FIRST = "index.md", "start.md"

LONG_PAGE = 24_000
"""Letters of a page from which on it is shown part by part."""

_TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```\n", re.S | re.M)
_PART = re.compile(r"^## ", re.M)
_HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*$", re.M)
_CODE = re.compile(r"^```.*?^```", re.S | re.M)


@dataclass(frozen=True, slots=True)
class Chapter:
    """Pages that stand together.

    Parameters
    ----------
    title
        As the contents name it.
    pages
        Names from the manual's folder, such as `guide/plan.md`, each with its title.
    """

    title: str
    pages: tuple[tuple[str, str], ...]


def manual_folder() -> Path:
    """Where the pages are."""
    return PACKAGED if (PACKAGED / CONTENTS).is_file() else CHECKOUT


def chapters(folder: Path) -> tuple[Chapter, ...]:
    """The contents, in the order in which they are to be read.

    Raises
    ------
    InputError
        The contents cannot be read.
    """
    found = []
    for block in _TOCTREE.findall(_text(folder / CONTENTS)):
        lines = [line.strip() for line in block.splitlines() if line.strip()]
        title = next((line.removeprefix(":caption:").strip() for line in lines if line.startswith(":caption:")), "")
        pages = tuple((path.relative_to(folder).as_posix(), title_of(path)) for path in _listed(folder, lines))
        found.append(Chapter(title, pages))
    return tuple(found)


def _listed(folder: Path, lines: list[str]) -> Iterator[Path]:
    """Pages that lines of contents name, each followed by those that it lists itself."""
    for line in lines:
        for path in [] if line.startswith(":") else sorted(folder.glob(f"{line}.md")):
            yield path
            for block in _TOCTREE.findall(_text(path)):
                yield from _listed(path.parent, [inner.strip() for inner in block.splitlines() if inner.strip()])


def title_of(page: Path) -> str:
    """First heading of a page, its name where there is none."""
    found = _HEADING.search(_text(page))
    return page.stem if found is None else plain(found.group(1))


def page_part(page: Path, heading: str = "") -> tuple[str, tuple[tuple[str, str], ...]]:
    """A page as Markdown, without what only the docs' own site understands; of a long one the part with a heading.

    Qt lays tables out as a whole: a page of hundreds of rows would stop the window for seconds.

    Returns
    -------
    text
        With the page's own beginning, up to its first part, where no heading is asked for.
    parts
        Anchor and title of each part of a long page; none of a short one.

    Raises
    ------
    InputError
        There is no such page.
    """
    text = _TOCTREE.sub("", _text(page))
    if len(text) <= LONG_PAGE:
        return text, ()
    starts = [*(found.start() for found in _PART.finditer(_blanked(text))), len(text)]
    pieces = [text[begin:end] for begin, end in itertools.pairwise(starts)]
    parts = tuple((anchor(_headings(piece)[0]), plain(_headings(piece)[0])) for piece in pieces)
    for piece in pieces:
        if heading in map(anchor, _headings(piece)):
            return piece, parts
    return text[: starts[0]], parts


def _headings(piece: str) -> list[str]:
    return _HEADING.findall(_blanked(piece))


def _blanked(text: str) -> str:
    """The same text with blanks for blocks of code, in which a line may look like a heading."""
    return _CODE.sub(lambda block: re.sub(r"[^\n]", " ", block[0]), text)


def plain(text: str) -> str:
    """A line of Markdown without its marks."""
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text).replace("`", "").replace("*", "")


def anchor(heading: str) -> str:
    """What links call a heading, as GitHub and the docs' site do."""
    return re.sub(r"[^\w\- ]", "", plain(heading).strip().casefold()).replace(" ", "-")


def found_in(folder: Path, words: str) -> Iterator[tuple[str, str]]:
    """Pages that hold all words, each with its title: those with most of them first."""
    wanted = folded(words).split()
    counted = []
    for name, title, text in _folded_pages(folder):
        counts = [text.count(word) for word in wanted]
        if wanted and all(counts):
            in_title = sum(word in folded(title) for word in wanted)
            counted.append((-in_title, -min(counts), name, title))
    yield from ((name, title) for *_, name, title in sorted(counted))


@lru_cache(maxsize=1)
def _folded_pages(folder: Path) -> tuple[tuple[str, str, str], ...]:
    """Name, title and folded text of each page, read once: words are looked for with each key."""
    pages = (page for chapter in chapters(folder) for page in chapter.pages)
    return tuple((name, title, folded(_text(folder / name))) for name, title in pages)


def _text(path: Path) -> str:
    return read_input_file(path, ANY_FILE).decode()
