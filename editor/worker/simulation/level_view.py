"""States of a level as numpy arrays, in the order of its entities."""

import dataclasses
from typing import Any

import numpy as np

from editor.base.controls import NOOP
from editor.worker.simulation.cast import Step
from editor.worker.simulation.contacts import (
    contact_points,
    deepest,
    pushing_pairs,
    touching_bodies,
)
from editor.worker.snapshots import Mind, Snapshot
from kinetix.engine.spec import Capacity
from kinetix.environment.goal import BLUE, GREEN
from kinetix.environment.outcome import Outcome
from kinetix.environment.state import EnvState
from kinetix.level.geometry import body_mass
from kinetix.level.model import THRUSTER_BINDINGS, Level
from kinetix.level.slots import body_slots


class LevelView:
    """Tells states of a level in the order of its entities."""

    def __init__(self, level: Level, capacity: Capacity, slots: np.ndarray | None = None) -> None:
        """Look at a level.

        Args:
            level: The level.
            capacity: Sizes of the states.
            slots: Where each body is in the states; None: where compiling puts it.
        """
        if slots is None:
            found = body_slots(level, capacity)
            slots = np.array([found[body.id] for body in level.bodies], np.int32)
        self.slots = slots
        self._level = level
        self._capacity = capacity
        masses = [body_mass(body, level.inertia_model) for body in level.bodies]
        self._mass = np.array(masses, np.float64).reshape(-1, 2)
        self._pushing = pushing_pairs(level)
        self._free = np.array([not body.fixed for body in level.bodies], bool)

    def first(self, state: EnvState, frame_skip: int) -> Snapshot:
        """Return the snapshot of a first state."""
        unified = np.zeros(len(NOOP), np.float32)
        told = self._told(state, unified, frame_skip)
        return dataclasses.replace(told, action=(), distance=goal_distance(state))

    def after(
        self,
        before: Snapshot,
        step: Step,
        *,
        outcome: Outcome | None,
        mind: Mind | None = None,
        memory: Any = None,
        milliseconds: float = 0.0,
        contacts: bool = False,
    ) -> Snapshot:
        """Return the snapshot after a step."""
        info = step.info
        reward = float(info["reward"])
        told = dataclasses.replace(
            self._told(step.state, np.asarray(step.unified), before.frame_skip),
            reward=reward,
            total_reward=before.total_reward + reward,
            distance=float(info["distance"]),
            dropped=before.dropped + bool(info.get("overflow", False)),
            outcome=outcome,
            milliseconds=milliseconds,
            tailored=before.tailored,
            quick=before.quick,
            mind=mind,
            memory=memory,
        )
        if not contacts:
            return told
        pairs = touching_bodies(
            self._level,
            self._capacity,
            np.asarray(step.state.physics.touching),
            self._pushing,
        )
        points = contact_points(self._level, told, pairs)
        return dataclasses.replace(
            told, contacts=points, touching=pairs, penetration=deepest(points)
        )

    def _told(self, state: EnvState, unified: np.ndarray, frame_skip: int) -> Snapshot:
        level, physics = self._level, state.physics
        position = np.asarray(physics.position)[self.slots]
        velocity = np.asarray(physics.velocity)[self.slots]
        spin = np.asarray(physics.angular_velocity)[self.slots]
        return Snapshot(
            step=int(state.timestep),
            position=position,
            angle=np.asarray(physics.rotation)[self.slots],
            velocity=velocity,
            angular_velocity=spin,
            motor=motor_drives(level, unified),
            thruster=thruster_drives(level, unified),
            action=tuple(unified.tolist()),
            frame_skip=frame_skip,
            state=state,
            **self._energies(position, velocity, spin),
        )

    def _energies(
        self, position: np.ndarray, velocity: np.ndarray, spin: np.ndarray
    ) -> dict[str, Any]:
        mass, inertia = self._mass[:, 0] * self._free, self._mass[:, 1] * self._free
        kinetic = 0.5 * np.sum(mass * np.sum(velocity**2, axis=1)) + 0.5 * np.sum(inertia * spin**2)
        potential = -np.sum(mass * (position @ np.array(self._level.gravity)))
        px, py = mass @ velocity
        return {
            "kinetic_energy": float(kinetic),
            "potential_energy": float(potential),
            "momentum": (float(px), float(py)),
        }


def motor_drives(level: Level, unified: np.ndarray) -> np.ndarray:
    """Return the drive of each joint's motor, −1 … 1; 0 where there is none."""
    drives = np.zeros(len(level.joints), np.float32)
    for k, joint in enumerate(level.joints):
        if joint.kind == "revolute" and joint.motor is not None and joint.motor.on:
            drives[k] = 1.0 if joint.motor.auto else unified[joint.motor.binding]
    return drives


def thruster_drives(level: Level, unified: np.ndarray) -> np.ndarray:
    """Return the drive of each thruster, 0 … 1."""
    first = len(unified) - THRUSTER_BINDINGS
    return np.array([unified[first + t.binding] for t in level.thrusters], np.float32)


def goal_distance(state: EnvState) -> float:
    """Return the distance that a step would report, of a state before the first step [m].

    Of NumPy's arrays: to compile the environment's function would hold the first picture up.
    """
    role = np.where(state.world.bodies.active, state.labels.role, 0)
    position = np.asarray(state.physics.position)
    gaps = position[role == GREEN][:, None] - position[role == BLUE][None]
    return float(np.linalg.norm(gaps, axis=-1).sum())
