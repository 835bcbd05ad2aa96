"""Collision detection: `find_contacts`, a table of pairs of shapes behind it."""

from kinetix.engine.collision.driver import find_contacts
from kinetix.engine.collision.points import FEATURES, Found, Points, Slots
from kinetix.engine.collision.tunnelling import held_by_walls

__all__ = ["FEATURES", "Found", "Points", "Slots", "find_contacts", "held_by_walls"]
