"""Take samples of a photo stream in a process of its own: `python -m tests.benchmarks.stream_process FOLDER MIB N`.

Prints the largest memory above that before the first sample, photos read, and processor time, as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np
import torch

from reconstruction.light.photo_set import read_photo_set
from reconstruction.training.photos.photo_stream import PhotoStream, StreamSettings

STEP_S = 0.1
"""Between samples, as a training would take."""


def resident_mib(field: str) -> float:
    """`VmRSS` now, `VmHWM` at most since the start; what `getrusage` says counts the parent's memory, too."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(field)) / 1024.0


if __name__ == "__main__":
    folder, limit_mib, n_samples = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    source, generator = read_photo_set(folder), torch.Generator().manual_seed(0)
    settings = StreamSettings(memory_bytes=limit_mib << 20, window_px=1024 * 768, with_normals=True)
    with PhotoStream(source, None, np.zeros(3), settings) as stream:
        before_mib, started = resident_mib("VmRSS"), time.process_time()
        for _ in range(n_samples):
            stream.sample(generator)
            time.sleep(STEP_S)
        cpu_s, n_read = time.process_time() - started, stream.n_read
    peak_mib = resident_mib("VmHWM") - before_mib
    print(json.dumps({"peak_mib": peak_mib, "n_read": n_read, "cpu_s": cpu_s}))  # noqa: T201
