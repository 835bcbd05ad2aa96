"""A film, or two side by side, as one HTML file that needs nothing else."""

import html
import importlib.resources
import json
import re
from collections.abc import Sequence
from typing import Final

from kinetix.level.codec import level_hash
from kinetix.pages.film import Film, packed, scene_of

MOST_FILMS: Final = 2
"""Players beside each other."""


def page_of(films: Sequence[Film]) -> str:
    """Return a self-contained page that plays episodes of a level.

    Args:
        films: One episode, or two that are played side by side.

    Raises:
        ValueError: `films` is empty or too long.
    """
    if not 1 <= len(films) <= MOST_FILMS:
        raise ValueError(f"films: expected 1 or {MOST_FILMS}, got {len(films)}")
    level = films[0].level
    if len({level_hash(film.level) for film in films}) > 1:
        raise ValueError("films: expected episodes of the same level")
    content = {"scene": scene_of(level), "films": [packed(film) for film in films]}
    # Inside a script element nothing may look like its end.
    data = json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    template = _asset("player.html")
    parts = {
        "title": html.escape(level.name or "Episode"),
        "style": _asset("player.css"),
        "script": _asset("player.js"),
        "data": data,
    }
    # In one pass: a name may look like a mark itself.
    return re.sub(r"\{\{(\w+)\}\}", lambda mark: parts[mark[1]], template)


def _asset(name: str) -> str:
    return importlib.resources.files("kinetix.pages").joinpath(name).read_text(encoding="utf-8")
