"""The pages that are made from the code and from measured tables."""

from __future__ import annotations

from pathlib import Path

from tests.docs import commands, settings


def generated_pages(docs: Path) -> dict[Path, str]:
    """Text of each generated page by its path; benchmarks and tables have generators and CSV files of their own."""
    return {
        docs / "reference" / "commands.md": commands.page(),
        docs / "reference" / "settings.md": settings.page(),
    }
