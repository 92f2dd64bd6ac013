"""What this computer has, and what follows for a training, in words."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.services.reconstruct.choices import PROGRAM_BYTES, Forecast, Machine, TrainChoice
from groundstation.services.reconstruct.folders import LEAST_FREE_BYTES, DataSetCard, Standing

Told = tuple[str, str]
"""Role of a label ("", warning, error), and text."""


class MachineWords(QObject):
    """Says it."""

    def told(
        self,
        machine: Machine,
        cuda: tuple[str, ...] | None,
        choice: TrainChoice,
        card: DataSetCard | None,
        forecast: Forecast | None,
        standing: Standing,
    ) -> list[Told]:
        """Lines, what is most in the way first."""
        lines = [*self._lacking(machine, forecast, standing), *self._computer(machine, cuda, choice)]
        if card is not None and forecast is not None:
            lines += self._photos(card, forecast)
        return lines

    def _lacking(self, machine: Machine, forecast: Forecast | None, standing: Standing) -> list[Told]:
        lines: list[Told] = []
        if forecast is not None and machine.free_bytes is not None and forecast.needed_bytes > machine.free_bytes:
            lines.append(
                (
                    "error",
                    self.tr(
                        "Memory is short: up to {0} are needed, and {1} are free. The system may end the training; its "
                        "last state is kept. Close other programs, or prepare the data set with smaller photos."
                    ).format(size_text(forecast.needed_bytes), size_text(machine.free_bytes)),
                )
            )
        if standing.free_bytes is not None and standing.free_bytes < LEAST_FREE_BYTES:
            lines.append(
                (
                    "error",
                    self.tr(
                        "Only {0} are free on the disk. States and models are written beside the old ones; make room, "
                        "or choose another folder."
                    ).format(size_text(standing.free_bytes)),
                )
            )
        return lines

    def _computer(self, machine: Machine, cuda: tuple[str, ...] | None, choice: TrainChoice) -> list[Told]:
        words = self.tr("{0} cores").format(machine.cores)
        if machine.memory_bytes is not None:
            words += self.tr(", {0} of memory").format(size_text(machine.memory_bytes))
        if machine.free_bytes is not None:
            words += self.tr(", {0} of it free").format(size_text(machine.free_bytes))
        lines: list[Told] = [("", words)]
        if cuda is None:
            lines.append(("", self.tr("Looking for a CUDA device ...")))
        elif not cuda:
            lines.append(
                (
                    "warning",
                    self.tr("No CUDA device: models are learned by one core of the processor."),
                )
            )
            lines.append(
                (
                    "",
                    self.tr(
                        "The times to choose from are meant for that. A step of splats alone, 20 000 of them on 256 x "
                        "192 pixels, takes about 75 ms; with mirrored light or more pixels it takes longer."
                    ),
                )
            )
        else:
            lines.append(("", self.tr("CUDA device: {0}").format("; ".join(cuda))))
            if not choice.on_cuda:
                lines.append(("", self.tr("It is not used: the processor is chosen.")))
        return lines

    def _photos(self, card: DataSetCard, forecast: Forecast) -> list[Told]:
        lens = card.source.photos[0].intrinsics
        lines: list[Told] = [
            (
                "",
                self.tr("{0} photos of {1} x {2} pixels take {3} of memory when they are decoded.").format(
                    len(card.source.photos), lens.width_px, lens.height_px, size_text(forecast.photos_bytes)
                ),
            )
        ]
        if forecast.all_fit:
            lines.append(("", self.tr("All of them fit, and each is read once.")))
        else:
            lines.append(
                (
                    "",
                    self.tr(
                        "They are streamed through at most {0}: each is looked at four times while it is at hand, then "
                        "others take its place."
                    ).format(size_text(forecast.limit_bytes)),
                )
            )
        if forecast.is_reduced:
            lines.append(
                (
                    "warning",
                    self.tr("Less memory is taken than usual ({0}), for little is free.").format(
                        size_text(forecast.limit_bytes)
                    ),
                )
            )
        lines.append(
            (
                "",
                self.tr("All in all a training takes up to {0}; {1} of it are the program's.").format(
                    size_text(forecast.needed_bytes), size_text(PROGRAM_BYTES)
                ),
            )
        )
        return lines


def size_text(n_bytes: int) -> str:
    """Bytes as people read them."""
    return f"{n_bytes / 2**30:.1f} GiB" if n_bytes >= 1 << 30 else f"{n_bytes / 2**20:.0f} MiB"
