"""Make `sun_reference.json`: `python -m tests.planning.geo.make_sun_reference`, in an environment with pvlib 0.16.1.

Positions and refraction are those of pvlib's `nrel_numpy`, the Solar Position Algorithm of I. Reda and A. Andreas
(NREL/TP-560-34302), at 1010 hPa and 10 degrees Celsius; rise, transit and set are its `sun_rise_set_transit_spa`. pvlib
is no dependency here: with pandas and h5py it takes 300 MB.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

REFERENCE = Path(__file__).with_name("sun_reference.json")

PLACES = (
    (0.0, 0.0),
    (22.3, 114.2),
    (48.1, 11.6),
    (-33.9, 151.2),
    (69.6, 18.9),
    (-77.8, 166.7),
    (64.0, -179.9),
    (-18.0, 179.9),
    (89.9, 0.0),
    (40.0, -105.0),
)

DAYS = ("2026-03-20", "2026-06-21", "2026-09-23", "2026-12-21")


def main() -> None:
    """Write the file."""
    import pandas as pd  # type: ignore[import-not-found]
    import pvlib  # type: ignore[import-not-found]

    rng = np.random.default_rng(0)
    content: dict[str, Any] = {"pvlib": pvlib.__version__, "places": [], "days": []}
    for lat_deg, lon_deg in PLACES:
        seconds = rng.integers(631_152_000, 631_152_000 + int(80 * 365.25 * 86_400), 12)
        times = pd.DatetimeIndex(pd.to_datetime(seconds, unit="s", utc=True))
        found = pvlib.solarposition.get_solarposition(
            times, lat_deg, lon_deg, method="nrel_numpy", pressure=101_000, temperature=10
        )
        columns = found[["azimuth", "elevation", "apparent_elevation"]].to_numpy().round(5).tolist()
        content["places"] += [[lat_deg, lon_deg, int(t), *row] for t, row in zip(seconds, columns, strict=True)]
        if abs(lat_deg) < 66.0:
            days = pd.DatetimeIndex([f"{day} 12:00" for day in DAYS], tz="UTC")
            events = pvlib.solarposition.sun_rise_set_transit_spa(days, lat_deg, lon_deg)
            for day in range(len(DAYS)):
                row = [events[name].iloc[day].timestamp() for name in ("sunrise", "transit", "sunset")]
                content["days"].append([lat_deg, lon_deg, *(round(value, 1) for value in row)])
    REFERENCE.write_text(json.dumps(content, separators=(",", ":")).replace("],[", "],\n[") + "\n")


if __name__ == "__main__":
    main()
