"""Write the generated pages of docs/ and build the site, strictly: `python -m tests.docs [--check]`."""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from tests.docs.generated import generated_pages

DOCS = Path("docs")
OUT = DOCS / "_build" / "html"

REMOTE = re.compile(
    r"""<(?:script|img|iframe|source)\b[^>]*\bsrc=["'](?:https?:)?//[^"']+|"""
    r"""<link\b(?![^>]*rel=["'](?:canonical|license)["'])[^>]*\bhref=["'](?:https?:)?//[^"']+|"""
    r"""@import\s+(?:url\()?["']?(?:https?:)?//[^"')]+|url\(\s*["']?(?:https?:)?//[^"')]+"""
)
"""What a browser would fetch from elsewhere by itself; links that a reader clicks are not among it."""


def main(arguments: Sequence[str]) -> int:
    """Build the site; returns 1 where a page is out of date (--check), has a warning or asks for the network."""
    parser = argparse.ArgumentParser(prog="python -m tests.docs", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write no page, and fail where one is out of date")
    check = parser.parse_args(arguments).check
    stale = []
    for path, text in generated_pages(DOCS).items():
        if path.read_text("utf-8") != text if path.exists() else True:
            stale.append(path.as_posix())
            if not check:
                path.write_text(text, "utf-8")
    if check and stale:
        print(f"out of date: {', '.join(stale)}; run `make docs`")  # noqa: T201
        return 1
    build = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q", "-j", "2", str(DOCS), str(OUT)]
    status = subprocess.run(build, check=False).returncode
    fetched = remote_references(OUT.rglob("*"))
    for line in fetched:
        print(line)  # noqa: T201
    if status or fetched:
        return 1
    print(f"{OUT / 'index.html'}")  # noqa: T201
    return 0


def remote_references(paths: Iterable[Path]) -> list[str]:
    """Files of the site that would fetch something over the network, each with what it would fetch."""
    return [
        f"{path}: asks the network for {found[0][:120]}"
        for path in paths
        if path.suffix in (".html", ".css")
        for found in REMOTE.finditer(path.read_text("utf-8"))
    ]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
