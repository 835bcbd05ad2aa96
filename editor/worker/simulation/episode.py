"""One episode on the environment: start, advance, restore, export as numpy."""

import dataclasses
import time
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np

from editor.base.controls import NOOP
from editor.worker.requests import (
    Advance,
    Opened,
    PlaySolution,
    Progress,
    Restore,
    StartEpisode,
)
from editor.worker.simulation.cast import AgentDriver, Step
from editor.worker.simulation.level_view import LevelView
from editor.worker.simulation.pull import pulled
from editor.worker.simulation.stepping import (
    MOVING,
    Stepper,
    best_stepper,
    first_state,
    generic_stepper,
    own_stepper,
)
from editor.worker.snapshots import FRAME_SKIP, Action, Mind, Snapshot, Trace
from kinetix.environment.outcome import outcome_of
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.pytree import on_device

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
        """Do nothing: a person has no memory."""

    def warm(self, state: EnvState, step: int) -> None:
        """Do once what a first step does; see `AgentDriver.warm`."""
        jax.block_until_ready(self.step(state, step, NOOP).state)

    def step(self, state: EnvState, step: int, hand: Action | None) -> Step:
        """Play one environment step; see `AgentDriver.step`."""
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
            progress: Called with how far the compiler is, where something has to be compiled.
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
    """Return a step as numpy arrays; what the level fixes is taken from the state before."""
    moved = {name: getattr(taken.state, name) for name in MOVING}
    rest = (taken.info, taken.unified, taken.thought)
    moved, (info, unified, thought) = jax.device_get((moved, rest))
    state = dataclasses.replace(before, **moved)
    return Step(state=state, info=info, unified=unified, thought=thought)


def play_solution(request: PlaySolution, progress: Progress) -> Opened:
    """Play the recorded solution of a level and keep every moment.

    Raises:
        KinetixError: The level has no solution, or one that holds its actions for another number of
            engine steps.
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
