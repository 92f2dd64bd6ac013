"""Programs of others that run in Node and in browsers: for tests, installed by `make foreign`, missed by nobody."""

from __future__ import annotations

import base64
import functools
import http.server
import json
import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

HERE = Path(__file__).parent


def run_node(script: str, *arguments: object) -> Any:
    """What a script of this folder prints, which is JSON; the test is skipped where its programs are missing."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("Node is not installed")
    if not (HERE / "node_modules").is_dir():
        pytest.skip("readers of others are not installed: make foreign")
    command = [node, str(HERE / script), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=500, env={**os.environ, "NO_COLOR": "1"})
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.strip().splitlines()[-1])


class _Handler(http.server.SimpleHTTPRequestHandler):
    """Pages of this folder, the programs that are installed here as /modules/, and a test's own files as /files/."""

    def __init__(self, *arguments: Any, files: Path, **more: Any) -> None:
        self._files = files
        super().__init__(*arguments, **more)

    def translate_path(self, path: str) -> str:
        path = path.split("?", maxsplit=1)[0]
        for start, folder in (("/modules/", HERE / "node_modules"), ("/files/", self._files)):
            if path.startswith(start):
                return str(folder / path.removeprefix(start))
        return str(HERE / path.strip("/"))

    def guess_type(self, path: Any) -> str:
        return "text/javascript" if str(path).endswith(".mjs") else super().guess_type(path)

    def log_message(self, *arguments: Any) -> None:
        """Say nothing."""


@contextmanager
def served(files: Path) -> Iterator[str]:
    """Address of a web server of this folder, its programs and a folder of files."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Handler, files=files))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


def picture_of(text: str) -> NDArray[np.float64]:
    """What the pages' `look` returns, shape (h, w, 3), 0 to 1."""
    width, height, rows = text.split()
    found = np.frombuffer(base64.b64decode(rows), np.uint8).reshape(int(height), int(width), 4)
    return found[::-1, :, :3] / 255.0
