"""Sentences of flying: links, uploads, the pre-flight list, warnings, simulation, top-up and resume."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no flight through missing sections was found that fits {0}'s waypoint limit and the {1} s that the "
        "battery allows; change the battery",
    ),
    QT_TRANSLATE_NOOP("Sentences", "shortening the flight"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the battery is at {0}; a reserve of {1} and {2} s for take-off and landing leave nothing to fly on; "
        "change the battery",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "none of the {0} missing sections can be seen from any allowed place that was found on the site as "
        "it is now; check its no-fly volumes and obstacles, or lower the minimum distance",
    ),
    QT_TRANSLATE_NOOP("Sentences", " of a battery at {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of the {1} missing sections can be seen, but none within the {2} s{3} that are left above the "
        "reserve; move home closer",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of the {1} missing sections can be seen, but none within the {2} s{3} that are left above the "
        "reserve; change the battery",
    ),
    QT_TRANSLATE_NOOP("Sentences", "comparing the flight"),
    QT_TRANSLATE_NOOP("Sentences", "the link is closed"),
    QT_TRANSLATE_NOOP("Sentences", "the other end closed the link"),
    QT_TRANSLATE_NOOP("Sentences", "the UDP link broke: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the TCP link to {0} broke: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} closed the TCP link"),
    QT_TRANSLATE_NOOP("Sentences", "serial links need the package pyserial; install it, or use a UDP or TCP link"),
    QT_TRANSLATE_NOOP("Sentences", "the serial line {0} cannot be opened: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the serial line {0} broke: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "link '{0}': expected serial:DEVICE:BAUD, such as serial:/dev/ttyUSB0:57600"),
    QT_TRANSLATE_NOOP("Sentences", "link '{0}': expected KIND:HOST:PORT, such as tcp:127.0.0.1:5760; kinds are {1}"),
    QT_TRANSLATE_NOOP("Sentences", "no answer within {0} s; is the address right?"),
    QT_TRANSLATE_NOOP("Sentences", "{0} cannot be opened: {1}; is the address right?"),
    QT_TRANSLATE_NOOP("Sentences", "{0} cannot be opened: another program has this port; end it, or take another"),
    QT_TRANSLATE_NOOP("Sentences", "reading back"),
    QT_TRANSLATE_NOOP("Sentences", "{0} items were sent, {1} are on the vehicle"),
    QT_TRANSLATE_NOOP("Sentences", "item {0}, {1}: sent {2}, on the vehicle {3}"),
    QT_TRANSLATE_NOOP("Sentences", "what is on the vehicle now could not be read: do not fly before it was"),
    QT_TRANSLATE_NOOP("Sentences", "nothing is on the vehicle now"),
    QT_TRANSLATE_NOOP("Sentences", "; and {0} more"),
    QT_TRANSLATE_NOOP("Sentences", "{0} items are on the vehicle, and not those that were sent ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "the list could not be cleared"),
    QT_TRANSLATE_NOOP("Sentences", " at item {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle refused the upload{0} ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle accepted every item"),
    QT_TRANSLATE_NOOP("Sentences", "every item was sent, but the vehicle did not confirm them"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle stopped answering{0}"),
    QT_TRANSLATE_NOOP("Sentences", "the upload did not get on{0}"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle did not keep to the items{0}"),
    QT_TRANSLATE_NOOP("Sentences", "sortie {0} is complete: all {1} views have a photo, so there is nothing to resume"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the rest of sortie {0} cannot be flown as it was planned{1}: {2}; plan a top-up instead, which "
        "finds its own views and ways",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the sortie cannot be resumed on the site as it is now: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "there is no effect '{0}' of the flight; known are: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "barometer drift"),
    QT_TRANSLATE_NOOP("Sentences", "m at the shutter"),
    QT_TRANSLATE_NOOP("Sentences", "the height comes from the GNSS receiver"),
    QT_TRANSLATE_NOOP("Sentences", "the weather drifts by {0} hPa an hour over a flight of {1} s"),
    QT_TRANSLATE_NOOP("Sentences", "battery sag"),
    QT_TRANSLATE_NOOP("Sentences", "of the battery"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} of the flight is hovered in {1} m/s of wind: {2} of the power for which the endurance is stated",
    ),
    QT_TRANSLATE_NOOP("Sentences", "gimbal lag"),
    QT_TRANSLATE_NOOP("Sentences", "deg at the shutter"),
    QT_TRANSLATE_NOOP("Sentences", "there are no views"),
    QT_TRANSLATE_NOOP("Sentences", "turns of up to {0} deg have {1} s to settle"),
    QT_TRANSLATE_NOOP("Sentences", "GNSS noise"),
    QT_TRANSLATE_NOOP("Sentences", "an RTK fix"),
    QT_TRANSLATE_NOOP("Sentences", "RTK without fixed ambiguities"),
    QT_TRANSLATE_NOOP("Sentences", "no RTK"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m horizontally"),
    QT_TRANSLATE_NOOP("Sentences", "link loss"),
    QT_TRANSLATE_NOOP("Sentences", "of the messages"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of the messages and {1} s are said to be lost"),
    QT_TRANSLATE_NOOP("Sentences", "no loss is said to be expected"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "at the views {0} of the sky are mirrored in glass and {1} hidden, carrier phase counts",
    ),
    QT_TRANSLATE_NOOP("Sentences", "at the views {0} of the sky are mirrored in glass and {1} hidden, code counts"),
    QT_TRANSLATE_NOOP("Sentences", "photo latency and blur"),
    QT_TRANSLATE_NOOP("Sentences", "px of blur"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "photos are taken at rest, where gusts leave {0} m/s; the shutter is open for {1} ms, a pixel is {2} "
        "mm on the glass",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "wind of {0} m/s carries the aircraft away, which leans {1} deg at most and so flies {2} m/s through "
        "the air; wait for less wind",
    ),
    QT_TRANSLATE_NOOP("Sentences", "no wind is expected"),
    QT_TRANSLATE_NOOP("Sentences", "wind of {0} m/s with gusts of {1} m/s (1 sigma) at {2} m"),
    QT_TRANSLATE_NOOP("Sentences", "no answer"),
    QT_TRANSLATE_NOOP("Sentences", "not now"),
    QT_TRANSLATE_NOOP("Sentences", "not supported"),
    QT_TRANSLATE_NOOP("Sentences", "only as COMMAND_LONG"),
    QT_TRANSLATE_NOOP("Sentences", "only as COMMAND_INT"),
    QT_TRANSLATE_NOOP("Sentences", "frame not supported"),
    QT_TRANSLATE_NOOP("Sentences", "result {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle refused {0} ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle did not answer to {0}"),
    QT_TRANSLATE_NOOP("Sentences", "preparing the vehicle"),
    QT_TRANSLATE_NOOP("Sentences", "checking before take-off"),
    QT_TRANSLATE_NOOP("Sentences", "ready for take-off"),
    QT_TRANSLATE_NOOP("Sentences", "resuming the mission"),
    QT_TRANSLATE_NOOP("Sentences", "returning home"),
    QT_TRANSLATE_NOOP("Sentences", "landing here"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle is heard again"),
    QT_TRANSLATE_NOOP("Sentences", "no heartbeat; the aircraft goes on by itself"),
    QT_TRANSLATE_NOOP("Sentences", "mode {0}.{1}"),
    QT_TRANSLATE_NOOP("Sentences", "mode {0}"),
    QT_TRANSLATE_NOOP("Sentences", "pre-arm checks"),
    QT_TRANSLATE_NOOP("Sentences", "no autopilot was heard yet"),
    QT_TRANSLATE_NOOP("Sentences", "no heartbeat for {0} s"),
    QT_TRANSLATE_NOOP("Sentences", "{0} answers"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot does not know where it is yet"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot has {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot sends no position"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot knows where it is"),
    QT_TRANSLATE_NOOP("Sentences", "the GNSS receiver is silent"),
    QT_TRANSLATE_NOOP("Sentences", "fix: {0}, {1} satellites"),
    QT_TRANSLATE_NOOP("Sentences", "; {0} is needed"),
    QT_TRANSLATE_NOOP("Sentences", "where the aircraft stands is not known yet"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the aircraft stands {0} m from the planned home, outside the airspace; put it at {1}",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft stands {0} m from the planned home; put it at {1}, or plan from here"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m from the planned home"),
    QT_TRANSLATE_NOOP("Sentences", "down to {0} m above the ground"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, {1} min below {2} m"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, under the usual {1} m: look for people, cars and cables on the whole way"),
    QT_TRANSLATE_NOOP("Sentences", "the battery's charge is not known"),
    QT_TRANSLATE_NOOP("Sentences", "the battery holds {0}; the sortie and the reserve take {1}: {2}"),
    QT_TRANSLATE_NOOP("Sentences", " ({0} flies it in {1} min, the plan reckons with {2} min)"),
    QT_TRANSLATE_NOOP("Sentences", "put in a full one"),
    QT_TRANSLATE_NOOP("Sentences", "none holds that much: plan it again, in shorter sorties"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; the sortie and the reserve take {1}"),
    QT_TRANSLATE_NOOP("Sentences", "it does not say why"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot cannot be armed yet ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "it can be armed, but has trouble with: "),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot is content with all sensors"),
    QT_TRANSLATE_NOOP("Sentences", "not measured on the ground; look up"),
    QT_TRANSLATE_NOOP("Sentences", "the wind blows with {0} m/s, more than the {1} m/s of {2}; wait for less"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} was not uploaded yet"),
    QT_TRANSLATE_NOOP("Sentences", "what the vehicle holds is not this {0}: upload it again"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} is on board, read back and equal"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no ArduPilot or PX4 was heard within {0} s; is the vehicle on, and the address right?",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected {0}, found {1}; name the other autopilot"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle is armed already; land and disarm it first"),
    QT_TRANSLATE_NOOP("Sentences", "sending telemetry"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle is heard but does not answer; does the link go both ways?"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; {1} take effect after a reboot only: restart the vehicle"),
    QT_TRANSLATE_NOOP("Sentences", "the autopilot restarts, so that {0} take effect"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle did not come back within {0} s of its reboot"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle was not rebooted; {0} take effect then: restart it"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} is not on the vehicle: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "not ready for take-off: "),
    QT_TRANSLATE_NOOP("Sentences", "not ready for take-off after {0} s: "),
    QT_TRANSLATE_NOOP("Sentences", "the mode {0}"),
    QT_TRANSLATE_NOOP("Sentences", "starting the mission"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle is in mode {0} and not in {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft did not take off{0}"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle was not heard for {0} s in flight; what was recorded ends there"),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft is armed for longer than any battery lasts; look at what it does"),
    QT_TRANSLATE_NOOP("Sentences", "its measurements contradict each other"),
    QT_TRANSLATE_NOOP("Sentences", "no position yet"),
    QT_TRANSLATE_NOOP("Sentences", "no height yet"),
    QT_TRANSLATE_NOOP("Sentences", "no velocity yet"),
    QT_TRANSLATE_NOOP("Sentences", "this log exists already; name another file"),
    QT_TRANSLATE_NOOP("Sentences", "the telemetry log cannot be made ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "the disk is full"),
    QT_TRANSLATE_NOOP("Sentences", "the telemetry log may lack its end ({0})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the telemetry log cannot be written ({0}); free some space, and it goes on by itself",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the folder for telemetry logs cannot be made ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "no heartbeat for {0} s: what is shown is old; the aircraft goes on by itself"),
    QT_TRANSLATE_NOOP("Sentences", "the facade is {0} m away and will be {1} m away where the aircraft can stop"),
    QT_TRANSLATE_NOOP("Sentences", "the wind is {0} m/s; {1} may fly in up to {2} m/s"),
    QT_TRANSLATE_NOOP("Sentences", "the battery holds {0}, less than the reserve of {1}: land"),
    QT_TRANSLATE_NOOP("Sentences", "the way home would use the reserve: {0} left, {1} needed"),
    QT_TRANSLATE_NOOP("Sentences", "the battery holds {0}; at {1} the aircraft must turn home"),
    QT_TRANSLATE_NOOP("Sentences", "the airspace ends {0} m from where the aircraft can stop"),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft is {0} m outside the airspace"),
    QT_TRANSLATE_NOOP("Sentences", "a no-fly zone is {0} m from where the aircraft can stop"),
    QT_TRANSLATE_NOOP("Sentences", "the GNSS receiver has lost its fix: fly by hand or land"),
    QT_TRANSLATE_NOOP("Sentences", "RTK is lost"),
    QT_TRANSLATE_NOOP("Sentences", "no photo came from viewpoint '{0}'; {1} of this sortie are missing"),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft is {0} m beside its planned path"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the plan was made for the site '{0}' as it was then, and this is another site '{1}'; name the site "
        "file that it was made for, or plan again",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the plan was made for the site '{0}' as it was then, and this is a changed site '{1}'; name the "
        "site file that it was made for, or plan again",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "nothing can be uploaded now: the vehicle must be heard, on the ground and disarmed",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the pre-flight list is not all well, or nothing was uploaded yet"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle does not fly its mission, so there is nothing to pause"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle is not in flight, so there is nothing to resume"),
    QT_TRANSLATE_NOOP("Sentences", "no vehicle was heard yet, so none can return"),
    QT_TRANSLATE_NOOP("Sentences", "no vehicle was heard yet, so none can land"),
    QT_TRANSLATE_NOOP("Sentences", "there is no link"),
    QT_TRANSLATE_NOOP("Sentences", "the mission is on board, read back and equal"),
    QT_TRANSLATE_NOOP("Sentences", "the aircraft flies its mission"),
    QT_TRANSLATE_NOOP("Sentences", "the flight could not be watched any longer ({0}: {1}); please report it"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "disconnected in flight; the aircraft goes on by itself, what was recorded ends there",
    ),
    QT_TRANSLATE_NOOP("Sentences", "preparing the flight"),
    QT_TRANSLATE_NOOP(
        "Sentences", "the plan breaks {0:n} pre-flight rules, such as: {1}; correct it before it is flown"
    ),
    QT_TRANSLATE_NOOP("Sentences", "cannot be seen from any allowed place that was found on the site as it is now"),
    QT_TRANSLATE_NOOP("Sentences", "can be seen, but the batteries allowed do not last for them; change the battery"),
    QT_TRANSLATE_NOOP("Sentences", "can only be seen from places closer together than aircraft accept"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "flight ('{0}'), plan ('{1}') and site ('{2}') do not have the same name and origin; name the plan "
        "and the site file that this flight was flown with",
    ),
    QT_TRANSLATE_NOOP("Sentences", "its plan has another checksum"),
    QT_TRANSLATE_NOOP("Sentences", "none of its {0} photos was taken near a view of it"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "this is a flight of another plan: {0}; name the plan file that it was flown with, as it was then",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the site file has changed since the plan was made; what is missing is planned on the site as it is now",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} photos belong to no view, and nothing says where they look; what they show counts as missing",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} of the {1} missing sections (on {2} panels) {3}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} of {1} sections are missing, too few for a flight unasked; {2}"),
    QT_TRANSLATE_NOOP("Sentences", "none of them can be shown"),
    QT_TRANSLATE_NOOP("Sentences", "showing {0} of them takes {1} min in the air (views: {2}, batteries: {3})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no sortie of this plan was interrupted: those that were flown are complete; the next one is flown "
        "from the plan itself",
    ),
    QT_TRANSLATE_NOOP("Sentences", "sortie: expected 1 to {0}, got {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the rest of sortie {0} takes {1} s, but a battery at {2} allows {3} s above the reserve; change the "
        "battery, or plan a top-up, which fits it",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} views were photographed, but the camera's reports were lost on the radio; what they show counts as "
        "missing. The autopilot's log (.BIN, .ulg) tells of them: name it instead of the flight file",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle signs what it sends, and may not obey a link that is not signed; disconnect, and connect "
        "signed with its key",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle was given the key and does not sign with it; it may not know signing"),
    QT_TRANSLATE_NOOP("Sentences", "no autopilot is heard within {0} s; is it switched on, and does it use this key?"),
    QT_TRANSLATE_NOOP("Sentences", "expected a passphrase of {0} characters or more, got {1}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there is no signing key on this computer; set one ('signing set', or Key in the Fly tab)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle signs with another key than this computer's; set the passphrase that it was given, or "
        "give it this computer's key over a cable",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle does not sign what it sends; give it this computer's key over a cable, or connect without signing",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} does not hold a time stamp for signing ({1}); delete it"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "others may read the signing key {0} (mode {1}, expected {2}); give the vehicle a new key, or run: "
        "chmod 600 '{3}'",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the signing key {0} cannot be read: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} cannot be written: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} does not hold a signing key of {1} hex digits; set it anew"),
    QT_TRANSLATE_NOOP("Sentences", "the passphrase for signing is empty; expected the one that the vehicle was given"),
    QT_TRANSLATE_NOOP("Sentences", "without the link it flies the mission on, and lands at home"),
    QT_TRANSLATE_NOOP("Sentences", "what the vehicle does when the link is lost is not known: it has no {0}"),
    QT_TRANSLATE_NOOP("Sentences", "how high the vehicle returns is not known; look before it is told to return"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m above take-off, to the nearest of home and the rally points ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m above take-off, to home"),
    QT_TRANSLATE_NOOP("Sentences", "set {0} so that it returns {1} m above take-off"),
    QT_TRANSLATE_NOOP("Sentences", "it returns straight through the building or an obstacle ({0}): {1}"),
    QT_TRANSLATE_NOOP("Sentences", "it returns {0} m from the building or an obstacle ({1}): {2}"),
    QT_TRANSLATE_NOOP("Sentences", "it climbs within {0} m of the building or an obstacle before it returns ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "it returns across a no-fly zone ({0}); fly it back by hand"),
    QT_TRANSLATE_NOOP("Sentences", "it returns {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the geofence is on board, but nothing keeps the aircraft from leaving it ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "at the geofence it returns ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "at the geofence it lands ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "at the geofence it hovers ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "at the geofence it stops its motors and falls ({0}): set it otherwise"),
    QT_TRANSLATE_NOOP("Sentences", "what the vehicle does at the geofence is not known: see {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the sortie climbs to {0} m above take-off, the vehicle's fence ends at {1} m: raise {2}",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the sortie climbs to {0} m below the vehicle's fence: raise {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the sortie stays {0} m below the vehicle's fence ({1})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the sortie goes {0} m away from home, the vehicle's fence ends at {1} m: raise {2}",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the sortie comes within {0} m of the vehicle's fence: raise {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the sortie stays {0} m inside the vehicle's fence ({1})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} is {1}: the autopilot commands no camera, or no gimbal; set it to {2} and restart the vehicle",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle does not say whether it has rally points; look before it returns by itself",
    ),
    QT_TRANSLATE_NOOP("Sentences", "list of rally points"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle had {0} rally points of another flight; they are cleared"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle was restarted"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle was not heard for a while"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle says that it holds something else now"),
    QT_TRANSLATE_NOOP("Sentences", "another ground station has written to the vehicle"),
    QT_TRANSLATE_NOOP("Sentences", "it could not be read"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} on board could not be read again ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle has another {0} now: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} on board is the one that was uploaded"),
    QT_TRANSLATE_NOOP("Sentences", "what is on board is not known any more: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the {0} was uploaded, but {1}: it is read again"),
    QT_TRANSLATE_NOOP(
        "Sentences", "the {0} on the vehicle is not the one that was uploaded; it was not started: upload it again"
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0}; it was not started"),
    QT_TRANSLATE_NOOP(
        "Sentences", "what is on the vehicle is not known ({0}); it was not started: wait until it is read"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle has another mission now than the one that was uploaded: pause it, and look what it does",
    ),
    QT_TRANSLATE_NOOP("Sentences", "through the building or an obstacle"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m from something"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "an aircraft that returns by itself would fly {0}: at {1} m above take-off it clears everything, "
        "and the airspace ends at {2} m; raise its ceiling, or move home to the side of the building "
        "that is flown",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "an aircraft that returns by itself climbs within {0} m of the building or an obstacle"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the return height is above the airspace: expected at most {0} m above take-off, got {1} m; {2} m are right",
    ),
    QT_TRANSLATE_NOOP("Sentences", "it returns above the airspace, which ends {0} m above take-off ({1}): {2}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the flight would begin {0} m above take-off, at least {1} m are needed; plan it from where the "
        "aircraft stands",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} (overruled)"),
    QT_TRANSLATE_NOOP("Sentences", "how high the aircraft stands is not known yet"),
    QT_TRANSLATE_NOOP("Sentences", " (its GNSS height is good to {0} m)"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m above the planned home{1}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} m below the planned home{1}"),
    QT_TRANSLATE_NOOP("Sentences", "they are as the plan needs them"),
    QT_TRANSLATE_NOOP("Sentences", "; {0} more differ"),
    QT_TRANSLATE_NOOP("Sentences", "the vehicle does not know these parameters: {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the aircraft stands {0} m lower than the planned home{1}, and all of the flight would be: raise "
        "it by {2} m, or plan from here",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the aircraft stands {0} m higher than the planned home{1}, and all of the flight would be: "
        "lower it by {2} m, or plan from here",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "the vehicle's own home lies {0} m higher than the planned one: set it anew where it stands"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "the vehicle's own home lies {0} m lower than the planned one: set it anew where it stands"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle counts its heights from {0} m above the planned home; it was not started: set its "
        "home anew where it stands",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle counts its heights from {0} m below the planned home; it was not started: set its "
        "home anew where it stands",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "an aircraft that returns by itself, {0} m above take-off, crosses a no-fly zone; fly it back by hand",
    ),
    QT_TRANSLATE_NOOP("Sentences", "an aircraft that returns by itself flies {0} m above take-off, {1} m are allowed"),
    QT_TRANSLATE_NOOP(
        "Sentences", "the motors stopped {0} m above take-off: the aircraft fell; look for it, and for the cause"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the record ends {0} m above take-off with the motors running; what came after is not in it: "
        "take the autopilot's own log",
    ),
    QT_TRANSLATE_NOOP("Sentences", "the battery was empty at the end ({0}): the aircraft could have fallen"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and it flies the mission on ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and it breaks the mission off and returns ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and it lands, whatever is below it ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and it hovers until its battery is low ({1})"),
    QT_TRANSLATE_NOOP(
        "Sentences", "{0}, and it only keeps its height and drifts with the wind: take over at once ({1})"
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and it stops its motors and falls ({1}): set it otherwise"),
    QT_TRANSLATE_NOOP("Sentences", "{0}, and what the vehicle does is not known ({1})"),
    QT_TRANSLATE_NOOP("Sentences", "{0} s without the link"),
    QT_TRANSLATE_NOOP("Sentences", "what the vehicle does without its remote control is not known: it has no {0}"),
    QT_TRANSLATE_NOOP(
        "Sentences", "it takes no remote control (COM_RC_IN_MODE {0}): only this ground station can take over"
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} s without the remote control"),
    QT_TRANSLATE_NOOP("Sentences", "nothing is done by itself when the battery is low: watch it, and land in time"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the vehicle breaks the mission off at a charge of {0}, and the sortie ends with {1}: set {2} so that it lasts",
    ),
    QT_TRANSLATE_NOOP("Sentences", "battery below {0}"),
    QT_TRANSLATE_NOOP("Sentences", "COM_LOW_BAT_ACT {0}"),
    QT_TRANSLATE_NOOP("Sentences", "{0} mAh"),
    QT_TRANSLATE_NOOP("Sentences", "BATT_FS_{0}_ACT {1}"),
    QT_TRANSLATE_NOOP("Sentences", "what the vehicle does when it loses its position is not known: it has no {0}"),
    QT_TRANSLATE_NOOP("Sentences", "FS_EKF_THRESH {0}"),
    QT_TRANSLATE_NOOP("Sentences", "position lost"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "{0} go by the number {1} on this link: switch one off, or give each a number of its own "
        "(SYSID_THISMAV, MAV_SYS_ID)",
    ),
    QT_TRANSLATE_NOOP("Sentences", "{0} answers, vehicle {1}; others are on the link, too: {2}"),
    QT_TRANSLATE_NOOP("Sentences", "the motors stopped {0} m above take-off: the aircraft fell; look for it{1}"),
    QT_TRANSLATE_NOOP("Sentences", "two vehicles of different kinds"),
    QT_TRANSLATE_NOOP("Sentences", "two vehicles whose times since power-up differ"),
    QT_TRANSLATE_NOOP("Sentences", "two vehicles at different places"),
    QT_TRANSLATE_NOOP(
        "Sentences", "{0} go by one number on this link: nothing shown here can be relied on; fly it by hand"
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the aircraft sends no position any more: its distance, airspace, no-fly zones and path are not "
        "watched; fly it by hand",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the autopilot has {0}: its place may be wrong, and so may the warnings of distance, airspace, "
        "no-fly zones and path; be ready to fly by hand",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "the camera looked {0} degrees off at viewpoint '{1}', and elsewhere at {2} of the last {3} "
        "photos: the gimbal may be stuck; pause, and look",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences", "it climbs there on its way, and no other height mends that; be ready to fly it back by hand"
    ),
)
