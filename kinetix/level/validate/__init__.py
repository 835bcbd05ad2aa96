"""Problems of a level as a whole: what `kinetix validate` and the editor's problem list show.

../README.md lists the codes, and which of them `save_level` refuses. A level of 50
entities takes well below 5 ms, so that the list can follow every edit.
"""

from kinetix.level.model import BodyReference, Level
from kinetix.level.validate.angles import angle_issues
from kinetix.level.validate.issue import Issue, Severity, describe, has_errors
from kinetix.level.validate.pairs import MOST_OVERLAPS, pair_issues
from kinetix.level.validate.parts import (
    control_issues,
    joint_issues,
    reference_issues,
    role_issues,
    size_issues,
)
from kinetix.level.validate.placed import MAX_SHAPE_SIZE, place_issues, placed_bodies
from kinetix.level.validate.solution import solution_issues
from kinetix.level.validate.values import identity_issues, value_issues

__all__ = [
    "MAX_SHAPE_SIZE",
    "MOST_OVERLAPS",
    "Issue",
    "Severity",
    "describe",
    "has_errors",
    "validate",
    "value_issues",
]


def validate(level: Level) -> tuple[Issue, ...]:
    """Return all static problems of a level, errors first, in the order of their codes."""
    issues = list(value_issues(level))
    # Geometry of numbers that are not finite, or of missing corners, means nothing.
    broken: set[BodyReference] = {reference for issue in issues for reference in issue.ids}
    for check in (
        identity_issues,
        reference_issues,
        size_issues,
        control_issues,
        angle_issues,
        solution_issues,
    ):
        issues += check(level)
    placed = placed_bodies(level, broken)
    issues += role_issues(level, placed)
    issues += joint_issues(level, placed, broken)
    issues += pair_issues(level, placed)
    issues += place_issues(level, placed)
    return tuple(sorted(issues, key=lambda issue: issue.code))
