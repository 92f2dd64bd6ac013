"""Titles and tool tips of declared parameters, for Qt Linguist.

Written by `make docs` (`python -m tests.docs`); do not edit by hand.
"""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

TEXTS = (
    QT_TRANSLATE_NOOP("Parameters", "Method"),
    QT_TRANSLATE_NOOP("Parameters", "how views are chosen"),
    QT_TRANSLATE_NOOP("Parameters", "Views"),
    QT_TRANSLATE_NOOP("Parameters", "number of views"),
    QT_TRANSLATE_NOOP("Parameters", "Coverage"),
    QT_TRANSLATE_NOOP("Parameters", "share of what can be covered, 0 to 1, with as few views as possible"),
    QT_TRANSLATE_NOOP("Parameters", "Batteries"),
    QT_TRANSLATE_NOOP("Parameters", "number of sorties: as much as can be covered within them"),
    QT_TRANSLATE_NOOP("Parameters", "Aircraft"),
    QT_TRANSLATE_NOOP("Parameters", "aircraft and camera, or a .toml file with your own"),
    QT_TRANSLATE_NOOP("Parameters", "Safety distance"),
    QT_TRANSLATE_NOOP("Parameters", "of every view and path to everything solid"),
    QT_TRANSLATE_NOOP("Parameters", "Section step"),
    QT_TRANSLATE_NOOP("Parameters", "width of the hemisphere sections"),
    QT_TRANSLATE_NOOP("Parameters", "Count whole panels only"),
    QT_TRANSLATE_NOOP(
        "Parameters", "a view counts only when all four corners of a panel are in the picture, not just its middle"
    ),
    QT_TRANSLATE_NOOP("Parameters", "Wanted pixel"),
    QT_TRANSLATE_NOOP(
        "Parameters",
        "each direction of view is wanted with pixels up to this size on the panel; those seen only more coarsely are"
        " counted and named",
    ),
    QT_TRANSLATE_NOOP("Parameters", "Battery reserve"),
    QT_TRANSLATE_NOOP("Parameters", "part of the battery that is left at landing"),
    QT_TRANSLATE_NOOP("Parameters", "Hover before photo"),
    QT_TRANSLATE_NOOP("Parameters", "hover between the end of all turning and the shutter"),
    QT_TRANSLATE_NOOP("Parameters", "Wind"),
    QT_TRANSLATE_NOOP("Parameters", "steady wind that is expected, from the worst direction"),
    QT_TRANSLATE_NOOP("Parameters", "Weight sections by solid angle"),
    QT_TRANSLATE_NOOP("Parameters", "weight hemisphere sections by their solid angle instead of equally"),
    QT_TRANSLATE_NOOP("Parameters", "Precision"),
    QT_TRANSLATE_NOOP("Parameters", "of the coverage kernel"),
    QT_TRANSLATE_NOOP("Parameters", "single (fast)"),
    QT_TRANSLATE_NOOP("Parameters", "double (slower)"),
    QT_TRANSLATE_NOOP("Parameters", "Seed"),
    QT_TRANSLATE_NOOP("Parameters", "of everything random"),
    QT_TRANSLATE_NOOP("Parameters", "Time to plan"),
    QT_TRANSLATE_NOOP(
        "Parameters", "longest wall time for the whole plan; the search ends earlier when it finds nothing more"
    ),
    QT_TRANSLATE_NOOP("Parameters", "mean wind at the height of a mast (6 m)"),
    QT_TRANSLATE_NOOP("Parameters", "Wind from"),
    QT_TRANSLATE_NOOP("Parameters", "where the wind comes from, clockwise from north"),
    QT_TRANSLATE_NOOP("Parameters", "GNSS"),
    QT_TRANSLATE_NOOP("Parameters", "what the GNSS receiver reaches under open sky"),
    QT_TRANSLATE_NOOP("Parameters", "RTK fixed"),
    QT_TRANSLATE_NOOP("Parameters", "RTK float"),
    QT_TRANSLATE_NOOP("Parameters", "without RTK"),
    QT_TRANSLATE_NOOP("Parameters", "Colours"),
    QT_TRANSLATE_NOOP(
        "Parameters",
        "what panels mirror is baked into their colours, for programs that mirror nothing, or panels have their own",
    ),
    QT_TRANSLATE_NOOP("Parameters", "with what panels mirror"),
    QT_TRANSLATE_NOOP("Parameters", "panels' own colours"),
    QT_TRANSLATE_NOOP("Parameters", "Degree of colours"),
    QT_TRANSLATE_NOOP("Parameters", "of the harmonics by which colours depend on the direction"),
    QT_TRANSLATE_NOOP("Parameters", "File size"),
    QT_TRANSLATE_NOOP("Parameters", "of spz, spz-4, sog and Gaussians that are compressed: how small"),
    QT_TRANSLATE_NOOP("Parameters", "small"),
    QT_TRANSLATE_NOOP("Parameters", "balanced"),
    QT_TRANSLATE_NOOP("Parameters", "fine"),
    QT_TRANSLATE_NOOP("Parameters", "Gaussians"),
    QT_TRANSLATE_NOOP(
        "Parameters",
        "of gltf (by itself numbers) and 3d-tiles (by itself spz): as numbers; compressed, as CesiumJS wants them; or"
        " coloured points in their place",
    ),
    QT_TRANSLATE_NOOP("Parameters", "as numbers"),
    QT_TRANSLATE_NOOP("Parameters", "compressed"),
    QT_TRANSLATE_NOOP("Parameters", "as coloured points"),
    QT_TRANSLATE_NOOP("Parameters", "as the format has it"),
    QT_TRANSLATE_NOOP("Parameters", "Time"),
    QT_TRANSLATE_NOOP("Parameters", "how long one can wait"),
    QT_TRANSLATE_NOOP("Parameters", "10 minutes"),
    QT_TRANSLATE_NOOP("Parameters", "1 hour"),
    QT_TRANSLATE_NOOP("Parameters", "overnight, 10 hours"),
    QT_TRANSLATE_NOOP("Parameters", "what is trained, and how"),
    QT_TRANSLATE_NOOP("Parameters", "Mirrored light is learned as"),
    QT_TRANSLATE_NOOP("Parameters", "what mirrored light is learned with"),
    QT_TRANSLATE_NOOP("Parameters", "as the scene calls for"),
    QT_TRANSLATE_NOOP("Parameters", "none apart from the splats (harmonics)"),
    QT_TRANSLATE_NOOP("Parameters", "far away (environment map)"),
    QT_TRANSLATE_NOOP("Parameters", "network by place and direction (paper)"),
    QT_TRANSLATE_NOOP("Parameters", "near things (radiance grid)"),
    QT_TRANSLATE_NOOP("Parameters", "Compute on"),
    QT_TRANSLATE_NOOP("Parameters", "what to compute on; cuda needs the extra of that name"),
    QT_TRANSLATE_NOOP("Parameters", "the processor"),
)
