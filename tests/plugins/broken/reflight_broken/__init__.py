"""Plug-ins with every mistake: one cannot be imported, one fails at work, one takes a name, one is no format."""

from groundstation.api import MissionFormat


def encode(plan, missions, options):
    return missions[0].no_such_attribute


FAILING = MissionFormat((".failing",), encode)
NUMBER = 7
