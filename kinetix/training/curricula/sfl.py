"""Sampling for learnability: train on levels that the policy solves sometimes.

Source: Rutherford et al., "No Regrets" (2024), with the options of kinetix-env's configurations.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.agent import Agent
from kinetix.agents.normalisation import Normalisation
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState, stack_states
from kinetix.errors import KinetixError
from kinetix.pytree import pytree
from kinetix.training.config import SflConfig
from kinetix.training.curricula.tally import Tally, learnability, play_tally, sfl_score
from kinetix.training.curricula.turnover import BufferView, Turnover
from kinetix.training.devices import everywhere, to_host
from kinetix.training.evaluation import evaluation_levels
from kinetix.training.ppo.rollout import Playing, Trajectory, begin, episode_means, rollout
from kinetix.training.ppo.update import Learner
from kinetix.training.setup import Setup, make_setup
from kinetix.training.work import Work

_UPDATE, _SCORING, _MEASURING = "update", "scoring", "measuring"


@pytree
class Chosen:
    """The buffer: the levels that were worth most when they were scored."""

    levels: EnvState
    tally: Tally
    """Counts of each level, those of training included."""
    score: Float[Array, " m"]


@pytree
class SflState:
    """Everything that an update changes."""

    learner: Learner
    statistics: Normalisation | None
    key: Array
    chosen: Chosen
    age: Int[Array, ""]
    """Updates since the buffer was filled."""
    pool: EnvState | None
    """The fixed set from which all levels are taken, if there is one."""
    playing: Playing
    """The environments: episodes go on over updates, else nothing after the last step of a rollout
    would ever be learnt from."""
    owner: Int[Array, " n"]
    """Level of the buffer that each environment's episode is on; −1: none that still counts."""


class Sfl:
    """Scores many random levels now and then, and trains on the most learnable ones."""

    def __init__(self, config: SflConfig, teacher: Agent | None = None) -> None:
        """Prepare; nothing is compiled yet.

        Args:
            config: The configuration, already checked.
            teacher: The agent to start from.
        """
        steps = config.num_updates * config.update_epochs * config.num_minibatches
        self.config = config
        self.setup = make_setup(config, gradient_steps=steps, teacher=teacher)
        self._drawn = config.drawn_envs
        self.work = Work()
        refills = 1 / config.buffer_update_frequency if self._drawn else 0.0
        self.parts_per_update = {_UPDATE: 1.0, _SCORING: refills * config.num_batches}
        if config.log_learnability_before_after:
            self.parts_per_update[_MEASURING] = 2 * refills
        self._teacher = teacher
        self._extra = _evaluation_states(config, self.setup)
        self._start = jax.jit(self._first_state)
        self._score_batch = jax.jit(self._one_batch)
        self._include = jax.jit(self._with_evaluation_levels)
        self._play_again = jax.jit(self._replayed)
        self._train = jax.jit(self._one_update)
        self.turnover: Turnover | None = None

    def start(self) -> SflState:
        """Return the state before the first update; the buffer counts as too old to be used."""
        return self._start()

    def _first_state(self) -> SflState:
        config = self.config
        keys = jax.random.split(jax.random.PRNGKey(config.seed), 5)
        key, learner_key, level_key, pool_key, playing_key = keys
        size = config.num_to_save
        levels = jax.vmap(self.setup.reset_fn)(jax.random.split(level_key, size))
        none = jnp.zeros(size, jnp.int32)
        pool = None
        if config.train_on_buffer:
            pool = self.setup.fresh_levels(pool_key, config.train_buffer_size)
        return SflState(
            learner=self.setup.start_learner(learner_key, self._teacher),
            statistics=self.setup.start_statistics(self._teacher),
            key=key,
            chosen=everywhere(
                Chosen(
                    levels=levels,
                    tally=Tally(episodes=none, solved=none),
                    score=jnp.full(size, -jnp.inf, jnp.float32),
                )
            ),
            age=jnp.asarray(config.buffer_update_frequency, jnp.int32),
            pool=pool,
            playing=self.setup.start_playing(playing_key),
            owner=everywhere(jnp.full(config.num_train_envs, -1, jnp.int32)),
        )

    def update(self, state: Any) -> tuple[Any, dict[str, Array]]:
        """Refill the buffer when it is old, then train on it and on fresh levels.

        Args:
            state: From `start` or the last update.

        Returns:
            The next state, and metrics by their published names.
        """
        report: dict[str, Array] = {}
        self.turnover = None
        if self._drawn and int(state.age) >= self.config.buffer_update_frequency:
            state, report = self._refill(state)
            self.turnover = self._all_new(state)
        state, metrics = self.work(_UPDATE, self._train, state)
        return state, report | metrics

    def buffer(self, state: Any) -> BufferView:
        """Return the buffer of a state; before it is filled for the first time it is empty."""
        chosen = state.chosen
        score, episodes, solved = to_host(
            (chosen.score, chosen.tally.episodes, chosen.tally.solved)
        )
        return BufferView(
            levels=chosen.levels,
            filled=np.isfinite(score),
            score=score,
            episodes=episodes,
            solved=solved,
        )

    def _all_new(self, state: SflState) -> Turnover:
        view = self.buffer(state)
        assert view.episodes is not None and view.solved is not None
        count = len(view.score)
        rows = np.arange(count, dtype=np.int32)
        return Turnover(
            kind="refilled",
            source=np.where(view.filled, rows, -1),
            slot=np.full(count, -1, np.int32),
            episodes=view.episodes,
            solved=view.solved,
        )

    def _refill(self, state: SflState) -> tuple[SflState, dict[str, Array]]:
        """Fill the buffer; if so configured, measure what training on the last one has changed."""
        if not self.config.log_learnability_before_after:
            return self._fill(state)
        after = {}
        if bool(jnp.isfinite(state.chosen.score).any()):
            state, after = self._measure(state, "after")
        state, report = self._fill(state)
        state, before = self._measure(state, "before")
        return state, report | before | after

    def _measure(self, state: SflState, when: str) -> tuple[SflState, dict[str, Array]]:
        """Play the buffer's levels without learning from them.

        The counts by which they were chosen cannot serve here: the best of many noisy scores are
        too good to be true.
        """
        key, play_key = jax.random.split(state.key)
        self.work.status(f"{_MEASURING} the buffer {when} training")
        means = self.work(
            _MEASURING, self._play_again, state.chosen, state.learner, state.statistics, play_key
        )
        metrics = {f"sfl/{name}_{when}": value for name, value in means.items()}
        return dataclasses.replace(state, key=key), metrics

    def _replayed(
        self, chosen: Chosen, learner: Learner, statistics: Normalisation | None, key: Array
    ) -> dict[str, Array]:
        tally = self._tally(chosen.levels, learner, statistics, key)
        scores = learnability(tally, correction=self.config.learnability_correction)
        rate = tally.solved / jnp.maximum(tally.episodes, 1)
        return {"learnability": jnp.mean(scores), "solve_rate": jnp.mean(rate)}

    def _fill(self, state: SflState) -> tuple[SflState, dict[str, Array]]:
        """Score `num_batches` batches and keep the best of all."""
        key, *keys = jax.random.split(state.key, self.config.num_batches + 1)
        chosen = dataclasses.replace(
            state.chosen, score=jnp.full_like(state.chosen.score, -jnp.inf)
        )
        seen = []
        for number, batch_key in enumerate(keys, start=1):
            self.work.status(f"{_SCORING} {number}/{len(keys)}")
            chosen, mean = self.work(
                _SCORING,
                self._score_batch,
                chosen,
                state.learner,
                state.statistics,
                state.pool,
                batch_key,
            )
            seen.append(mean)
        config = self.config
        kept = learnability(chosen.tally, correction=config.learnability_correction)
        report = {
            "sfl/buffer_learnability": jnp.mean(kept),
            "sfl/sampled_learnability": jnp.mean(jnp.stack(seen)),
        }
        if self._extra is not None:
            chosen = self._include(chosen, self._extra)
        age = jnp.zeros_like(state.age)
        nobody = jnp.full_like(state.owner, -1)
        return dataclasses.replace(state, key=key, chosen=chosen, age=age, owner=nobody), report

    def _with_evaluation_levels(self, chosen: Chosen, extra: EnvState) -> Chosen:
        """The buffer with these levels in its last places; what is scored least lies there."""
        count = extra.timestep.shape[0]
        put = lambda old, new: old.at[-count:].set(new.astype(old.dtype))  # noqa: E731 (used twice)
        nothing = jnp.zeros(count, jnp.int32)
        return Chosen(
            levels=jax.tree.map(put, chosen.levels, extra),
            tally=jax.tree.map(put, chosen.tally, Tally(episodes=nothing, solved=nothing)),
            score=chosen.score.at[-count:].set(0.0),
        )

    def _tally(
        self,
        levels: EnvState,
        learner: Learner,
        statistics: Normalisation | None,
        key: Array,
    ) -> Tally:
        """Count how often the present policy solves levels."""
        config = self.config
        by_episodes = config.learnability_mode == "episodes"
        return play_tally(
            self.setup.game,
            learner.params,
            levels,
            key,
            self.setup.longest_episode if by_episodes else config.rollout_steps,
            statistics=statistics,
            episodes=config.rollout_episodes if by_episodes else None,
        )

    def _one_batch(
        self,
        chosen: Chosen,
        learner: Learner,
        statistics: Normalisation | None,
        pool: EnvState | None,
        key: Array,
    ) -> tuple[Chosen, Array]:
        config = self.config
        level_key, play_key = jax.random.split(key)
        levels = self._fresh(pool, level_key, config.batch_size)
        tally = self._tally(levels, learner, statistics, play_key)
        correction = config.learnability_correction
        fresh = Chosen(levels=levels, tally=tally, score=sfl_score(tally, correction=correction))
        both = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), chosen, fresh)
        _, best = jax.lax.top_k(both.score, config.num_to_save)
        mean = jnp.mean(learnability(tally, correction=correction))
        return everywhere((jax.tree.map(lambda x: x[best], both), mean))

    def _one_update(self, state: SflState) -> tuple[SflState, dict[str, Array]]:
        setup, config, learner = self.setup, self.config, state.learner
        key, pick_key, fresh_key, order_key, begin_key, play_key, learn_key = jax.random.split(
            state.key, 7
        )
        picked = jax.random.randint(pick_key, (self._drawn,), 0, config.num_to_save)
        levels = setup.arranged(self._levels(state, picked, fresh_key), order_key)
        unscored = jnp.full(config.num_train_envs - self._drawn, -1, jnp.int32)
        following = jnp.concatenate([picked.astype(jnp.int32), unscored])
        # Episodes go on; only where one is over the new level begins at once. kinetix-env begins
        # new ones in every update.
        anew = state.playing.begins | (config.parity is not None)
        fresh = begin(setup.game, begin_key, config.num_train_envs, levels)
        playing = _where(anew, fresh, state.playing)
        owner = jnp.where(anew, following, state.owner)
        playing, played = rollout(
            setup.game,
            learner.params,
            playing,
            play_key,
            config.num_steps,
            levels=levels,
            statistics=state.statistics,
        )
        tally, owner = count_by_owner(state.chosen.tally, owner, following, played.trajectory)
        learner, statistics, losses = setup.learn(learner, played, learn_key, state.statistics)
        after = SflState(
            learner=learner,
            statistics=statistics,
            key=key,
            chosen=everywhere(dataclasses.replace(state.chosen, tally=tally)),
            age=state.age + 1,
            pool=state.pool,
            playing=playing,
            owner=everywhere(owner),
        )
        return after, episode_means(played.trajectory) | losses

    def _levels(self, state: SflState, picked: Array, key: Array) -> EnvState:
        """Return the picked levels of the buffer, then fresh ones for the other environments."""
        count = self.config.num_train_envs - self._drawn
        parts = []
        if self._drawn:
            parts.append(jax.tree.map(lambda x: x[picked], state.chosen.levels))
        if count:
            parts.append(self._fresh(state.pool, key, count))
        return jax.tree.map(lambda *x: jnp.concatenate(x), *parts)

    def _fresh(self, pool: EnvState | None, key: Array, count: int) -> EnvState:
        """Return levels that nothing has chosen: new ones, or any of the fixed set."""
        if pool is None:
            return self.setup.fresh_levels(key, count)
        index = jax.random.randint(key, (count,), 0, self.config.train_buffer_size)
        return jax.tree.map(lambda x: x[index], pool)


def _evaluation_states(config: SflConfig, setup: Setup) -> EnvState | None:
    """Return the evaluation levels as states, where they are to be trained on too."""
    if not config.put_eval_levels_in_buffer:
        return None
    levels = evaluation_levels(config)
    if not 0 < len(levels) <= config.num_to_save:
        raise KinetixError(
            f"put_eval_levels_in_buffer: {len(levels)} evaluation levels do not fit a buffer of "
            f"num_to_save = {config.num_to_save}"
        )
    states = [level_state(level.source, setup.env.static_env_params) for level in levels]
    # On the host, where all training processes have the same.
    return jax.tree.map(np.asarray, stack_states(states))


def _where(chosen: Bool[Array, " n"], these: Any, those: Any) -> Any:
    """Select rows from two batches by a mask."""

    def pick(a: Array, b: Array) -> Array:
        return jnp.where(chosen.reshape(-1, *[1] * (a.ndim - 1)), a, b)

    return jax.tree.map(pick, these, those)


def count_by_owner(
    tally: Tally,
    owner: Int[Array, " n"],
    following: Int[Array, " n"],
    trajectory: Trajectory,
) -> tuple[Tally, Int[Array, " n"]]:
    """Take the episodes that ended into the counts of the levels that they were played on.

    Args:
        tally: The buffer's counts.
        owner: Which level of the buffer each environment's running episode is on; −1: none.
        following: Which one its next episodes are on.
        trajectory: What was played.

    Returns:
        The counts, and the owners of the episodes that run at the end.
    """
    size = tally.episodes.shape[0]

    def step(
        carry: tuple[Tally, Array], ends: tuple[Array, Array]
    ) -> tuple[tuple[Tally, Array], None]:
        tally, owner = carry
        done, solved = ends
        # Beyond the end nothing is counted.
        at = jnp.where(done & (owner >= 0), owner, size)
        counted = Tally(
            episodes=tally.episodes.at[at].add(1, mode="drop"),
            solved=tally.solved.at[at].add(solved.astype(tally.solved.dtype), mode="drop"),
        )
        return (counted, jnp.where(done, following, owner)), None

    ends = (trajectory.done, trajectory.solved)
    return jax.lax.scan(step, (tally, owner), ends)[0]
