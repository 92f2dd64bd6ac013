"""The two verifiers as functions from files to verdicts, so that thousands of tampered sets can be gone through.

The Python file is loaded as a module, or run as the program that it is. The script is taken out of the page and run by
Qt's engine, or by Node where that is installed.
"""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import planning
from tests.gui.screen import the_application

FOLDER = Path(planning.__file__).parent / "proof"
PYTHON, PAGE = FOLDER / "reflight_verify.py", FOLDER / "reflight_verify.html"

SITE, PLAN, PROOF = "site.json", "plan.json", "plan.proof"
MISSION_ENDINGS = (".kmz", ".plan", ".waypoints", ".txt", ".kml")


class Claim(NamedTuple):
    """One claim as a verifier has it."""

    id: str
    verdict: str
    text: str


def mission_names(files: Mapping[str, bytes]) -> list[str]:
    """Names of mission files, in order."""
    return sorted(name for name in files if name.endswith(MISSION_ENDINGS))


def mesh_names(files: Mapping[str, bytes]) -> list[str]:
    """Names of what is neither site, plan, proof nor mission."""
    return [name for name in files if name not in (SITE, PLAN, PROOF) and name not in mission_names(files)]


def write(files: Mapping[str, bytes], folder: Path) -> None:
    """The files alone in a folder."""
    for old in folder.iterdir():
        old.unlink()
    for name, content in files.items():
        (folder / name).write_bytes(content)


def load(source: str | None = None) -> ModuleType:
    """The verifier as a module, or a changed source of it."""
    spec = importlib.util.spec_from_loader("reflight_verify", loader=None)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    # Annotations of dataclasses and the like look their module up.
    sys.modules[spec.name] = module
    exec(compile(source or PYTHON.read_text(), str(PYTHON), "exec"), module.__dict__)
    return module


def by_module(module: ModuleType, files: Mapping[str, bytes], folder: Path) -> list[Claim]:
    """Claims as the loaded verifier has them."""
    write(files, folder)
    paths = [folder / name for name in (SITE, PLAN, PROOF)]
    found = module.verify(*paths, [folder / name for name in mission_names(files)])
    return [Claim(each["id"], each["verdict"], each["text"]) for each in found]


def by_program(files: Mapping[str, bytes], folder: Path) -> tuple[int, list[Claim], str]:
    """Exit status, claims and error output of the program, run as a safety officer runs it: nothing of ours around."""
    write(files, folder)
    names = [SITE, PLAN, PROOF, *mission_names(files)]
    command = [sys.executable, "-I", "-S", str(PYTHON), *names, "--json"]
    run = subprocess.run(command, cwd=folder, capture_output=True, check=False, timeout=120)
    claims = json.loads(run.stdout)["claims"] if run.stdout else []
    return run.returncode, [Claim(each["id"], each["verdict"], each["text"]) for each in claims], run.stderr.decode()


def script() -> str:
    """The page's verifier, without the page."""
    found = re.search(r'<script id="verifier">\n(.*?)</script>', PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found is not None
    return found[1]


class QtScript:
    """The script in Qt's engine: ECMAScript 2016 without BigInt, DecompressionStream or TextDecoder."""

    def __init__(self) -> None:
        from PySide6.QtQml import QJSEngine

        # Not a lesser one of its own: tests of windows in this process could have no other then.
        the_application()
        self._engine = QJSEngine()
        result = self._engine.evaluate(script(), "reflight_verify.html")
        assert not result.isError(), result.toString()

    def __call__(self, files: Mapping[str, bytes]) -> list[Claim]:
        """Claims as the script has them; an error that it lets out is an AssertionError."""
        n_meshes = len(mesh_names(files))
        names = [SITE, PLAN, PROOF, *mesh_names(files), *mission_names(files)]
        call = (
            f"(function (all) {{ const c = all.map((each) => each[1]); return ReflightVerify.verify("
            f"c[0], c[1], c[2], all.slice(3, {3 + n_meshes}), all.slice({3 + n_meshes})); }})(all)"
        )
        return _claims(json.loads(self._evaluated(call, {name: files[name] for name in names})))

    def folder(self, files: Mapping[str, bytes]) -> Any:
        """What the page shows of files that are dropped onto it."""
        return json.loads(self._evaluated("ReflightVerify.verifyFolder(all)", files))

    def call(self, expression: str, content: bytes) -> str | None:
        """JSON of one expression of the script's parts about `bytes`; None where they are refused."""
        parts = (
            "const { inflate, sha256, crc32, readJson, readPly, short, enu, sincos, distance, restToRest, Terrain } = "
            "ReflightVerify.parts; const bytes = all[0][1];"
            "const plain = (v) => v instanceof Map ? Array.from(v).reduce((o, [k, x]) => "
            "Object.defineProperty(o, k, { value: plain(x), enumerable: true }), {}) "
            ": v instanceof Array ? v.map(plain) : v;"
        )
        found = (
            f"(function () {{ {parts} let found; try {{ found = {expression}; }} catch (error) {{ "
            "if (error.verdict === undefined) throw error; return null; } "
            "return found instanceof Uint8Array ? Array.prototype.slice.call(found) "
            ": found === null ? 'null' : found; })()"
        )
        result = self._evaluated(found, {"bytes": content})
        return None if result == "null" else result

    def _evaluated(self, expression: str, files: Mapping[str, bytes]) -> str:
        """JSON of an expression about `all`, a list of names and contents."""
        from PySide6.QtCore import QByteArray

        target = self._engine.globalObject()
        for k, content in enumerate(files.values()):
            target.setProperty(f"content{k}", self._engine.toScriptValue(QByteArray(content)))
        listed = ", ".join(f"[{json.dumps(name)}, new Uint8Array(content{k})]" for k, name in enumerate(files))
        result = self._engine.evaluate(f"(function (all) {{ return JSON.stringify({expression}); }})([{listed}])")
        assert not result.isError(), f"{result.toString()}, line {result.property('lineNumber').toInt()}"
        for k in range(len(files)):
            target.deleteProperty(f"content{k}")
        return str(result.toString())


def _claims(found: Sequence[Mapping[str, Any]]) -> list[Claim]:
    return [Claim(each["id"], each["verdict"], each["text"]) for each in found]


NODE = shutil.which("node")

_FOR_NODE = """
const fs = require("fs");
const path = require("path");
for (const set of JSON.parse(fs.readFileSync(0, "utf8"))) {
  const read = (name) => new Uint8Array(Buffer.from(set.files[name], "base64"));
  const pairs = (names) => names.map((name) => [name, read(name)]);
  console.log(JSON.stringify(ReflightVerify.verify(
    read("site.json"), read("plan.json"), read("plan.proof"), pairs(set.meshes), pairs(set.missions))));
}
"""


def by_node(sets: Sequence[Mapping[str, bytes]], folder: Path) -> list[list[Claim]]:
    """Claims of many sets of files as the script has them in Node."""
    import base64

    assert NODE is not None
    program = folder / "verify.js"
    program.write_text(script() + _FOR_NODE, encoding="utf-8")
    asked = [
        {
            "files": {name: base64.b64encode(content).decode() for name, content in files.items()},
            "meshes": mesh_names(files),
            "missions": mission_names(files),
        }
        for files in sets
    ]
    run = subprocess.run(
        [NODE, str(program)], input=json.dumps(asked).encode(), capture_output=True, check=False, timeout=590
    )
    assert run.returncode == 0, run.stderr.decode()[-2000:]
    return [_claims(json.loads(line)) for line in run.stdout.decode().splitlines()]
