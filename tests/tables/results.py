"""Results of trainings, a line each, kept as CSV beside the page: so a part can be run anew, or added later."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Result:
    """A model, scored on the glass of unseen views.

    Parameters
    ----------
    case
        A title that it had when it was made; several tables may have the same training.
    made_with
        Checksum of all settings, of photos and of training, which tells cases apart.
    psnr_db, worst_db
        Mean over the views, and the worst of them.
    lpips
        None where no weights were given.
    seconds
        Of processor time.
    views
        Share of a view's pixels that shows glass, and PSNR, of each: `0.312:27.41 0.094:25.80`.
    glass_db
        Mean over views of the PSNR of pixels that show one panel and nothing beside it; None where it was not asked
        for yet.
    """

    scene: str
    case: str
    seed: int
    scale: str
    made_with: str
    psnr_db: float
    worst_db: float
    ssim: float
    lpips: float | None
    seconds: float
    n_steps: int
    n_splats: int
    machine: str
    views: str = ""
    glass_db: float | None = None

    @property
    def key(self) -> tuple[str, str, int]:
        """Of which there is one line."""
        return self.scene, self.made_with, self.seed


def read_results(path: Path) -> list[Result]:
    """Of a file; none where there is none."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as lines:
        return [_of(row) for row in csv.DictReader(lines)]


def _of(row: dict[str, str]) -> Result:
    found: dict[str, object] = {**row}
    for name in ("seed", "n_steps", "n_splats"):
        found[name] = int(row[name])
    for name in ("psnr_db", "worst_db", "ssim", "seconds"):
        found[name] = float(row[name])
    for name in ("lpips", "glass_db"):
        found[name] = float(row[name]) if row.get(name) else None
    return Result(**found)  # type: ignore[arg-type]


def keep(path: Path, new: Iterable[Result]) -> None:
    """Write results in the place of those with the same keys, or behind all others."""
    known = {result.key: result for result in read_results(path)}
    known |= {result.key: result for result in new}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as lines:
        writer = csv.DictWriter(lines, [field.name for field in fields(Result)])
        writer.writeheader()
        for result in known.values():
            writer.writerow({name: "" if value is None else value for name, value in asdict(result).items()})


def of_case(results: Sequence[Result], scene: str, made_with: str) -> list[Result]:
    """All seeds of a case, made with the settings that it has now."""
    return [each for each in results if (each.scene, each.made_with) == (scene, made_with)]


def older_of_case(results: Sequence[Result], scene: str, scale: str, title: str) -> list[Result]:
    """All seeds of a case of that title, made with the settings that it had last."""
    named = [each for each in results if (each.scene, each.scale, each.case) == (scene, scale, title)]
    return of_case(named, scene, named[-1].made_with) if named else []
