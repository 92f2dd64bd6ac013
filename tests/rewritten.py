"""Compile all tests once, with their asserts rewritten: `python -m tests.rewritten` (part of `make test`).

Every test process reads all tests, and in a fresh clone each would compile all of them: as much work as importing all
that they test. pytest looks at each file again, and compiles what has changed since; without these files it is only
slower.
"""

from __future__ import annotations

from pathlib import Path

# pytest has no public way to compile tests without running or importing them. Of its internals this takes the steps of
# its import hook (`_read_pyc`, `_rewrite_test`, `_write_pyc`), so that it finds the files. Its version is pinned, and a
# test of the house tells when another one no longer finds them.
from _pytest.assertion import AssertionState, rewrite
from _pytest.config import get_config

TESTS = Path(__file__).parent


def rewrite_all() -> int:
    """Keep each file of tests as pytest would, where it is not kept yet; returns the number of new ones."""
    config, n_new = get_config(), 0
    state = AssertionState(config, "rewrite")
    for path in sorted((*TESTS.rglob("test_*.py"), *TESTS.rglob("conftest.py"))):
        cache = rewrite.get_cache_dir(path)
        pyc = cache / (path.name[:-3] + rewrite.PYC_TAIL)
        if rewrite._read_pyc(path, pyc) is None and rewrite.try_makedirs(cache):
            source_hash, code = rewrite._rewrite_test(path, config)
            rewrite._write_pyc(state, code, source_hash, pyc)
            n_new += 1
    return n_new


if __name__ == "__main__":
    rewrite_all()
