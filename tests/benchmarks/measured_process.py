"""Run one command and measure it: `python -m tests.benchmarks.measured_process FILE COMMAND ...`.

Writes wall time, time of processors, largest resident memory of any of its processes, and exit status to FILE as JSON.
A process of its own, because Linux counts the memory of whoever started a command as the command's: this one is small.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

if __name__ == "__main__":
    started = time.perf_counter()
    process = subprocess.Popen(sys.argv[2:])
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.perf_counter() - started
    measured = {
        "seconds": seconds,
        "processor_s": usage.ru_utime + usage.ru_stime,
        "peak_mib": usage.ru_maxrss / 1024.0,
        "status": process.returncode,
    }
    Path(sys.argv[1]).write_text(json.dumps(measured), "utf-8")
