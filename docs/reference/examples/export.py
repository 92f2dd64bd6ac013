"""Write a plan for DJI and for MAVLink; `plan.py` makes the plan."""

from pathlib import Path

from groundstation.api import FileFormat, export_plan, read_missions

plan = Path("flight.plan.json")
for file_format, name in ((FileFormat.DJI_KMZ, "flight.kmz"), (FileFormat.MAVLINK_PLAN, "flight.plan")):
    paths, findings = export_plan(plan, file_format, Path(name))
    for path in paths:
        n_photos = sum(mission.n_photos for mission in read_missions(path))
        print(f"{path}: {n_photos} photos, {len(findings)} findings")
