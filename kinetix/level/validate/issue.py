"""One problem of a level, and its message."""

import dataclasses
from typing import Literal

from kinetix.level.model import Body, BodyReference, Entity, Joint, Polygon, Thruster

Severity = Literal["error", "warning", "info"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Issue:
    """One problem of a level."""

    code: str
    severity: Severity
    path: str
    """JSON path of what it is about, `$` for the whole level."""
    message: str
    """One sentence for people."""
    ids: tuple[BodyReference, ...] = ()
    """The entities that it is about: ids, or names of arena bodies."""
    fix: str = ""
    """Label of the button that mends it; empty where nothing can be offered."""


def has_errors(issues: tuple[Issue, ...]) -> bool:
    """Return whether any of the issues is an error."""
    return any(issue.severity == "error" for issue in issues)


def issue(
    code: str, message: str, *, path: str = "$", ids: tuple[BodyReference, ...] = (), fix: str = ""
) -> Issue:
    """Make a problem; its code has the severity: E… or W…."""
    severities: dict[str, Severity] = {"E": "error", "W": "warning"}
    return Issue(
        code=code, severity=severities[code[0]], path=path, message=message, ids=ids, fix=fix
    )


def describe(reference: BodyReference, entity: Entity | None = None) -> str:
    """Return its own name, or what it is: `green circle 4`, `weld 8`, `the left wall`."""
    if isinstance(reference, str):
        return f"the {reference.replace('_', ' ')}"
    if entity is not None and entity.name:
        return entity.name
    kind = "entity"
    if isinstance(entity, Body):
        kind = _shape_word(entity)
    elif isinstance(entity, Joint):
        kind = "weld" if entity.kind == "fixed" else "joint"
    elif isinstance(entity, Thruster):
        kind = "thruster"
    return f"{kind} {reference}"


def _shape_word(body: Body) -> str:
    """Role and shape; any four corners are called a rectangle."""
    noun = "circle"
    if isinstance(body.shape, Polygon):
        noun = "triangle" if len(body.shape.vertices) == 3 else "rectangle"
    return noun if body.role == "none" else f"{body.role} {noun}"


def capital(text: str) -> str:
    """Return it with its first letter large."""
    return text[:1].upper() + text[1:]
