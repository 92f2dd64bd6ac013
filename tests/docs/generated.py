"""The pages that are made from the code, and the texts of declared parameters that Qt Linguist looks for."""

from __future__ import annotations

from pathlib import Path

from tests.docs import api_names, commands, parameter_texts, settings
from tests.docs.drawings import drawings


def generated_pages(docs: Path) -> dict[Path, str]:
    """Text of each generated page by its path; benchmarks and tables have generators and CSV files of their own."""
    return {
        docs / "reference" / "api-names.md": api_names.page(),
        docs / "reference" / "commands.md": commands.page(),
        docs / "reference" / "settings.md": settings.page(),
        docs.parent / "groundstation/gui/application/parameter_texts.py": parameter_texts.module(),
        **{docs / "drawings" / name: text for name, text in drawings(docs.parent / "pyproject.toml").items()},
    }
