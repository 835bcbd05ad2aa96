"""One problem of a level, and its message."""

import dataclasses
from typing import Literal

from kinetix.level.model import Body, BodyReference, Entity, Joint, Polygon

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
    if entity is None:
        return f"entity {reference}"
    return entity.name or plain_name(entity)


def plain_name(entity: Entity) -> str:
    """Return what an entity without a name is called; any four corners are a rectangle."""
    kind = "thruster"
    if isinstance(entity, Joint):
        kind = "weld" if entity.kind == "fixed" else "joint"
    elif isinstance(entity, Body):
        kind = "circle"
        if isinstance(entity.shape, Polygon):
            kind = "triangle" if len(entity.shape.vertices) == 3 else "rectangle"
        if entity.role != "none":
            kind = f"{entity.role} {kind}"
    return f"{kind} {entity.id}"


def capital(text: str) -> str:
    """Return it with its first letter large."""
    return text[:1].upper() + text[1:]
