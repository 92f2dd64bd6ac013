"""Train a very small model of the data set in the folder `dataset`."""

from pathlib import Path

from groundstation.api import ModelExport, TrainRequest, export_model, train_files

wanted = TrainRequest(preset="smoke", method="2dgs", iterations=20)
made = train_files(Path("dataset"), Path("model"), wanted)
print(f"{made.trained.n_splats} splats after {made.trained.n_steps} steps")
written = export_model(made.folder, Path("model.ply"), ModelExport("ply"))
print(f"{written.path}: {written.n_bytes} bytes")
