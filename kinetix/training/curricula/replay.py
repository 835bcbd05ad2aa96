"""PLR, ACCEL and DR: new levels, replayed levels, mutated levels, one kind a step.

Sources: Jiang et al., "Prioritized Level Replay" (2021); Parker-Holder et al., "Evolving Curricula
with Regret-Based Environment Design" (2022).
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from kinetix.agents.agent import Agent
from kinetix.agents.normalisation import Normalisation
from kinetix.environment.generators.edits import accel_edit
from kinetix.environment.generators.starts import accel_start_sampler
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree
from kinetix.training.config import ReplayConfig
from kinetix.training.curricula.buffer import LevelBuffer, draw, empty_buffer, insert, revise
from kinetix.training.curricula.scores import best_return, level_scores
from kinetix.training.curricula.turnover import BufferView, Turnover
from kinetix.training.devices import everywhere, to_host
from kinetix.training.ppo.rollout import Rollout, begin, episode_means, rollout
from kinetix.training.ppo.update import Learner
from kinetix.training.setup import make_setup
from kinetix.training.work import Work

_NEW, _REPLAY, _MUTATE = "new", "replay", "mutate"
_TOLD = {_NEW: "new levels", _REPLAY: "replay", _MUTATE: "mutations"}
"""Each kind of step in the terminal's words."""


@pytree
class ReplayState:
    """Everything that an update changes."""

    learner: Learner
    statistics: Normalisation | None
    key: Array
    buffer: LevelBuffer
    replayed: Int[Array, " n"]
    """The levels of the last replay."""
    just_replayed: Bool[Array, ""]
    """True where the last step was a replay."""


@pytree
class _Visits:
    """Effects of an update on the buffer, for its history."""

    source: Int[Array, " m"]
    episodes: Int[Array, " n"]
    solved: Int[Array, " n"]


class Replay:
    """Keeps the levels that are worth replaying, and replays them."""

    def __init__(self, config: ReplayConfig, teacher: Agent | None = None) -> None:
        """Prepare; nothing is compiled yet.

        Args:
            config: The configuration, already checked.
            teacher: The agent to start from.
        """
        per_update = config.outer_rollout_steps * config.update_epochs * config.num_minibatches
        self.config = config
        self.parts_per_update = _kinds_per_update(config)
        steps = max(config.learning_updates, 1) * per_update
        self.setup = make_setup(config, gradient_steps=steps, teacher=teacher)
        # kinetix-env draws with replacement, and subtracts values from undiscounted returns.
        own = config.parity is None
        self._distinct, self._gamma = own, config.gamma if own else 1.0
        self.work = Work()
        self._teacher = teacher
        self.turnover: Turnover | None = None
        self._start = jax.jit(self._first_state)
        self._steps = {
            _NEW: jax.jit(self._new),
            _REPLAY: jax.jit(self._replay),
            _MUTATE: jax.jit(self._mutate),
        }

    def start(self) -> ReplayState:
        """Return the state before the first update."""
        return self._start()

    def _first_state(self) -> ReplayState:
        key, learner_key, level_key = jax.random.split(jax.random.PRNGKey(self.config.seed), 3)
        return everywhere(
            ReplayState(
                learner=self.setup.start_learner(learner_key, self._teacher),
                statistics=self.setup.start_statistics(self._teacher),
                key=key,
                buffer=empty_buffer(
                    self.setup.reset_fn(level_key), self.config.level_buffer_capacity
                ),
                replayed=jnp.zeros(self.config.num_train_envs, jnp.int32),
                just_replayed=jnp.zeros((), bool),
            )
        )

    def update(self, state: Any) -> tuple[Any, dict[str, Array]]:
        """Do one step: new levels, a replay, or mutations of the last replay.

        Args:
            state: From `start` or the last update.

        Returns:
            The next state, and metrics by their published names.
        """
        # The kind is chosen here and not inside the compiled step, so that only it is computed.
        key, choice_key = jax.random.split(state.key)
        kind = self._kind(state, choice_key)
        step, before = self._steps[kind], state.replayed
        state, metrics, visits = self.work(_TOLD[kind], step, dataclasses.replace(state, key=key))
        self.turnover = self._turned_over(kind, before, state.replayed, visits)
        buffer = state.buffer
        finite = buffer.filled & jnp.isfinite(buffer.score)
        kinds = {f"level_sampler/{name}": jnp.asarray(kind == name) for name in self._steps}
        return state, metrics | kinds | {
            "level_sampler/filled": jnp.mean(buffer.filled),
            "level_sampler/mean_score": jnp.sum(jnp.where(finite, buffer.score, 0.0))
            / jnp.maximum(jnp.sum(finite), 1),
        }

    def buffer(self, state: Any) -> BufferView:
        """Return the buffer of a state."""
        kept = state.buffer
        filled, score = to_host((kept.filled, kept.score))
        return BufferView(levels=kept.levels, filled=filled, score=score)

    def _turned_over(self, kind: str, before: Array, after: Array, visits: Any) -> Turnover:
        visits = to_host(visits)
        none = np.full(len(visits.episodes), -1, np.int32)
        slots = {_NEW: none, _REPLAY: to_host(after), _MUTATE: to_host(before)}
        return Turnover(
            kind="mutated" if kind == _MUTATE else "new",
            source=visits.source,
            slot=slots[kind],
            episodes=visits.episodes,
            solved=visits.solved,
        )

    def _kind(self, state: ReplayState, key: Array) -> str:
        config = self.config
        if config.use_accel and bool(state.just_replayed):
            return _MUTATE
        filled = float(jnp.mean(state.buffer.filled))
        full_enough = filled > 0 and filled >= config.minimum_fill_ratio
        wanted = float(jax.random.uniform(key)) < config.replay_prob
        return _REPLAY if full_enough and wanted else _NEW

    def _new(self, state: ReplayState) -> tuple[ReplayState, dict[str, Array], _Visits]:
        key, level_key, step_key = jax.random.split(state.key, 3)
        count = self.config.num_train_envs
        if self.config.use_accel and self.config.accel_start_from_empty:
            sampler = accel_start_sampler(self.setup.env.physics_engine, self.setup.ued)
            levels = jax.vmap(sampler)(jax.random.split(level_key, count))
        else:
            levels = self.setup.fresh_levels(level_key, count)
        return self._explore(dataclasses.replace(state, key=key), levels, step_key)

    def _mutate(self, state: ReplayState) -> tuple[ReplayState, dict[str, Array], _Visits]:
        key, edit_key, step_key = jax.random.split(state.key, 3)
        keys = jax.random.split(edit_key, self.config.num_train_envs)
        parents = jax.tree.map(lambda x: x[state.replayed], state.buffer.levels)
        edits, ued = self.config.num_edits, self.setup.ued
        levels = jax.vmap(lambda key, level: accel_edit(key, level, edits, ued))(keys, parents)
        return self._explore(dataclasses.replace(state, key=key), levels, step_key)

    def _explore(
        self, state: ReplayState, levels: EnvState, key: Array
    ) -> tuple[ReplayState, dict[str, Array], _Visits]:
        """Play levels that are not in the buffer, and offer them to it."""
        learning = self.config.exploratory_grad_updates
        state, played, metrics = self._play(state, levels, key, learning=learning)
        best = best_return(played, gamma=self._gamma)
        buffer, source = insert(state.buffer, levels, self._score(played, best), best, self.config)
        following = dataclasses.replace(
            state, buffer=buffer, just_replayed=jnp.zeros_like(state.just_replayed)
        )
        return everywhere(following), metrics, _visits(played, source)

    def _replay(self, state: ReplayState) -> tuple[ReplayState, dict[str, Array], _Visits]:
        key, draw_key, order_key, step_key = jax.random.split(state.key, 4)
        count = self.config.num_train_envs
        buffer, index = draw(state.buffer, draw_key, count, self.config, distinct=self._distinct)
        stored = jax.tree.map(lambda x: x[index], buffer.levels)
        levels = self.setup.arranged(stored, order_key)
        state = dataclasses.replace(state, key=key)
        state, played, metrics = self._play(state, levels, step_key, learning=True)
        best = jnp.maximum(best_return(played, gamma=self._gamma), buffer.max_return[index])
        buffer = revise(buffer, index, self._score(played, best), best)
        following = dataclasses.replace(
            state,
            buffer=buffer,
            replayed=index.astype(jnp.int32),
            just_replayed=jnp.ones_like(state.just_replayed),
        )
        return (
            everywhere(following),
            metrics,
            _visits(played, jnp.full(buffer.filled.shape, -1, jnp.int32)),
        )

    def _score(self, played: Rollout, best: Array) -> Array:
        config = self.config
        return level_scores(
            config.score_function, played, best, gamma=config.gamma, gae_lambda=config.gae_lambda
        )

    def _play(
        self, state: ReplayState, levels: EnvState, key: Array, *, learning: bool
    ) -> tuple[ReplayState, Rollout, dict[str, Array]]:
        """Several rollouts on the same levels, each learnt from; what is scored is all of them."""
        setup, config = self.setup, self.config
        begin_key, key = jax.random.split(key)
        playing = begin(setup.game, begin_key, config.num_train_envs, levels)

        def one(carry: Any, key: Array) -> tuple[Any, tuple[Rollout, dict[str, Array]]]:
            learner, statistics, playing = carry
            play_key, learn_key = jax.random.split(key)
            playing, played = rollout(
                setup.game,
                learner.params,
                playing,
                play_key,
                config.num_steps,
                levels=levels,
                statistics=statistics,
            )
            losses: dict[str, Array] = {}
            if learning:
                learner, statistics, losses = setup.learn(learner, played, learn_key, statistics)
            # Observations are large and no score needs them.
            bare = dataclasses.replace(played.trajectory, observation=())
            return (learner, statistics, playing), (
                dataclasses.replace(played, trajectory=bare),
                losses,
            )

        start = (state.learner, state.statistics, playing)
        keys = jax.random.split(key, config.outer_rollout_steps)
        (learner, statistics, _), (parts, losses) = jax.lax.scan(one, start, keys)
        joined = jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), parts.trajectory)
        played = Rollout(
            trajectory=joined,
            last_value=parts.last_value[-1],
            carry=jax.tree.map(lambda x: x[0], parts.carry),
        )
        metrics = episode_means(joined) | jax.tree.map(jnp.mean, losses)
        return dataclasses.replace(state, learner=learner, statistics=statistics), played, metrics


def _kinds_per_update(config: ReplayConfig) -> dict[str, float]:
    """The share of each kind of step, once the buffer is full enough."""
    replays = config.replay_share
    mutations = replays if config.use_accel else 0.0
    shares = {_NEW: 1 - replays - mutations, _REPLAY: replays, _MUTATE: mutations}
    return {_TOLD[kind]: share for kind, share in shares.items() if share}


def _visits(played: Rollout, source: Int[Array, " m"]) -> _Visits:
    done, solved = played.trajectory.done, played.trajectory.solved
    return _Visits(
        source=source,
        episodes=jnp.sum(done, axis=0, dtype=jnp.int32),
        solved=jnp.sum(done & solved, axis=0, dtype=jnp.int32),
    )
