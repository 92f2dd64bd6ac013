"""A model as a web page: a folder with one `index.html` that any browser shows without network or other files.

All is in that one file, because a page that is opened from a disk may not read others, and tablets hand a browser just
the file that was touched. Gaussians follow the page in chunks, the most visible ones first: the first picture is there
before all is read. What users wrote is data: JSON whose characters cannot end a script, shown as text only; the page's
policy forbids all network, all other scripts, and markup made of text.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder, open_given
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.ellipsoids import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.gaussian_blocks import raster_of
from reconstruction.exports.web.gaussians import COLOUR_RANGE, MAX_GAUSSIANS, MAX_PANES, N_AT_ONCE, packed
from reconstruction.exports.web.model import described_panes, first_view, panes_of
from reconstruction.exports.web.pictures import files_of
from reconstruction.exports.web.records import Row, by_object, columns_of
from reconstruction.exports.web.sky import Halves, plain_sky_light
from reconstruction.exports.whole_files import whole_file
from reconstruction.objects.gs_scene import GsElement, GsScene

FORMAT = "reflight-web/1"
PAGE = "index.html"
SIGN = f'<meta name="generator" content="{FORMAT}">'
"""Of our pages, in their first bytes: no other page is written over."""

SOURCES = Path(__file__).parent / "data"
SCRIPTS = ("words", "geometry", "order", "shaders", "picture", "colours", "records", "motion", "loading", "page")
LAST = "scripting"

PAGE_FILE = FileLimit(say("a web page"), 4096 * MIB)

MAX_TEXT_BYTES = 64 * 2**20
"""Of records and panes."""


@dataclass(frozen=True, slots=True)
class WebOptions:
    """What a page is to have.

    Parameters
    ----------
    title
        "": the scene's name.
    degree
        Up to which harmonics colours depend on where one looks from, 0 to 3: 9, 24 and 45 bytes more per Gaussian.
    most
        Keep so many of the most visible Gaussians; None: all.
    is_baked
        Whether what panes mirror is in their colours: the page says so in its footnote.
    sky
        What lies behind everything, see `web_sky`; None: a plain one.
    content_of
        Content of a picture or document that a record names, or None where there is none.
    """

    title: str = ""
    degree: int = 2
    most: int | None = None
    is_baked: bool = True
    sky: Halves | None = None
    content_of: Callable[[str], bytes | None] = field(default=lambda name: None)

    def __post_init__(self) -> None:
        if self.degree not in (0, 1, 2, 3):
            raise ValueError(f"degree: expected 0 to 3, got {self.degree}")
        if self.most is not None and self.most < 1:
            raise ValueError(f"most: expected 1 or more, got {self.most}")
        if self.sky is not None and (self.sky.dtype != np.float16 or self.sky.shape[1:] != (2 * len(self.sky), 3)):
            raise ValueError(f"sky: expected float16 of shape (h, 2 h, 3), got {self.sky.dtype} {self.sky.shape}")


@dataclass(frozen=True, slots=True)
class WebPage:
    """What was written.

    Parameters
    ----------
    n_strays
        Records whose object is not in the scene; they are not in the page.
    n_missing, n_damaged, n_large
        Files that records name and that are not in the page, but named there: those that are not beside the records,
        pictures that cannot be read, and documents for which there is no room.
    """

    path: Path
    n_bytes: int
    n_gaussians: int
    n_panes: int
    n_pictures: int
    n_documents: int
    n_strays: int
    n_missing: int
    n_damaged: int
    n_large: int


def write_web(
    scene: GsScene,
    folder: Path,
    records: Sequence[Row] = (),
    options: WebOptions | None = None,
    monitor: Monitor = QUIET,
) -> WebPage:
    """Write the page of a scene, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    folder
        Made where it is missing; one that has a page of ours gets the new one.
    records
        Of elements, components and the scene; see `web_records`.

    Raises
    ------
    InputError
        The folder has other files and no page of ours, or cannot be written; the scene has more Gaussians or panes than
        a page bears, or numbers that are not finite; a record cannot be shown, or pictures are too large together.
    OperationCancelled
        The user cancelled; nothing was written.
    """
    options, raster = options or WebOptions(), raster_of(scene)
    _check_folder(folder)
    elements = tuple(element for _, element in scene.elements)
    parts_of_scene = {part.global_id for part in scene.components} | {element.global_id for element in elements}
    found, n_strays = by_object(records, frozenset({scene.global_id, *parts_of_scene}))
    files = files_of(found, options.content_of, monitor)
    gaussians = _gaussians(scene, elements, options, folder)
    chunks = packed(gaussians, panes_of(gaussians, elements), options.degree, options.most)
    sky = plain_sky_light() if options.sky is None else options.sky
    described = {
        "title": options.title or scene.name,
        "scene": scene.global_id,
        "is_baked": options.is_baked,
        "is_antialiased": raster.antialiased,
        "blur_px2": raster.blur_px**2,
        "n": len(chunks),
        "at_once": N_AT_ONCE,
        "degree": options.degree,
        "rest_steps": [float(step) for step in chunks.rest_steps],
        "colour_range": COLOUR_RANGE,
        "sky": {"rows": len(sky), "halves": base64.b64encode(sky.astype("<f2").tobytes()).decode()},
        "view": first_view(scene, elements, gaussians),
        **described_panes(scene, elements),
        "columns": [asdict(column) for column in columns_of(elements, found)],
        "records": found,
        "files": files.told(),
    }
    head = _head(described, options.title or scene.name)

    def parts() -> Iterator[bytes]:
        yield head
        for number, chunk in enumerate(chunks.chunks()):
            monitor.report(say("writing the page"), number * N_AT_ONCE, len(chunks))
            yield _block("g", number, chunk)
        for kind, contents in (("p", files.pictures), ("d", files.documents)):
            for number, content in enumerate(contents.values()):
                yield _block(kind, number, content)
        yield b"</body></html>\n"

    n_bytes = _write(folder, parts())
    states = list(files.states.values())
    lost = [states.count(state) for state in ("missing", "damaged", "large")]
    counts = len(chunks), len(elements), len(files.pictures), len(files.documents), n_strays
    return WebPage(folder / PAGE, n_bytes, *counts, *lost)


def _check_folder(folder: Path) -> None:
    """Refuse what is not ours to write into."""
    try:
        if not folder.exists():
            return
        if not folder.is_dir():
            raise InputError(say("cannot be written: this is a file; name a folder", place=folder))
        page = folder / PAGE
        if page.is_file():
            with open_given(page, PAGE_FILE) as stream:
                if SIGN.encode() in stream.read(1000):
                    return
            raise InputError(say("is a page of somebody else's; name another folder", place=page))
        if any(folder.iterdir()):
            raise InputError(
                say("has other files and no page of ours; name an empty folder, or a new one", place=folder)
            )
    except OSError as error:
        raise InputError(
            say("cannot be read ({}); name another folder", error.strerror or error, place=folder)
        ) from error


def _gaussians(scene: GsScene, elements: Sequence[GsElement], options: WebOptions, folder: Path) -> Ellipsoids:
    if not scene.components:
        raise InputError(say("not written: the scene has no components; export at least one facade", place=folder))
    if len(elements) > MAX_PANES:
        raise InputError(
            say("not written: {} panels, a page bears {}; export one facade", len(elements), MAX_PANES, place=folder)
        )
    gaussians = ellipsoids_of_all(scene.components)
    for name in ("means_m", "quats", "scales_m", "opacities", "sh"):
        if not np.isfinite(getattr(gaussians, name)).all():
            raise InputError(
                say("not written: {} of the scene's Gaussians holds numbers that are not finite", name, place=folder)
            )
    n_kept = min(len(gaussians), options.most or len(gaussians))
    if n_kept > MAX_GAUSSIANS:
        raise InputError(
            say(
                "not written: {} Gaussians, a page bears {}; keep the most visible ones alone (most), or export "
                "one facade",
                n_kept,
                MAX_GAUSSIANS,
                place=folder,
            )
        )
    return gaussians


def _head(described: Mapping[str, Any], title: str) -> bytes:
    """The page up to where the Gaussians begin."""
    style = _source("page.css")
    script = '"use strict";\n(() => {\n' + "\n".join(_source(f"{name}.js") for name in (*SCRIPTS, LAST)) + "})();\n"
    text = json.dumps(described, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    if len(text) > MAX_TEXT_BYTES:
        raise InputError(
            say("records and panels: more than {} MiB of text; export one facade", MAX_TEXT_BYTES // 2**20)
        )
    parts = {
        "SIGN": SIGN,
        "SCRIPT_HASH": _hash(script),
        "STYLE_HASH": _hash(style),
        "TITLE": html.escape(title.encode("utf-8", "replace").decode()),
        "STYLE": style,
        "SCRIPT": script,
        "MODEL": text,
    }
    pieces = _source("page.html").split("@@")
    if sorted(pieces[1::2]) != sorted(parts):
        raise ValueError(f"page.html: expected {sorted(parts)}, got {sorted(pieces[1::2])}")
    return "".join(parts[piece] if place % 2 else piece for place, piece in enumerate(pieces)).encode()


def _source(name: str) -> str:
    return (SOURCES / name).read_text("utf-8")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _block(kind: str, number: int, content: bytes) -> bytes:
    """Bytes that the page's script finds; of this type browsers run none."""
    return b'<script type="text/plain" id="%b%d">%b</script>\n' % (kind.encode(), number, base64.b64encode(content))


def _write(folder: Path, parts: Iterator[bytes]) -> int:
    """Write the page, whole or not at all; a folder that was made for it goes if that fails."""
    is_new = not folder.exists()
    make_folder(folder)
    path, n_bytes = folder / PAGE, 0
    try:
        with whole_file(path) as temporary, temporary.open("wb") as stream:
            for part in parts:
                n_bytes += stream.write(part)
    finally:
        if is_new and not path.exists():
            folder.rmdir()
    return n_bytes
