"""Editing a plan by hand: viewpoints are moved, added, deleted, locked; route, coverage and checks follow at once."""

from planning.revision.edits import add, aim_at, delete, lock, move, next_id, unlock
from planning.revision.revision import Revision, revise

__all__ = ["Revision", "add", "aim_at", "delete", "lock", "move", "next_id", "revise", "unlock"]
