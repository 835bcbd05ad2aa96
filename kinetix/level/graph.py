"""Jointed components of a level."""

from collections.abc import Iterable

from kinetix.level.model import Body, BodyReference, Joint, Level


def components(joints: Iterable[Joint]) -> dict[BodyReference, BodyReference]:
    """For every jointed body a representative of its component; arena and fixed bodies connect.

    Bodies of one component never push each other. Bodies without joints are left out.

    Args:
        joints: All of a level; of welds alone those that hold still against each other.
    """
    parents: dict[BodyReference, BodyReference] = {}

    def root(reference: BodyReference) -> BodyReference:
        while parents.setdefault(reference, reference) != reference:
            reference = parents[reference]
        return reference

    for joint in joints:
        parents[root(joint.b)] = root(joint.a)
    return {reference: root(reference) for reference in tuple(parents)}


def pieces(level: Level, joints: Iterable[Joint]) -> list[list[int]]:
    """Sort the bodies of a level into those that hang together; a body without a joint is one.

    Args:
        level: Its bodies, without the arena's.
        joints: By which they hang together.

    Returns:
        Ids, in the level's order.
    """
    component = components(joints)
    found: dict[BodyReference, list[int]] = {}
    for body in level.bodies:
        found.setdefault(component.get(body.id, body.id), []).append(body.id)
    return list(found.values())


def may_push(
    a: tuple[BodyReference, Body],
    b: tuple[BodyReference, Body],
    component: dict[BodyReference, BodyReference],
) -> bool:
    """Return whether two bodies can ever push each other.

    Args:
        a: Reference and body.
        b: Reference and body.
        component: From `components`.
    """
    if a[1].fixed and b[1].fixed:
        return False
    if a[0] in component and b[0] in component and component[a[0]] == component[b[0]]:
        return False
    return modes_meet(a[1], b[1])


def modes_meet(a: Body, b: Body) -> bool:
    """Return whether the collision modes of two bodies let them touch at all."""
    modes = {a.collision, b.collision}
    return "always" in modes or modes == {"normal"}
