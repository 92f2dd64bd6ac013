"""A pixel by a variant of Mitsuba, in a process of its own: `python -m reconstruction.scenes.mitsuba.trial VARIANT`.

Where LLVM's library lacks an instruction that the processor has, it ends the process that asked for it, which no
`except` can help.
"""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

import numpy as np

LONGEST_S = 120.0
"""Loading Mitsuba and compiling takes seconds, on a busy machine more."""


def survives(variant: str) -> bool:
    """Whether a pixel is rendered and the process lives on."""
    known = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-P", "-m", __name__, variant]
    try:
        done = subprocess.run(command, env=known, capture_output=True, timeout=LONGEST_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def render_pixel(mi: Any) -> None:
    """Render a pixel of a plain sky with the variant that is set.

    Raises
    ------
    RuntimeError
        It is not finite, or the variant does not work.
    """
    film = {"type": "hdrfilm", "width": 1, "height": 1}
    scene = {"type": "scene", "sky": {"type": "constant"}, "sensor": {"type": "perspective", "film": film}}
    picture = mi.render(mi.load_dict({**scene, "integrator": {"type": "direct"}}), spp=1)
    if not np.isfinite(np.asarray(picture)).all():
        raise RuntimeError("a pixel of the sky is not finite")


if __name__ == "__main__":
    import mitsuba

    mitsuba.set_variant(sys.argv[1])
    render_pixel(mitsuba)
