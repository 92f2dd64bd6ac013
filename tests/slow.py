"""Parameters of a test that only `make test-all` tries."""

from typing import Any

import pytest


def slow(*values: Any) -> Any:
    """One more case, of which `make test` has enough others."""
    return pytest.param(*values, marks=pytest.mark.slow)
