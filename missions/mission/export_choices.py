"""What can be chosen for mission files, by the words of the command line; loads nothing, for lists and `-h`."""

from __future__ import annotations

from enum import StrEnum


class HeightReference(StrEnum):
    """What the heights of a mission file are measured from."""

    ABOVE_TAKEOFF = "above-takeoff"
    AMSL = "amsl"
    ELLIPSOID = "ellipsoid"


class FileFormat(StrEnum):
    """Mission file formats of this program, by the names of the command line."""

    DJI_KMZ = "dji-kmz"
    MAVLINK_PLAN = "mavlink-plan"
    MAVLINK_WPL = "mavlink-wpl"
    KML = "kml"
    CSV = "csv"


class LinkLoss(StrEnum):
    """What a DJI aircraft does when it no longer hears the remote controller."""

    CONTINUE = "continue"
    """Fly the mission to its end at home: the only path that has been checked."""
    GO_HOME = "go-home"
    """Leave the mission, climb to the return height and fly straight home, over whatever stands in between."""


LOWEST_RETURN_M, HIGHEST_RETURN_M = 20.0, 1500.0
"""Return heights above take-off that DJI's remote controllers take; the higher is that of all heights of waylines."""
