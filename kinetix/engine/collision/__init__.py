"""Collision detection: `find_contacts`, a table of pairs of shapes behind it."""

from kinetix.engine.collision.crossing import share_of_way
from kinetix.engine.collision.driver import find_contacts
from kinetix.engine.collision.points import FEATURES, Found, Points, Slots

__all__ = ["FEATURES", "Found", "Points", "Slots", "find_contacts", "share_of_way"]
