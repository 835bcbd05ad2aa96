"""The mouse pulls at a body of an episode, or carries it elsewhere."""

import dataclasses
from typing import Any, Final

import numpy as np

from editor.documents.commands.rigid import component
from editor.worker.requests import (
    Pull,
)
from kinetix.environment.state import EnvState
from kinetix.level.model import Level
from kinetix.pytree import on_device

PULL_RATE: Final = 8.0
"""A pulled point wants to close this share of its distance to the mouse per second [1/s]."""
PULL_SPEED: Final = 15.0
"""… but never faster than this [m/s]."""
PULL_SHARE: Final = 0.5
"""Share of the missing velocity that one step gives: below 1 the spring is soft."""


def pulled(state: EnvState, slots: np.ndarray, level: Level, pull: Pull) -> EnvState:
    """Give the pulled body the impulse that draws the grabbed point to the mouse.

    The point shall move at a speed in proportion to its distance; the impulse is what changes the
    point's velocity by a share of what is missing, through the body's mass matrix at that point.
    """
    rows = [k for k, body in enumerate(level.bodies) if body.id == pull.body]
    if not rows:
        return state
    slot = int(slots[rows[0]])
    physics = state.physics
    position = np.asarray(physics.position)[slot]
    if pull.teleport:
        return _teleported(state, slots, level, pull)
    angle = float(physics.rotation[slot])
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = pull.anchor
    arm = np.array([cos * x - sin * y, sin * x + cos * y])
    spin = float(physics.angular_velocity[slot])
    velocity = np.asarray(physics.velocity)[slot].astype(float)
    point_velocity = velocity + spin * np.array([-arm[1], arm[0]])
    wanted = (np.array(pull.target) - position - arm) * PULL_RATE
    speed = float(np.linalg.norm(wanted))
    wanted *= min(1.0, PULL_SPEED / max(speed, 1e-9))
    inverse_mass = float(state.world.bodies.inverse_mass[slot])
    inverse_inertia = float(state.world.bodies.inverse_inertia[slot])
    across = np.array([-arm[1], arm[0]])
    compliance = inverse_mass * np.eye(2) + inverse_inertia * np.outer(across, across)
    if inverse_mass == 0.0:
        return state
    impulse = np.linalg.solve(compliance, (wanted - point_velocity) * PULL_SHARE)
    turned = spin + inverse_inertia * float(arm[0] * impulse[1] - arm[1] * impulse[0])
    return _with_row(
        state,
        slot,
        velocity=(velocity + inverse_mass * impulse).astype(np.float32),
        angular_velocity=np.float32(turned),
    )


def _teleported(state: EnvState, slots: np.ndarray, level: Level, pull: Pull) -> EnvState:
    """Put a body's origin where the mouse is, with all bodies joined to it, at rest."""
    moved = component(level, (pull.body,))
    rows = [k for k, body in enumerate(level.bodies) if body.id in moved]
    held = next(k for k, body in enumerate(level.bodies) if body.id == pull.body)
    position = np.array(state.physics.position)
    shift = np.array(pull.target, np.float32) - position[slots[held]]
    position[slots[rows]] += shift
    changed = {"position": position}
    for name in ("velocity", "angular_velocity"):
        changed[name] = np.array(getattr(state.physics, name))
        changed[name][slots[rows]] = 0.0
    return _with(state, changed)


def _with_row(state: EnvState, slot: int, **rows: Any) -> EnvState:
    changed = {}
    for name, row in rows.items():
        changed[name] = np.array(getattr(state.physics, name))
        changed[name][slot] = row
    return _with(state, changed)


def _with(state: EnvState, changed: dict[str, np.ndarray]) -> EnvState:
    physics = dataclasses.replace(state.physics, **on_device(changed))
    return dataclasses.replace(state, physics=physics)
