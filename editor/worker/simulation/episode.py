"""One episode on the environment: start, advance, restore, tell as numpy."""

import dataclasses
import time
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np

from editor.base.controls import NOOP
from editor.documents.commands.rigid import component
from editor.worker.recording import FRAME_SKIP, Action, Mind, Snapshot, Trace
from editor.worker.requests import (
    Advance,
    Opened,
    PlaySolution,
    Progress,
    Pull,
    Restore,
    StartEpisode,
)
from editor.worker.simulation.cast import AgentDriver, Step
from editor.worker.simulation.contacts import (
    contact_points,
    deepest,
    pushing_pairs,
    touching_bodies,
)
from editor.worker.simulation.stepping import (
    MOVING,
    Stepper,
    best_stepper,
    first_state,
    generic_stepper,
    on_device,
    own_stepper,
)
from kinetix.engine.spec import Capacity
from kinetix.environment.outcome import Outcome, outcome_of
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.geometry import body_mass
from kinetix.level.model import THRUSTER_BINDINGS, Level
from kinetix.level.slots import body_slots

PULL_RATE: Final = 8.0
"""A pulled point wants to close this share of its distance to the mouse per second [1/s]."""
PULL_SPEED: Final = 15.0
"""… but never faster than this [m/s]."""
PULL_SHARE: Final = 0.5
"""Share of the missing velocity that one step gives: below 1 the spring is soft."""


_AT_ONCE: Final = 30
"""Steps of a recorded solution between two reports."""


class HandDriver:
    """A person who plays one episode: every action comes from outside."""

    frame_skip = FRAME_SKIP
    memory = None

    def __init__(self, stepper: Stepper) -> None:
        self.env = stepper.env
        self.capacity = stepper.env.static_env_params.capacity
        self.tailored, self.quick = stepper.tailored, stepper.quick
        self._stepper = stepper

    def remember(self, memory: Any) -> None:
        """Nothing to remember."""

    def warm(self, state: EnvState, step: int) -> None:
        """Do once what a first step does; see `AgentDriver.warm`."""
        jax.block_until_ready(self.step(state, step, NOOP).state)

    def step(self, state: EnvState, step: int, hand: Action | None) -> Step:
        """One environment step; see `AgentDriver.step`."""
        del step
        action = jax.device_put(np.asarray(NOOP if hand is None else hand, np.int32))
        state, info = self._stepper.step(state, action)
        return Step(state=state, info=info, unified=info["unified"])


class Episode:
    """A level being played, from its first step to its last in one and the same compiled step."""

    def __init__(self, request: StartEpisode, progress: Progress, *, judges: bool = False) -> None:
        """Go to the first state.

        Args:
            request: What is played.
            progress: Told how far the compiler is, where something has to be compiled.
            judges: Whether the outcome is to hold elsewhere too: then the step is the one that
                every level of the size shares, as in commands, level sets and evaluations. The one
                for this level alone rounds differently, and what is won by a hair may be lost.
        """
        self.run = request.run
        self._level = request.level
        self._physics = request.physics
        self._quick = request.quick
        self._contacts = request.keep_contacts
        self._driver = self._cast(request, progress, judges=judges)
        self._view = LevelView(request.level, self._driver.capacity)
        self._state = first_state(request.level, self._driver.env.static_env_params)
        since = request.since
        if since is not None:
            step = jnp.asarray(since.step, self._state.timestep.dtype)
            self._state = dataclasses.replace(self._state, timestep=step)
        self._ended = False
        first = self._view.first(jax.device_get(self._state), self._driver.frame_skip)
        driver = self._driver
        self.snapshot = dataclasses.replace(
            first,
            tailored=driver.tailored,
            quick=driver.quick,
            total_reward=since.total_reward if since is not None else 0.0,
            dropped=since.dropped if since is not None else 0,
            memory=since.memory if since is not None else None,
        )
        # What is still to be compiled for a first step is compiled here, not in the game.
        self._driver.warm(self._state, self.snapshot.step)
        self._driver.remember(self.snapshot.memory)

    def _cast(
        self, request: StartEpisode, progress: Progress, *, judges: bool
    ) -> "HandDriver | AgentDriver":
        level, physics = request.level, request.physics
        if request.casting is not None:
            return AgentDriver(level, physics, request.casting, progress, quick=request.quick)
        if judges:
            return HandDriver(generic_stepper(level, physics, progress))
        return HandDriver(best_stepper(level, physics, progress, quick=request.quick))

    def advance(self, request: Advance) -> tuple[Snapshot, ...]:
        """Play steps until the episode ends; a snapshot each.

        Raises:
            KinetixError: The agent's output is NaN.
        """
        snapshots, pull = [], request.pull
        self._contacts = request.keep_contacts
        for action in request.actions:
            if self._ended:
                break
            start = time.perf_counter()
            if pull is not None:
                self._state = pulled(self._state, self._view.slots, self._level, pull)
            taken = self._driver.step(self._state, self.snapshot.step, action)
            told = _fetched(taken, self.snapshot.state)
            milliseconds = (time.perf_counter() - start) * 1e3
            mind = self._mind(told, by_hand=action is not None)
            self._state = taken.state
            self.snapshot = self._view.after(
                self.snapshot,
                told,
                outcome=outcome_of(told.info),
                mind=mind,
                memory=self._driver.memory,
                milliseconds=milliseconds,
                contacts=self._contacts,
            )
            self._ended = self.snapshot.outcome is not None
            snapshots.append(self.snapshot)
        return tuple(snapshots)

    def _mind(self, told: Step, *, by_hand: bool) -> Mind | None:
        if not isinstance(self._driver, AgentDriver):
            return None
        step = self.snapshot.step + 1
        return self._driver.mind(told.thought, by_hand=by_hand, step=step)

    def restore(self, request: Restore, progress: Progress) -> None:
        """Go on from an earlier snapshot, in the kind of step that it was made with."""
        snapshot = request.snapshot
        self._state = on_device(snapshot.state)
        of_hand = isinstance(self._driver, HandDriver)
        if of_hand and self._driver.tailored != snapshot.tailored:
            # It is from a recorded solution, or from an episode that began before this step was
            # ready: what is played on from there belongs to the same run.
            level, physics = self._level, self._physics
            self._driver = HandDriver(
                own_stepper(level, physics, progress, quick=self._quick)
                if snapshot.tailored
                else generic_stepper(level, physics, progress)
            )
        self._driver.remember(snapshot.memory)
        self._ended = snapshot.outcome is not None
        self.snapshot = snapshot


def _fetched(taken: Step, before: EnvState) -> Step:
    """A step as numpy arrays; what the level fixes is taken from the state before."""
    moved = {name: getattr(taken.state, name) for name in MOVING}
    rest = (taken.info, taken.unified, taken.thought)
    moved, (info, unified, thought) = jax.device_get((moved, rest))
    state = dataclasses.replace(before, **moved)
    return Step(state=state, info=info, unified=unified, thought=thought)


def play_solution(request: PlaySolution, progress: Progress) -> Opened:
    """Play the recorded solution of a level and keep every moment.

    Raises:
        KinetixError: There is none, or it holds its actions for another number of engine steps.
    """
    level, solution = request.level, request.level.solution
    if solution is None:
        raise KinetixError(f"{level.name} has no recorded solution.")
    if solution.frame_skip != FRAME_SKIP:
        raise KinetixError(
            f"The solution of {level.name} holds each action for {solution.frame_skip} engine "
            f"steps; the editor plays {FRAME_SKIP}."
        )
    progress.report(None, "Compiling the level")
    start = StartEpisode(run=0, level=level, physics=solution.physics, keep_contacts=True)
    episode = Episode(start, progress, judges=True)
    snapshots, actions = [episode.snapshot], tuple(solution.unrolled())
    for first in range(0, len(actions), _AT_ONCE):
        progress.report(first / len(actions), f"Step {first}")
        some = actions[first : first + _AT_ONCE]
        snapshots += episode.advance(Advance(run=0, actions=some, keep_contacts=True))
    trace = Trace(
        physics=solution.physics,
        perturbed=False,
        snapshots=tuple(snapshots),
        actions=actions[: len(snapshots) - 1],
    )
    return Opened(level=level, trace=trace)


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
        """The snapshot of a first state."""
        unified = np.zeros(len(NOOP), np.float32)
        told = self._told(state, unified, frame_skip)
        return dataclasses.replace(
            told, action=(), distance=goal_distance(self._level, told.position)
        )

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
        """The snapshot after a step."""
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


def goal_distance(level: Level, position: np.ndarray) -> float:
    """Sum over pairs of a green and a blue body of the distance of their positions [m]."""
    roles = np.array([body.role for body in level.bodies])
    green, blue = position[roles == "green"], position[roles == "blue"]
    if not (len(green) and len(blue)):
        return 0.0
    return float(np.linalg.norm(green[:, None] - blue[None], axis=-1).sum())


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
    """Put a body's origin where the mouse is, with all that hangs on it, at rest."""
    moved = component(level, (pull.body,))
    rows = [k for k, body in enumerate(level.bodies) if body.id in moved]
    held = next(k for k, body in enumerate(level.bodies) if body.id == pull.body)
    position = np.array(state.physics.position)
    shift = np.array(pull.target, np.float32) - position[slots[held]]
    position[slots[rows]] += shift
    for name in ("velocity", "angular_velocity"):
        still = np.array(getattr(state.physics, name))
        still[slots[rows]] = 0.0
        state = dataclasses.replace(
            state, physics=dataclasses.replace(state.physics, **{name: jnp.asarray(still)})
        )
    return dataclasses.replace(
        state, physics=dataclasses.replace(state.physics, position=jnp.asarray(position))
    )


def _with_row(state: EnvState, slot: int, **rows: Any) -> EnvState:
    changed = {}
    for name, row in rows.items():
        values = np.array(getattr(state.physics, name))
        values[slot] = row
        changed[name] = jnp.asarray(values)
    return dataclasses.replace(state, physics=dataclasses.replace(state.physics, **changed))
