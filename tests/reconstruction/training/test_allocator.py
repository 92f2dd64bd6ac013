import ctypes
import subprocess
import sys

import pytest

from reconstruction.training.train import freed_memory_retained

HAS_GNU_LIBRARY = sys.platform == "linux" and hasattr(ctypes.CDLL(None), "gnu_get_libc_version")

COUNTED = """
import resource
import numpy as np
from reconstruction.training.train import freed_memory_retained

def new_pages():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(10):
        pieces = [np.ones(1_000_000, np.float32) for _ in range(30)]
        del pieces
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

def used_kb():
    return int(next(line for line in open('/proc/self/status') if line.startswith('VmRSS')).split()[1])

print(new_pages())
with freed_memory_retained():
    new_pages()
    print(new_pages())
    within_kb = used_kb()
print(within_kb - used_kb())
"""


@pytest.mark.slow
@pytest.mark.skipif(not HAS_GNU_LIBRARY, reason="another C library than GNU's, which is left alone")
def test_steps_get_no_new_pages_within_and_memory_goes_back_at_the_end():
    # In a process of its own: what a process has freed before changes what it gets.
    found = subprocess.run([sys.executable, "-c", COUNTED], capture_output=True, text=True, check=True)
    without, within, given_back_kb = map(int, found.stdout.split())
    assert within < 0.1 * without
    assert given_back_kb > 50_000


def test_what_goes_wrong_within_comes_out():
    with pytest.raises(ValueError, match="wrong"), freed_memory_retained():
        raise ValueError("wrong")


def test_elsewhere_nothing_is_done(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    with freed_memory_retained():
        assert sum([1, 2]) == 3
