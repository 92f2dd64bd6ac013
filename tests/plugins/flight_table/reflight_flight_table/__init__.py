"""A mission format: one line of text for each photo, with position and angles. It is only written."""

from groundstation.api import EncodedFiles, MissionFormat


def encode(plan, missions, options):
    lines = ["latitude;longitude;height;heading;pitch"]
    for mission in missions:
        for waypoint in mission.waypoints:
            place = waypoint.position
            for photo in waypoint.photos:
                lines.append(
                    f"{place.lat_deg:.7f};{place.lon_deg:.7f};{place.height_ellipsoid_m:.2f};"
                    f"{photo.heading_deg:.1f};{photo.gimbal_pitch_deg:.1f}"
                )
    return EncodedFiles(("\n".join(lines).encode(),), ())


FLIGHT_TABLE = MissionFormat((".table",), encode, title="Flight table (.table)")
