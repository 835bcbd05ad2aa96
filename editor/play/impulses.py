"""Impulses of contacts and joints on bodies in a step: from momentum, whatever the solver."""

from collections.abc import Sequence

from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Snapshot
from kinetix.level.geometry import inverse_mass, rotate
from kinetix.level.model import Level, Point

THRUST: float = 10.0
"""Force of a thruster of power 1 at full action [N]."""


def received_impulses(level: Level, before: Snapshot, after: Snapshot) -> list[Point | None]:
    """The impulse that each body got from contacts, joints and motors in one environment step.

    That is its change of momentum without what gravity and its thrusters did, so it is the same
    quantity under every solver. Thrusters are taken at the later angle of their body.

    Args:
        level: What is played.
        before: The moment before.
        after: The moment after, one step later.

    Returns:
        For every body of the level x and y [N s]; None for fixed ones.
    """
    seconds = after.frame_skip / ENGINE_STEPS_PER_SECOND
    index = {body.id: k for k, body in enumerate(level.bodies)}
    pushes = [(0.0, 0.0)] * len(level.bodies)
    for thruster, drive in zip(level.thrusters, after.thruster.tolist(), strict=True):
        k = index.get(thruster.body)
        if k is None:
            continue
        strength = THRUST * thruster.power * drive * seconds
        x, y = rotate((strength, 0.0), float(after.angle[k]) + thruster.angle)
        pushes[k] = (pushes[k][0] + x, pushes[k][1] + y)
    return [
        None if body.fixed else _received(level, k, before, after, pushes[k], seconds)
        for k, body in enumerate(level.bodies)
    ]


def _received(
    level: Level,
    index: int,
    before: Snapshot,
    after: Snapshot,
    push: Point,
    seconds: float,
) -> Point:
    mass = 1.0 / inverse_mass(level.bodies[index], level.inertia_model)[0]
    gained: Sequence[float] = (after.velocity[index] - before.velocity[index]).tolist()
    return (
        mass * (gained[0] - level.gravity[0] * seconds) - push[0],
        mass * (gained[1] - level.gravity[1] * seconds) - push[1],
    )
