"""Agents on the worker: load them once, describe them, let them play an episode."""

import dataclasses
import math
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from editor.worker.requests import BUILT_IN, AgentRef, AgentSummary, Casting, Progress, Rehearse
from editor.worker.simulation.compiling import FULL, QUICK, Recipe
from editor.worker.simulation.stepping import PROGRAMS, first_state
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Action, Futures, Mind
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import newest_checkpoint
from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.episodes import episode_keys
from kinetix.agents.evaluate import capacity_and_key
from kinetix.agents.identity import card_digest_of, digest_of
from kinetix.agents.kinetix_env import is_peer_checkpoint
from kinetix.agents.live import play_step
from kinetix.agents.named import load_player
from kinetix.agents.planner.budget import Budget
from kinetix.agents.planner.player import Planner
from kinetix.agents.player import Player
from kinetix.bundled import agent_hint
from kinetix.environment.actions import MultiDiscreteActions
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.errors import CheckpointError, KinetixError
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.pytree import on_device, pytree
from kinetix.wording import plural

_MEMORY: dict[AgentRef, Player] = {}
"""Agents that were loaded, the last ones only."""
_KEPT = 16


def player_of(ref: AgentRef) -> Player:
    """Return the agent that is meant, loaded on first use.

    Raises:
        CheckpointError: The agent cannot be loaded; one sentence.
    """
    player = _MEMORY.get(ref)
    if player is None:
        player = load_player(ref.path)
        _MEMORY[ref] = player
        while len(_MEMORY) > _KEPT:
            del _MEMORY[next(iter(_MEMORY))]
    return player


def load(path: str) -> AgentSummary:
    """Read an agent and describe it.

    Raises:
        CheckpointError: The agent cannot be loaded; one sentence.
    """
    folder = _folder(path)
    ref = AgentRef(path=path, stamp=_stamp(folder))
    player = player_of(ref)
    card = player.card
    capacity = card.capacity
    steps = card.training.get("env_steps", card.training.get("environment_steps"))
    arrays = jax.tree.leaves(player.params.get("params", {}))
    network = "it knows the simulator" if isinstance(player, Planner) else "no network"
    return AgentSummary(
        ref=ref,
        name=card.name,
        description=card.description,
        observation=card.observation.type,
        action=card.action.type,
        network=_network(card) if arrays else network,
        parameters=sum(int(np.prod(leaf.shape)) for leaf in arrays),
        recurrent=bool(arrays) and card.network.recurrent_model,
        capacity=None
        if capacity is None
        else (capacity.polygons, capacity.circles, capacity.joints, capacity.thrusters),
        any_size=card.plays_any_capacity,
        physics=card.environment.physics,
        frame_skip=card.environment.frame_skip,
        steps=int(steps) if isinstance(steps, int | float) else None,
        training=_training(card),
        folder=str(folder) if folder is not None else "",
        digest=digest_of(player),
        dense_reward_scale=card.environment.dense_reward_scale,
        card_digest=card_digest_of(player),
    )


def _folder(path: str) -> Path | None:
    """Return the folder of an agent's arrays: of a training run its newest checkpoint."""
    if path in BUILT_IN:
        return None
    folder = Path(path)
    if not os.path.isdir(folder):
        raise CheckpointError(
            f"{path}: there is no such directory, nor a bundled agent of this name; "
            f"{agent_hint(path, BUILT_IN)}"
        )
    return folder if is_peer_checkpoint(folder) else newest_checkpoint(folder)


def _stamp(folder: Path | None) -> str:
    if folder is None:
        return ""
    times = [path.stat().st_mtime_ns for path in folder.iterdir()]
    return f"{folder}:{max(times, default=0)}"


def _network(card: AgentCard) -> str:
    net = card.network
    words = [net.kind.replace("_", " ")]
    if net.kind == "entity_transformer":
        words.append(f"{plural(net.transformer_depth, 'layer')} of {net.transformer_encoder_size}")
    words.append(f"actor {net.actor_depth} × {net.actor_width}")
    if net.recurrent_model:
        words.append("with memory")
    return ", ".join(words)


def _training(card: AgentCard) -> str:
    algorithm = card.training.get("algorithm")
    return str(algorithm).upper() if isinstance(algorithm, str) else ""


@pytree
class Step:
    """Result of one environment step."""

    state: EnvState
    info: dict[str, Array]
    """Of the environment, with `reward` and `done`."""
    unified: Any
    """The unified action that was played."""
    thought: Any = None
    """The agent's, or None."""


class _Thinking:
    """Budget of a planner: as much as leaves play at real time on this machine."""

    FIRST = 1500.0
    """Before its first move [ms]."""
    SHARE = 0.6
    """Of the time between two plannings."""

    def __init__(self, planner: Planner) -> None:
        policy, skip = planner.policy, planner.card.environment.frame_skip
        self._every = policy.every
        between = policy.every * skip / ENGINE_STEPS_PER_SECOND * 1e3
        self._pace = Budget(
            milliseconds=self.SHARE * between, first_milliseconds=self.FIRST, horizon=policy.horizon
        )
        self.nothing = _rounds(0, 0)
        """Params with which it does not think at all."""
        self.params = _rounds(self._pace.rounds, self._pace.first)

    def note(self, seconds: float, step: int) -> None:
        """Take note of how long a step took."""
        if step % self._every == 0:
            first = step == 0
            rounds = int(self.params["first" if first else "rounds"])
            self._pace.note(seconds, rounds=rounds, first=first)
            self.params = _rounds(self._pace.rounds, self._pace.first)


def _rounds(rounds: int, first: int) -> dict[str, Any]:
    return {"rounds": np.int32(rounds), "first": np.int32(first)}


class AgentDriver:
    """An agent that plays one episode, with its memory and its draws.

    It always plays in a step that every level of the size shares: an attempt that is watched is to
    be the attempt that an evaluation counts, to the bit, and its network outweighs the physics.
    The quick tier alone rounds differently; it says so, and the next attempt has the other one.
    """

    tailored = False

    def __init__(
        self, level: Level, physics: str, casting: Casting, progress: Progress, *, quick: bool
    ) -> None:
        """Get ready to play a level.

        Args:
            level: The level.
            physics: Preset or solver.
            casting: Who plays, with which draws.
            progress: Called with how far loading and compiling are.
            quick: Whether a step that is compiled quickly will do.

        Raises:
            CheckpointError: The agent cannot be loaded, or cannot play the level.
            Cancelled: It is not wanted any more.
        """
        progress.report(None, "Loading the agent")
        self._player = player_of(casting.agent)
        self._casting = casting
        card = self._player.card
        self.capacity = capacity_for(card, capacity_of(level), level=repr(level.name))
        self.env: KinetixEnv = environment_for(self._player, self.capacity, physics=physics)
        self.frame_skip = card.environment.frame_skip
        _, number = capacity_and_key(level)
        self._key = episode_keys([number], [casting.attempt], casting.seed)[0]
        self._carry = self._player.policy.init_carry(1)
        self._thinking = _Thinking(self._player) if isinstance(self._player, Planner) else None
        # Its futures are many steps: a quick step would make them slow.
        quick = quick and self._thinking is None
        hand = MultiDiscreteActions(
            motor_bindings=self.env.actions.motor_bindings,
            thruster_bindings=self.env.actions.thruster_bindings,
        )
        self._hand = hand
        self.quick = quick and PROGRAMS.get(self._recipe(level, quick=False).key) is None
        recipe = self._recipe(level, quick=self.quick)
        self._play: Callable[..., Any] = PROGRAMS.obtain(recipe, progress)

    def _recipe(self, level: Level, *, quick: bool) -> Recipe:
        """Return the recipe of a compiled step."""
        player, tier = self._player, QUICK if quick else FULL
        deterministic = self._casting.deterministic

        def trace() -> Any:
            state = first_state(level, self.env.static_env_params)
            arguments = self._arguments(state, 0, None)
            return play_step.trace(self.env, player.policy, *arguments, deterministic=deterministic)

        # The parameters are an argument: agents of one form share the program.
        shapes = jax.tree.map(lambda x: (jnp.shape(x), str(jnp.result_type(x))), player.params)
        form = jax.tree.structure(shapes), tuple(jax.tree.leaves(shapes))
        key = (self.env, player.policy, form, deterministic, tier)
        return Recipe(key=key, tier=tier, trace=trace, stored=not quick)

    def _arguments(self, state: EnvState, step: int, hand: Action | None) -> tuple[Any, ...]:
        """Return the arguments of the compiled step."""
        width = self.env.actions.motor_bindings + self.env.actions.thruster_bindings
        driven = np.zeros(width, np.float32)
        if hand is not None:
            driven = np.asarray(self._hand.unified(jnp.asarray(hand, jnp.int32)))
        params = self._player.params if self._thinking is None else self._thinking.params
        return (
            params,
            state,
            self._carry,
            jnp.asarray(step == 0),
            jax.random.fold_in(self._key, step),
            jnp.asarray(driven),
            jnp.asarray(hand is not None),
        )

    @property
    def memory(self) -> Any:
        """Memory of the agent, as numpy arrays."""
        return jax.device_get(self._carry)

    def remember(self, memory: Any) -> None:
        """Go on from an earlier memory; None forgets everything."""
        if memory is None:
            self._carry = self._player.policy.init_carry(1)
        else:
            self._carry = on_device(memory)

    def step(self, state: EnvState, step: int, hand: Action | None) -> Step:
        """Do one environment step.

        Args:
            state: Where the episode is.
            step: How many steps there were before.
            hand: What a person drives, or None to let the agent.
        """
        started = time.perf_counter()
        taken = self._play(*self._arguments(state, step, hand))
        if self._thinking is not None:
            jax.block_until_ready(taken)
            self._thinking.note(time.perf_counter() - started, step)
        state, self._carry, thought, info = taken
        return Step(state=state, info=info, unified=thought.action, thought=thought)

    def warm(self, state: EnvState, step: int) -> None:
        """Do once what a first step does, so that nothing is left to be made ready in the game."""
        arguments = self._arguments(state, step, None)
        if self._thinking is not None:
            arguments = (self._thinking.nothing, *arguments[1:])
        jax.block_until_ready(self._play(*arguments)[0])

    def mind(self, thought: Any, *, by_hand: bool, step: int) -> Mind:
        """Return a thought for the window.

        Raises:
            KinetixError: The network's output is NaN.
        """
        if not bool(thought.sane):
            raise KinetixError(
                f"The agent {self._player.card.name!r} gave NaN at step "
                f"{step}: its parameters, or what it was shown, are broken."
            )
        mind = mind_of(
            thought.intention,
            thought.own_action,
            value=float(thought.value),
            entropy=float(thought.entropy),
            chances=thought.chances,
            by_hand=by_hand,
            scripted=self._casting.agent.path in BUILT_IN,
        )
        return dataclasses.replace(mind, futures=_futures(thought.outlook))


def rehearse(request: Rehearse, progress: Progress) -> None:
    """Compile what an agent needs to play a level; see `Rehearse`.

    Raises:
        CheckpointError: The agent cannot be loaded, or cannot play the level.
        Cancelled: It is not wanted any more.
    """
    level, physics, casting = request.level, request.physics, request.casting
    AgentDriver(level, physics, casting, progress, quick=request.quick)


def mind_of(
    intention: Any,
    own_action: Any,
    *,
    value: float = 0.0,
    entropy: float = 0.0,
    chances: Any = None,
    by_hand: bool = False,
    scripted: bool = False,
) -> Mind:
    """Return a thought as plain values."""
    return Mind(
        intention=tuple(np.asarray(intention).tolist()),
        own_action=tuple(np.asarray(own_action).tolist()),
        value=value if math.isfinite(value) else 0.0,
        entropy=entropy if math.isfinite(entropy) else 0.0,
        chances=() if scripted or chances is None else _triples(chances),
        by_hand=by_hand,
        scripted=scripted,
    )


def _futures(outlook: Any) -> Futures | None:
    """Return the futures of a planner's last search; None for other players."""
    if outlook is None:
        return None
    won, lost = np.asarray(outlook.won), np.asarray(outlook.lost)
    ends = np.where(won, "won", np.where(lost, "lost", ""))
    return Futures(
        ways=np.asarray(outlook.ways, np.float32),
        ends=tuple(ends.tolist()),
        steps=tuple(np.asarray(outlook.steps).tolist()),
    )


def _triples(chances: Any) -> tuple[tuple[float, float, float], ...]:
    rows: Any = np.asarray(chances).tolist()
    return tuple((a, b, c) for a, b, c in rows)
