"""The route of an edited plan: legs between stops that stay neighbours stay as they are, the others are found anew."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

from planning.geo.frames import Vec3
from planning.motion.sortie_timing import photo_vertices
from planning.plan import Sortie, Viewpoint
from planning.revision.ways import HOME, Place, Ways

Viewpoints = Mapping[str, Viewpoint]
"""By identifier."""

Neighbours = tuple[str, str]
"""Identifiers of two stops in a row; home has `AT_HOME`."""

AT_HOME = ""


def pieces(sortie: Sortie, by_id: Viewpoints) -> dict[Neighbours, tuple[Vec3, ...]]:
    """Vertices from each stop of a sortie to the next, both included; empty where its path misses a viewpoint."""
    vertices = cuts(sortie, by_id)
    if vertices is None:
        return {}
    return {
        pair: sortie.path_enu_m[start : end + 1]
        for pair, (start, end) in zip(neighbours(sortie.viewpoint_ids), itertools.pairwise(vertices), strict=True)
    }


def cuts(sortie: Sortie, by_id: Viewpoints) -> list[int] | None:
    """Vertices of a sortie's path at which it is at a stop, its ends included; None where it misses a viewpoint."""
    vertices = photo_vertices(sortie, by_id)
    if vertices is None or len(sortie.path_enu_m) < 2:
        return None
    return [0, *vertices.tolist(), len(sortie.path_enu_m) - 1]


def neighbours(viewpoint_ids: Sequence[str]) -> list[Neighbours]:
    """Pairs of stops in a row, from home to home."""
    return list(itertools.pairwise((AT_HOME, *viewpoint_ids, AT_HOME)))


def place_of(stop: str, by_id: Viewpoints) -> Place:
    """Where a stop is."""
    return HOME if stop == AT_HOME else by_id[stop].position_enu_m


def redrawn(
    sortie: Sortie, before: Viewpoints, viewpoint_ids: tuple[str, ...], after: Viewpoints, ways: Ways
) -> Sortie:
    """A sortie with other stops, or with stops elsewhere; length and duration are still those it had.

    Parameters
    ----------
    before, after
        Viewpoints as they were and as they are.
    """
    pairs = neighbours(viewpoint_ids)
    known = pieces(sortie, before)
    is_moved = {
        stop
        for stop in viewpoint_ids
        if stop not in before or before[stop].position_enu_m != after[stop].position_enu_m
    }
    missing = [pair for pair in pairs if pair not in known or not is_moved.isdisjoint(pair)]
    found = ways.between([(place_of(a, after), place_of(b, after)) for a, b in missing])
    legs = {**known, **dict(zip(missing, found, strict=True))}
    path = [*legs[pairs[0]], *itertools.chain.from_iterable(legs[pair][1:] for pair in pairs[1:])]
    passing = tuple(each for each in sortie.in_passing_ids if each in viewpoint_ids and each not in is_moved)
    return Sortie(viewpoint_ids, tuple(path), sortie.length_m, sortie.duration_s, passing)
