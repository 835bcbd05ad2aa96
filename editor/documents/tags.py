"""Tags of a level, of what people type for them."""

import re
import unicodedata
from typing import Final

from kinetix.level.model import MAX_TAG

_TAG: Final = re.compile(rf"[a-z0-9_-]{{1,{MAX_TAG}}}")


def tags_of(typed: str) -> tuple[list[str], list[str]]:
    """Return the tags, each once, and the words of which none can be made.

    Capitals become small letters and accents go; spaces, commas and semicolons lie between tags.

    Args:
        typed: What somebody typed.
    """
    tags: dict[str, None] = {}
    refused = []
    for word in re.split(r"[\s,;]+", typed):
        plain = unicodedata.normalize("NFKD", word.lstrip("#")).lower()
        tag = "".join(letter for letter in plain if not unicodedata.combining(letter))
        if _TAG.fullmatch(tag):
            tags[tag] = None
        elif word:
            refused.append(word)
    return list(tags), refused
