"""The comparison of two versions: what it passes over, and what it tells."""

import json
import zipfile

import numpy as np
from safetensors.numpy import save_file

from tests.same_results import differences


def results(folder, covered=1, made=b"1", weight=1.0):
    (folder / "2dgs.model").mkdir(parents=True)
    plan = {"covered": covered, "history": [{"t_s": float(made)}], "effects": []}
    (folder / "office.plan.json").write_text(json.dumps(plan))
    with zipfile.ZipFile(folder / "office.kmz", "w") as archive:
        archive.writestr("wpmz/template.kml", b"<wpml:createTime>" + made + b"</wpml:createTime>")
    save_file({"means": np.full(3, weight)}, folder / "2dgs.model" / f"weights-{made.decode()}.safetensors")
    (folder / "2dgs.model" / "model.json").write_text(made.decode())
    return folder


def test_times_are_no_difference_and_values_are(tmp_path):
    mine = results(tmp_path / "mine")
    assert list(differences(mine, results(tmp_path / "later", made=b"2"))) == []
    other = results(tmp_path / "other", covered=2, weight=1.5)
    (other / "office.csv").write_text("a")
    assert list(differences(mine, other)) == [
        "2dgs.model/weights.safetensors: differs",
        "office.csv: only in one of them",
        "office.plan.json: differs",
    ]
