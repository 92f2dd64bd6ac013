"""What tests on a graphics card need: one, or the program that stands in for it."""

import pytest

from reconstruction.gpu.device import Device, open_device, why_no_gpu


@pytest.fixture(scope="session")
def card() -> Device:
    reason = why_no_gpu()
    if reason:
        pytest.skip(f"no graphics card: {reason}")
    return open_device()
