"""Editing a plan by hand: viewpoints are moved, added, deleted, locked; route, coverage and checks follow at once."""

from planning.revision.edits import Revision, add, aim_at, delete, lock, move, next_id, revise, unlock

__all__ = ["Revision", "add", "aim_at", "delete", "lock", "move", "next_id", "revise", "unlock"]
