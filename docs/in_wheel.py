"""What pyproject.toml cannot say: a wheel has the pages of the docs, as the manual that the window shows."""

import shutil
from pathlib import Path

from setuptools.command.build_py import build_py

DOCS = Path(__file__).parent

READ_IN_WINDOW = ("*.md", "*.png", "*.jpg", "*.svg")


class BuildWithManual(build_py):
    """Puts the pages into the package `groundstation`, as its folder `manual`; a checkout reads them where they are."""

    def run(self) -> None:
        """Build the packages, then add the pages."""
        super().run()
        if self.editable_mode:
            return
        manual = Path(self.build_lib) / "groundstation" / "manual"
        for pattern in READ_IN_WINDOW:
            for path in DOCS.rglob(pattern):
                place = path.relative_to(DOCS)
                if not place.parts[0].startswith("_"):
                    (manual / place).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(path, manual / place)
