"""Sentences about missions, of MAVLink and in general."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "the plan has no {0}, so nothing can be placed on the globe; add --site SITE"),
    QT_TRANSLATE_NOOP("Sentences", "the plan was made for the {0} {1}, but the site says {2}; plan again"),
    QT_TRANSLATE_NOOP(
        "Sentences", "the plan has no sorties: nothing says which way to fly; plan again, locked views are kept"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "viewpoint '{0}' is in sortie {1} and again in sortie {2}; expected each viewpoint once",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} viewpoints are in no sortie (the first is '{1}'): their photos would be lost; plan the route again",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "viewpoint '{0}' needs a gimbal pitch of {1} deg, but {2} turns from {3} to {4} deg and would be stopped "
        "there; plan with this camera's limits",
    ),
    QT_TRANSLATE_NOOP("Sentences", "its path has {0} points; expected take-off, flight and landing"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its path {0} {1} m from home; expected it to start and end on the ground at home, where heights above "
        "take-off are counted from",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its path {0} with a slanted leg, but aircraft climb and land vertically and would leave the checked path; "
        "expected a vertex straight above home",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "viewpoint '{0}' is not on the path, or not in the order of viewpoint_ids, so its photo would be lost; plan "
        "the route again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected text in UTF-8, found other bytes at offset {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected the column {0} in the first line; it is missing"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, line {1:n}"),
    QT_TRANSLATE_NOOP("Sentences", "no table of photos ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "the table has no rows, so there is nothing to fly"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a table of photos does not say which way was flown between them; the path is straight from one to the next",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no photo ({0}); expected numbers with a decimal point"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the return height clears the path only, because the site was not given; check that it clears everything",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "MAVLink has no heights above the ellipsoid; expected above-takeoff or amsl (its absolute altitude)",
    ),
    QT_TRANSLATE_NOOP("Sentences", " (and {0} more errors)"),
    QT_TRANSLATE_NOOP("Sentences", "the mission would be refused: {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no mission file that is known; expected a DJI KMZ (or its unpacked folder), a QGroundControl .plan, a QGC "
        "WPL .waypoints, or a KML or CSV that Reflight wrote",
    ),
    QT_TRANSLATE_NOOP("Sentences", "not readable as XML ({0})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a KML of another program; it shows places but does not say where photos are taken and with which angles; "
        "import the mission file itself",
    ),
    QT_TRANSLATE_NOOP("Sentences", "damaged: a sortie lacks what Reflight writes ({0}); export it again"),
    QT_TRANSLATE_NOOP("Sentences", "item {0:n}"),
    QT_TRANSLATE_NOOP("Sentences", "the mission has {0} items, {1} keeps {2}; plan it with shorter sorties"),
    QT_TRANSLATE_NOOP("Sentences", "item {0:n} (command {1})"),
    QT_TRANSLATE_NOOP("Sentences", "the position {0}, {1} is not on the globe"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "latitude and longitude are 0: ArduPilot takes that for the place where it is, PX4 for one off Africa",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the altitude is no number"),
    QT_TRANSLATE_NOOP("Sentences", "the hold time is out of range"),
    QT_TRANSLATE_NOOP("Sentences", "DO_DIGICAM_CONTROL releases the camera only where param 5 is 1: no photo here"),
    QT_TRANSLATE_NOOP("Sentences", "param {0} is NaN, which ArduPilot refuses here"),
    QT_TRANSLATE_NOOP("Sentences", "ArduPilot stores whole seconds: the hold of {0} s becomes {1} s"),
    QT_TRANSLATE_NOOP("Sentences", "ArduPilot ignores the yaw of a waypoint (param 4); use CONDITION_YAW before it"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ArduPilot stores these angles in whole degrees; DO_MOUNT_CONTROL keeps the fraction",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} refuses this command in missions"),
    QT_TRANSLATE_NOOP("Sentences", "whether {0} takes this command in missions is not known"),
    QT_TRANSLATE_NOOP("Sentences", "{0} does not take the frame {1} here; expected one of {2}"),
    QT_TRANSLATE_NOOP("Sentences", "the height counts from terrain: without terrain data ArduPilot does not arm"),
    QT_TRANSLATE_NOOP("Sentences", "PX4 takes this command in frame 2 only, found frame {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the mission does not begin with a take-off: started on the ground it is refused"),
    QT_TRANSLATE_NOOP("Sentences", "some waypoints count their height from take-off, others from sea level"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the photo waits for a CONDITION while the aircraft flies on: it is taken on the way, and dropped without a "
        "word where the next waypoint is reached first; put the condition before the waypoint",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a second photo follows at once; within 0.1 s ArduPilot drops it; put a NAV_DELAY between",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the waypoint of this photo has no hold: the photo is taken in flight, about 1 m off",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the camera turns on in the instant of the photo; put a NAV_DELAY behind the trigger",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "on a gimbal without pan axis this turns the vehicle to param 3; put it before CONDITION_YAW",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the last {0} items follow the last navigation command and may never be done"),
    QT_TRANSLATE_NOOP("Sentences", "the waypoints are closer together than the vehicle tells apart"),
    QT_TRANSLATE_NOOP("Sentences", "items {0:n} and {1:n}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mission passes over or under this zone, and fences have no height: it is not in the file's fence",
    ),
    QT_TRANSLATE_NOOP("Sentences", "spline legs are taken as straight"),
    QT_TRANSLATE_NOOP("Sentences", "circles are taken as a stop at their centre"),
    QT_TRANSLATE_NOOP("Sentences", "jumps are not followed: each item counts once"),
    QT_TRANSLATE_NOOP("Sentences", "{0}item {1:n}"),
    QT_TRANSLATE_NOOP("Sentences", "{0}heights above take-off and above sea level are mixed, and home is not known"),
    QT_TRANSLATE_NOOP("Sentences", "a region of interest of mode {0} is not followed"),
    QT_TRANSLATE_NOOP("Sentences", "a photo is taken before the first waypoint, so where is not known; it is left out"),
    QT_TRANSLATE_NOOP("Sentences", "its position means here, but nothing says where that is"),
    QT_TRANSLATE_NOOP("Sentences", "the position {0}, {1}, {2} m is not on the globe"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its height counts from the terrain, which is not in the file; save the mission with heights above take-off "
        "or sea level",
    ),
    QT_TRANSLATE_NOOP("Sentences", "frame {0} does not place it on the globe"),
    QT_TRANSLATE_NOOP("Sentences", "this is a Reflight plan already; it needs no import"),
    QT_TRANSLATE_NOOP("Sentences", "no QGroundControl plan; expected a JSON object with fileType 'Plan'"),
    QT_TRANSLATE_NOOP("Sentences", "the plan has no mission (it may hold a fence only); save it with its mission"),
    QT_TRANSLATE_NOOP("Sentences", "{0} is {1}; expected {2}; save it with a current QGroundControl"),
    QT_TRANSLATE_NOOP("Sentences", "mission.items, item {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected an object, got {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the complex item '{0}' does not hold the items it generates, which only QGroundControl can make; turn it "
        "into simple items there",
    ),
    QT_TRANSLATE_NOOP("Sentences", "type is '{0}'; expected SimpleItem or ComplexItem"),
    QT_TRANSLATE_NOOP("Sentences", "expected numbers for command and frame, got {0} and {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected params to be 7 numbers or null, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected a list, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the mission has no waypoint, so there is nothing to fly"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle would refuse it: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected text, found other bytes at offset {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected 'QGC WPL 110' in the first line, found '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "expected the items numbered from 0 in order, found {0} in place {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} columns, found {1}"),
    QT_TRANSLATE_NOOP("Sentences", "expected numbers with a decimal point ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "damaged or no zip archive ({0}); a KMZ is one; copy it again"),
    QT_TRANSLATE_NOOP("Sentences", "holds {0} files; expected at most {1}"),
    QT_TRANSLATE_NOOP("Sentences", "holds the path '{0}', which leads out of it; refused as hostile"),
    QT_TRANSLATE_NOOP("Sentences", "holds '{0}' twice, so which one is meant is unknown; export it again"),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' is encrypted; export it without a password"),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' is damaged ({1}); copy the file again"),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' cannot be inflated ({1}); copy the file again"),
    QT_TRANSLATE_NOOP("Sentences", "'{0}' inflates to more than {1} MiB; refused as hostile"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photos are left out: the pilot turns the aircraft by hand there"),
    QT_TRANSLATE_NOOP("Sentences", "{0} photos have no gimbal pitch in the file; a gimbal starts level: 0 deg assumed"),
    QT_TRANSLATE_NOOP("Sentences", "the mission has no waypoints"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mission '{0}' is {1} km from the site's home; expected at most {2} km; is it the right site? Imported "
        "without one, the mission gets a bare site of its own, to look at it",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mission '{0}' reaches {1} km from the origin of the site; expected at most {2} km; a coordinate or a "
        "height in it is wrong",
    ),
    QT_TRANSLATE_NOOP("Sentences", "its heights are above take-off and were counted from the site's home"),
    QT_TRANSLATE_NOOP("Sentences", "its heights are above sea level and were brought to the ellipsoid with EGM96"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "it was planned for a take-off {0} m from the site's home; the way there is not the planned one",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its take-off point lies {0} m above the site's home, so counted from home all its heights are off by that",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its take-off point lies {0} m below the site's home, so counted from home all its heights are off by that",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the mission ends hovering at its last waypoint; the way home is the pilot's and not in the path",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no mission can be made of this plan: {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} planned photos and {1} in the file are too many to compare one by one; compare smaller plans",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the site file of '{0}' has changed since this plan was made; what the mission takes from it (return height, "
        "fences) is as it is now",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this plan is not ready to fly ({0} findings of the pre-flight check, the first: {1})",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} keeps the items of about {1} photos, but a sortie of this plan has {2}; the same views were shared out "
        "among {3} sorties for these files",
    ),
    QT_TRANSLATE_NOOP("Sentences", "this mission file is named twice; name the file of each sortie once"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the return height is below the highest point of the site: a returning aircraft may hit it; expected {0} m "
        "or more above take-off, got {1} m, and {2} m keep {3} m from everything",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file has {0} rally points, which belong to a site and not to a plan; mark them there",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the file states {0} s for its route, and by what it tells the aircraft to do it takes {1} s; with "
        "the way there and back, take-off and landing the flight takes {2} s",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} photos that the imported mission takes in passing are stops in these files, so the sortie takes "
        "{1} s instead of {2} s",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the leg is vertical, so there is no course to follow: the nose stays as it is"),
    QT_TRANSLATE_NOOP("Sentences", "param {0} is {1}; expected an angle in deg, so it is not followed"),
    QT_TRANSLATE_NOOP("Sentences", "param 1 is {0}; expected an angle in deg, so it is not followed"),
    QT_TRANSLATE_NOOP("Sentences", "a camera trigger every {0} would take {1} photos on one leg; it is not followed"),
    QT_TRANSLATE_NOOP("Sentences", "its home position {0}, {1}, {2} m is not on the globe and is not used"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; they are taken in the order of their numbers"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its file does not say where it takes off, so home is below its first waypoint, at an assumed height;"
        " what depends on that height is only to look at",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle would refuse this mission: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected viewpoints of the sortie, got {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of the {1} sections that flights can cover are covered ({2}): plan with more --views, or a --coverage",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the site lies where its BIM file says, which is often just the city: compare it with a map, and "
        "give its --origin",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "a sortie has {0} photos, and {1} keeps items for {2}: it is shared out among more sorties "
        "before it is uploaded",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "obstacle sensing does not see glass: the distance kept, {0} m at the least, rests on the "
        "position alone; fly with RTK",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "obstacle sensing does not see glass: the distance kept, {0} m at the least, rests on the position alone",
    ),
    QT_TRANSLATE_NOOP("Sentences", "where the sun stands is not looked at: no time is planned (--at)"),
    QT_TRANSLATE_NOOP("Sentences", "the sun is below the horizon ({0} degrees) at the planned time"),
    QT_TRANSLATE_NOOP("Sentences", "; at {0} it would be {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the sun is in the picture of {0} of {1} photos at the planned time{2}"),
    QT_TRANSLATE_NOOP("Sentences", "glass mirrors the sun into {0} of {1} photos at the planned time{2}"),
    QT_TRANSLATE_NOOP("Sentences", "the sun is in no photo at the planned time, and no glass mirrors it into one"),
    QT_TRANSLATE_NOOP("Sentences", "what cold takes from the batteries is not looked at (--temperature)"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "at {0} degrees a battery gives some {1} of its charge, {2} s above the reserve, and the longest "
        "sortie takes {3} s: warm the batteries to 20 degrees, or plan shorter sorties with a larger "
        "--reserve",
    ),
    QT_TRANSLATE_NOOP("Sentences", "at {0} degrees a battery gives some {1} of its charge, and that is enough"),
)
