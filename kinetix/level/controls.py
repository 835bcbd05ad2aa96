"""The controls that a level has: which motors and thrusters each entry of an action drives."""

from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level


def driven_by(level: Level, channel: int) -> tuple[int, ...]:
    """Return the ids of the joints or thrusters that an entry of a multi-discrete action drives.

    Args:
        level: The level.
        channel: Motor bindings from 0, then thruster bindings.
    """
    if channel >= MOTOR_BINDINGS:
        binding = channel - MOTOR_BINDINGS
        return tuple(t.id for t in level.thrusters if t.binding == binding)
    return tuple(
        joint.id
        for joint in level.joints
        if joint.kind == "revolute"
        and joint.motor is not None
        and joint.motor.on
        and not joint.motor.auto
        and joint.motor.binding == channel
    )


def names_driven_by(level: Level, channel: int) -> tuple[str, ...]:
    """Return the names of what an entry of an action drives, of those that have one."""
    driven = (level.entity(number) for number in driven_by(level, channel))
    return tuple(entity.name for entity in driven if entity.name)


def channels_in_use(level: Level) -> tuple[int, ...]:
    """Return the entries of a multi-discrete action that drive anything in a level."""
    return tuple(k for k in range(MOTOR_BINDINGS + THRUSTER_BINDINGS) if driven_by(level, k))
