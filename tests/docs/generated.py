"""The pages that are made from the code, and the texts of declared parameters that Qt Linguist looks for."""

from __future__ import annotations

from pathlib import Path

from groundstation.services.model.export import EXPORTERS
from tests.docs import api_names, commands, parameter_texts, settings
from tests.docs.drawings import drawings


def generated_pages(docs: Path) -> dict[Path, str]:
    """Text of each generated page by its path; benchmarks and tables have generators and CSV files of their own."""
    return {
        docs / "reference" / "api-names.md": api_names.page(),
        docs / "reference" / "commands.md": commands.page(),
        docs / "reference" / "exports.md": with_formats((docs / "reference" / "exports.md").read_text("utf-8")),
        docs / "reference" / "settings.md": settings.page(),
        docs.parent / "groundstation/gui/application/parameter_texts.py": parameter_texts.module(),
        **{docs / "drawings" / name: text for name, text in drawings(docs.parent / "pyproject.toml").items()},
    }


FORMATS_HEAD = "| `--format` | file | splats | panels to pick | attributes |\n" + 5 * "|---" + "|\n"


def with_formats(page: str) -> str:
    """The page on models for other programs, its table made from the formats that there are."""
    rows = [
        f"| `{name}` | {', '.join(f'`{each}`' for each in of.endings) or 'folder'} | {of.splats} "
        f"| {of.panels} | {of.attributes} |\n"
        for name, of in EXPORTERS.items()
    ]
    before, _, after = page.partition("| `--format` |")
    return before + FORMATS_HEAD + "".join(rows) + "\n" + after.partition("\n\n")[2]
