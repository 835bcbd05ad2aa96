"""Problems of levels with their places in the files, kinetix-env's own paths included."""

import dataclasses

from kinetix.errors import LevelError
from kinetix.level.codec import load_document
from kinetix.level.kinetix_env.document import KinetixEnvDocument
from kinetix.level.kinetix_env.json_paths import peer_path, peer_places
from kinetix.level.model import Level
from kinetix.level.sets.manifest import SetLevel
from kinetix.level.validate import Issue, validate


def issues_in_file(level: Level, source: KinetixEnvDocument | None) -> tuple[Issue, ...]:
    """Return the problems of a level, each with its path in the level's file.

    Args:
        level: Any level.
        source: kinetix-env's file, where the level came from one.
    """
    issues = validate(level)
    if source is None or not issues:
        return issues
    places = peer_places(source)
    return tuple(dataclasses.replace(one, path=peer_path(one.path, places)) for one in issues)


def set_level_issues(each: SetLevel) -> tuple[Issue, ...]:
    """Return the problems of a level of a set, each with its path in the level's file."""
    source = None
    if each.path is not None and not each.native:
        try:
            source = load_document(each.path).source
        except LevelError:  # gone since it was read: the document's places are left
            source = None
    return issues_in_file(each.level, source)
