"""The terms of the trade, each said once: the "?" beside a word of the window shows it, and so does the manual."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from planning.base.messages import Message, say


@dataclass(frozen=True, slots=True)
class Term:
    """A term.

    Parameters
    ----------
    name
        As it stands in the window.
    also
        Other words of the window that mean it, or a choice of it.
    says
        What it is, in a sentence or two.
    page
        Of the manual, with the heading after "#" where there is one.
    """

    name: Message
    says: Message
    page: str
    also: tuple[Message, ...] = ()


TERMS = (
    Term(
        say("Hemisphere section"),
        say(
            "A part of the hemisphere of directions before a panel. A photo covers the section that it is taken from; "
            "glass looks different from each."
        ),
        "concepts/coverage.md",
        (say("Section step"), say("Weight by solid angle")),
    ),
    Term(
        say("Coverage"),
        say("The share of sections that photos show, of those that any flight could show at this site."),
        "concepts/coverage.md",
        (say("Target coverage"), say("Not covered"), say("Count whole panels only")),
    ),
    Term(
        say("Viewpoint"),
        say("A place in the air with heading and gimbal pitch, from where one photo is taken."),
        "concepts/planning.md",
        (say("Views"), say("Viewpoints"), say("Views are chosen for")),
    ),
    Term(
        say("Sortie"),
        say("A flight with one battery, from take-off to landing."),
        "concepts/planning.md",
        (say("Batteries"), say("Aircraft at once")),
    ),
    Term(
        say("GSD"),
        say("Ground sampling distance: how much of the facade one pixel shows. 2.7 mm shows a scratch, 20 mm a frame."),
        "concepts/coverage.md",
        (say("Coarsest GSD"), say("Wanted GSD")),
    ),
    Term(
        say("Safety distance"),
        say("Nothing of the flight comes nearer than this to panels, building and obstacles."),
        "guide/plan.md",
        (say("Clearance"), say("smallest clearance")),
    ),
    Term(
        say("Method"),
        say(
            "How viewpoints are chosen. The optimised one takes the viewpoint that adds most, again and again, and "
            "proves how far from the best it can be; the others are there to compare with."
        ),
        "concepts/planning.md",
        (say("Quality"),),
    ),
    Term(
        say("Time to plan"),
        say("The longest that the search may take. It ends sooner where nothing can be won any more."),
        "guide/plan.md",
    ),
    Term(
        say("Battery reserve"),
        say("The share of the charge with which the aircraft has to be back."),
        "concepts/planning.md",
    ),
    Term(
        say("Worth another battery"),
        say("By how much unseen views of the model must get better, in decibels, for one battery more to be planned."),
        "concepts/worth.md",
        (say("Worth"),),
    ),
    Term(
        say("Precision"),
        say("Single precision counts sections several times as fast, and errs on borders of sections alone."),
        "concepts/coverage.md",
    ),
    Term(
        say("Above ellipsoid"),
        say("Height above the WGS 84 ellipsoid, as GNSS measures it. It is no height above the sea."),
        "decisions/heights.md",
        (say("Above sea level"), say("Heights are"), say("Above take-off")),
    ),
    Term(
        say("Geoid"),
        say(
            "The level of the sea, carried on below the land. Heights above sea level count from it; it lies up to "
            "100 m above or below the ellipsoid. EGM96 and EGM2008 are grids of it."
        ),
        "decisions/heights.md",
        (say("Grid of the geoid"), say("Heights are above")),
    ),
    Term(
        say("Site origin"),
        say("The place on earth from which the site counts metres east, north and up."),
        "guide/site.md",
        (say("Place on earth"),),
    ),
    Term(
        say("Facade grid"),
        say("Equal panels in rows and columns, laid into a rectangle on a wall."),
        "guide/site.md",
    ),
    Term(
        say("Airspace"),
        say("The box in which the aircraft must stay; only the climb above home may be below it."),
        "guide/site.md",
        (say("Airspace around the building"),),
    ),
    Term(
        say("Rally point"),
        say("A place where the aircraft may land instead of home when it returns."),
        "guide/site.md",
    ),
    Term(
        say("Autopilot"),
        say("The computer that flies the aircraft: ArduPilot or PX4. They land, return and count battery differently."),
        "reference/autopilots.md",
    ),
    Term(
        say("Speed-up"),
        say("How many times faster than real time a simulated vehicle flies."),
        "guide/fly.md",
    ),
    Term(
        say("Link"),
        say("The connection to the vehicle. A signed link takes no orders from others."),
        "concepts/flying.md",
        (say("Address"),),
    ),
    Term(
        say("RTK"),
        say(
            "Corrections by which GNSS knows its place to centimetres instead of metres. They come from a base "
            "station, over the network by NTRIP: a caster sends those of one mount point."
        ),
        "guide/fly.md#rtk-corrections",
        (say("GNSS"), say("RTK corrections"), say("NTRIP")),
    ),
    Term(
        say("Remote ID"),
        say(
            "What the aircraft broadcasts by radio of itself, its place and its operator, so that others nearby can "
            "tell who flies. It needs a serial number."
        ),
        "guide/fly.md#remote-id",
        (say("Serial number"),),
    ),
    Term(
        say("Operator number"),
        say(
            "The number under which the authority registered the operator. Remote ID broadcasts it without its secret "
            "last three characters, which prove that it was typed right."
        ),
        "guide/fly.md#remote-id",
    ),
    Term(
        say("Geofence"),
        say(
            "A border that the autopilot itself keeps, link or none: where the aircraft would leave it, it returns, "
            "lands or stops."
        ),
        "reference/autopilots.md",
        (say("Geofence on board"), say("Geofence of others")),
    ),
    Term(
        say("Return height"),
        say(
            "The height above take-off at which the aircraft flies straight home when it returns by itself. It must "
            "clear everything that may stand below."
        ),
        "reference/autopilots.md",
    ),
    Term(
        say("Geo-zone"),
        say(
            "An area in which the authority forbids flying or asks for an authorisation, within heights and times. Its "
            "file comes from the publisher."
        ),
        "concepts/zones.md",
        (say("Geo-zones"), say("File of geo-zones")),
    ),
    Term(
        say("Flight geography"),
        say("SORA: the space in which the flight is meant to stay."),
        "guide/mission.md#ground-risk",
    ),
    Term(
        say("Contingency volume"),
        say(
            "SORA: the space around the flight geography in which a flight that left it is brought back. Reaction, "
            "braking and errors of the place make it wide."
        ),
        "guide/mission.md#ground-risk",
        (say("Reaction"), say("Braking tilt"), say("GNSS error"), say("Position hold error"), say("Map error")),
    ),
    Term(
        say("Ground-risk buffer"),
        say("SORA: the ground beyond the contingency volume that the aircraft may hit when it falls out of that."),
        "guide/mission.md#ground-risk",
        (say("Buffer"),),
    ),
    Term(
        say("Ground risk class (iGRC)"),
        say(
            "SORA: 1 to 10, by Table 1 of AMC1 Article 11, from who is below, and the aircraft's dimension and full "
            "speed. M1 and M2 (Table 5) lower it to the final class."
        ),
        "guide/mission.md#ground-risk",
        (say("People below"), say("Largest dimension"), say("Full speed")),
    ),
    Term(
        say("M1 and M2"),
        say(
            "SORA: what lessens the ground risk. M1: fewer people are exposed, by shelter, place and time, or an "
            "observer. M2: the impact is softer."
        ),
        "guide/mission.md#ground-risk",
        (say("M1(A) sheltering"), say("M1(B) restrictions"), say("M1(C) ground observation"), say("M2 softer impact")),
    ),
    Term(
        say("Exposure"),
        say(
            "How much light a photo gets, by shutter time, aperture and ISO. A model needs the same for all photos of "
            "a sortie."
        ),
        "concepts/photos.md#camera-settings",
        (say("Exposure compensation"),),
    ),
    Term(
        say("Shutter time"),
        say(
            "How long the sensor gathers light. Short times blur less in flight. A mechanical shutter takes the "
            "picture at once; an electronic one line by line, which skews what is passed."
        ),
        "concepts/photos.md#camera-settings",
        (say("Shutter"),),
    ),
    Term(
        say("Aperture"),
        say("Width of the lens as an f-number. A larger number lets less light in, and is sharp over more distances."),
        "concepts/photos.md#camera-settings",
    ),
    Term(
        say("ISO"),
        say("Sensitivity of the sensor. Twice the number needs half the light, and has more noise."),
        "concepts/photos.md#camera-settings",
    ),
    Term(
        say("White balance"),
        say(
            "Which light counts as white. Fixed, as at 5500 K for daylight, all photos of a sortie show a colour alike."
        ),
        "concepts/photos.md#camera-settings",
        (say("Colour temperature"),),
    ),
    Term(
        say("Focus"),
        say("The distance that is sharpest. It is locked for a sortie, for glass misleads an automatic one."),
        "concepts/photos.md#camera-settings",
        (say("Focus distance"),),
    ),
    Term(
        say("Pose"),
        say("Where a photo was taken, and in which direction the camera looked."),
        "concepts/photos.md",
        (say("Refine poses"), say("Own poses")),
    ),
    Term(
        say("Data set"),
        say("Photos with their poses, and the panels of the site: what a model learns from."),
        "guide/reconstruct.md",
    ),
    Term(
        say("Splat"),
        say("A small blurred ellipse in space. A model is made of many, and of the light that panes mirror."),
        "concepts/splats.md",
        (say("Layer"),),
    ),
    Term(
        say("Radiance grid"),
        say(
            "What panes mirror, learned as a scene behind the glass: near things move in it as real ones do. It is "
            "stored in cells of a grid."
        ),
        "decisions/radiance-grid.md",
        (say("Mirrored light is learned as"),),
    ),
    Term(
        say("Effects"),
        say("What is simulated because this scene calls for it; each says how large it is, why, and what it costs."),
        "decisions/effects.md",
    ),
)


def terms_by_word(say_in: Callable[[Message], str]) -> dict[str, Term]:
    """Terms by all of their words in a language, in small letters; `say_in` puts a message into it."""
    return {say_in(word).casefold(): term for term in TERMS for word in (term.name, *term.also)}
