"""kinetix-env's evaluation and rollouts, for training loops written against it.

A *train state* is anything with `apply_fn` and `params`, such as Flax's; its function takes
parameters, the memory, and (observation, done) with the leading axes time and batch.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.networks.recurrent import initial_carry
from kinetix.environment.state import EnvState
from kinetix.training.ppo.losses import generalised_advantages

Preprocess = Callable[[Any], Any]
"""From an observation to what the network is given."""


class EpisodeMetrics(NamedTuple):
    """Statistics of episodes, one entry per level."""

    episode_lengths: Array
    episode_returns: Array
    episode_solve_rates: Array
    episode_solve_rates_best_of_k: Array | float = -1.0

    @classmethod
    def create_empty(cls, num_levels: int) -> "EpisodeMetrics":
        """Return metrics of levels that have not been played."""
        return cls(*(jnp.zeros((num_levels,)) for _ in cls._fields))


class EvalSpec(NamedTuple):
    """Levels to evaluate on."""

    levels_to_eval_on: EnvState
    """Leading axis levels."""
    number_of_levels: int
    level_names: list[str]
    plot_videos: bool
    num_envs_to_video: int | None = None
    """None: all of them."""


class RenderMetrics(NamedTuple):
    """States of episodes that are to be drawn."""

    states_to_plot: Any
    episode_metrics: EpisodeMetrics
    original_level_list_index: Array


class EvalMetrics(NamedTuple):
    """Result of an evaluation."""

    episode_metrics: EpisodeMetrics
    render_metrics: RenderMetrics | None


class KinetixVideo(NamedTuple):
    """A film of episodes."""

    is_fake: bool
    episode_metrics: EpisodeMetrics
    frames: Array
    original_level_list_index: Array


class Played(NamedTuple):
    """Result of `evaluate_rnn` and `general_eval`; axes time and level.

    Once an episode has ended its reward is 0.
    """

    states: Any
    """All states where `keep_states`, otherwise the last."""
    rewards: Float[Array, "k n"]
    done_idx: Int[Array, " n"]
    """The step in which each episode ended; the last one where it did not."""
    episode_lengths: Int[Array, " n"]
    infos: dict[str, Any]
    """Each entry with the axes time and level; 0 once an episode has ended."""
    trajectories: Any = None
    """(observations, actions), where `return_trajectories`."""


def evaluate_rnn(  # noqa: PLR0913 (kinetix-env's signature)
    rng: Array,
    env: Any,
    env_params: Any,
    train_state: Any,
    init_hstate: Any,
    init_obs: Any,
    init_env_state: Any,
    max_episode_length: int,
    keep_states: bool = True,
    return_trajectories: bool = False,
    observation_preprocessing_fn: Preprocess | None = None,
    temperature: float = 1.0,
) -> Played:
    """Play one episode per level with a network.

    Args:
        rng: Random key.
        env: The environment.
        env_params: Its parameters.
        train_state: Has `apply_fn` and `params`.
        init_hstate: Memory at the start.
        init_obs: Observations at the start, leading axis levels.
        init_env_state: States at the start.
        max_episode_length: How long to play [environment steps].
        keep_states: Whether all states are returned, not only the last.
        return_trajectories: Whether observations and actions are.
        observation_preprocessing_fn: Applied to observations before the network.
        temperature: Of the draws.
    """
    levels = jax.tree.leaves(init_obs)[0].shape[0]
    prepare = observation_preprocessing_fn or (lambda observation: observation)

    def step(carry: tuple[Any, ...], _: None) -> tuple[tuple[Any, ...], Any]:
        rng, hstate, obs, state, done, alive = carry
        rng, act_key, step_key = jax.random.split(rng, 3)
        inputs = jax.tree.map(lambda x: x[None], (prepare(obs), done))
        hstate, policy, _ = train_state.apply_fn(train_state.params, hstate, inputs)
        drawn = policy.sample(seed=act_key, temperature=temperature)
        action = jax.tree.map(lambda x: x[0], drawn)
        next_obs, next_state, reward, done, info = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
            jax.random.split(step_key, levels), state, action, env_params
        )
        info = jax.tree.map(lambda x: jnp.where(alive, x, jnp.zeros_like(x)), info)
        seen = {"reward": reward * alive, "alive": alive, "info": info}
        if keep_states:
            seen["state"] = state
        if return_trajectories:
            seen["trajectory"] = (obs, action)
        return (rng, hstate, next_obs, next_state, done, alive & ~done), seen

    none = jnp.zeros(levels, bool)
    start = (rng, init_hstate, init_obs, init_env_state, none, ~none)
    last, seen = jax.lax.scan(step, start, None, length=max_episode_length)
    lengths = jnp.sum(seen["alive"], axis=0, dtype=jnp.int32)
    return Played(
        states=seen["state"] if keep_states else last[3],
        rewards=seen["reward"],
        done_idx=lengths - 1,
        episode_lengths=lengths,
        infos=seen["info"],
        trajectories=seen.get("trajectory"),
    )


def general_eval(  # noqa: PLR0913 (kinetix-env's signature)
    rng: Array,
    eval_env: Any,
    env_params: Any,
    train_state: Any,
    levels: EnvState,
    num_eval_steps: int,
    num_levels: int,
    keep_states: bool = True,
    return_trajectories: bool = False,
    observation_preprocessing_fn: Preprocess | None = None,
    temperature: float = 1.0,
) -> Played:
    """Play one episode in each of some levels; see `evaluate_rnn`.

    Args:
        rng: Random key.
        eval_env: The environment.
        env_params: Its parameters.
        train_state: Has `apply_fn` and `params`.
        levels: States at the start, leading axis levels.
        num_eval_steps: How long to play [environment steps].
        num_levels: How many levels there are.
        keep_states: Whether all states are returned.
        return_trajectories: Whether observations and actions are.
        observation_preprocessing_fn: Applied to observations before the network.
        temperature: Of the draws.
    """
    rng, reset_key = jax.random.split(rng)
    obs, state = jax.vmap(eval_env.reset, in_axes=(0, None, 0))(
        jax.random.split(reset_key, num_levels), env_params, levels
    )
    return evaluate_rnn(
        rng,
        eval_env,
        env_params,
        train_state,
        initial_carry(num_levels),
        obs,
        state,
        num_eval_steps,
        keep_states,
        return_trajectories,
        observation_preprocessing_fn,
        temperature,
    )


def make_eval_fn(
    eval_env: Any,
    env_params: Any,
    num_eval_attempts: int,
    observation_preprocessing_fn: Preprocess | None = None,
    fixed_video_rng: Array | None = None,
    temperature: float = 1.0,
) -> Callable[[Array, Any, Mapping[str, EvalSpec]], dict[str, EvalMetrics]]:
    """Return a function that plays every level of some sets several times.

    It takes a random key, a train state and the sets by name, and returns what it found by name:
    means over the attempts per level, and for sets with `plot_videos` the states of the first
    attempt, axes time and level.

    Args:
        eval_env: The environment.
        env_params: Its parameters.
        num_eval_attempts: Episodes per level.
        observation_preprocessing_fn: Applied to observations before the network.
        fixed_video_rng: Key of the first attempt; by default it differs from call to call.
        temperature: Of the draws.
    """

    def attempt(key: Array, train_state: Any, spec: EvalSpec, *, keep_states: bool) -> Played:
        return general_eval(
            key,
            eval_env,
            env_params,
            train_state,
            spec.levels_to_eval_on,
            env_params.max_timesteps,
            spec.number_of_levels,
            keep_states=keep_states,
            observation_preprocessing_fn=observation_preprocessing_fn,
            temperature=temperature,
        )

    def evaluate(rng: Array, train_state: Any, spec: EvalSpec) -> EvalMetrics:
        first_key, rest_key = jax.random.split(rng)
        keys = jax.random.split(rest_key, num_eval_attempts)
        if spec.plot_videos:
            keys = keys.at[0].set(first_key if fixed_video_rng is None else fixed_video_rng)
        returns, lengths, solved = jax.vmap(
            lambda key: _counted(attempt(key, train_state, spec, keep_states=False))
        )(keys)
        metrics = EpisodeMetrics(
            episode_lengths=lengths.mean(axis=0),
            episode_returns=returns.mean(axis=0),
            episode_solve_rates=solved.mean(axis=0),
            episode_solve_rates_best_of_k=solved.max(axis=0),
        )
        if not spec.plot_videos:
            return EvalMetrics(metrics, None)
        count = spec.num_envs_to_video or spec.number_of_levels
        states = attempt(keys[0], train_state, spec, keep_states=True).states
        shown = RenderMetrics(
            states_to_plot=jax.tree.map(lambda x: x[:, :count], states),
            episode_metrics=EpisodeMetrics(
                episode_lengths=lengths[0, :count],
                episode_returns=returns[0, :count],
                episode_solve_rates=solved[0, :count],
                episode_solve_rates_best_of_k=solved[0, :count],
            ),
            original_level_list_index=jnp.arange(count),
        )
        return EvalMetrics(metrics, shown)

    def evaluate_all(
        rng: Array, train_state: Any, eval_specs: Mapping[str, EvalSpec]
    ) -> dict[str, EvalMetrics]:
        keys = jax.random.split(rng, len(eval_specs))
        return {
            name: evaluate(key, train_state, spec)
            for key, (name, spec) in zip(keys, eval_specs.items(), strict=True)
        }

    return evaluate_all


def _counted(played: Played) -> tuple[Array, Array, Array]:
    """Return, length and whether it was won, one entry per level."""
    won = jnp.any(played.infos["GoalR"].astype(bool), axis=0)
    lengths = played.episode_lengths.astype(jnp.float32)
    return jnp.sum(played.rewards, axis=0), lengths, won.astype(jnp.float32)


def compute_gae(
    gamma: float,
    lambd: float,
    last_value: Float[Array, " n"],
    values: Float[Array, "k n"],
    rewards: Float[Array, "k n"],
    dones: Bool[Array, "k n"],
) -> tuple[Float[Array, "k n"], Float[Array, "k n"]]:
    """Return advantages and value targets; see `generalised_advantages`."""
    return generalised_advantages(rewards, values, dones, last_value, gamma=gamma, gae_lambda=lambd)


def no_op_rollout(  # noqa: PLR0913 (kinetix-env's signature)
    env: Any,
    env_params: Any,
    rng: Array,
    init_obs: Any,
    init_env_state: Any,
    num_envs: int,
    max_episode_length: int,
    do_random: bool = False,
) -> tuple[Float[Array, " n"], Int[Array, " n"], Float[Array, " n"]]:
    """Play one episode per environment doing nothing, or anything.

    Returns:
        Return, length and whether it was won (0 or 1), one entry per environment.
    """
    del init_obs

    def step(carry: tuple[Any, ...], _: None) -> tuple[tuple[Any, ...], None]:
        rng, state, alive, total, length, won = carry
        rng, act_key, step_key = jax.random.split(rng, 3)
        if do_random:
            action = jax.vmap(env.actions.random_action)(jax.random.split(act_key, num_envs))
        else:
            noop = env.actions.noop_action()
            action = jnp.broadcast_to(noop, (num_envs, *np.shape(noop)))
        _, state, reward, done, info = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
            jax.random.split(step_key, num_envs), state, action, env_params
        )
        won = won + alive * info["GoalR"]
        return (rng, state, alive & ~done, total + alive * reward, length + alive, won), None

    zeros = jnp.zeros(num_envs)
    start = (rng, init_env_state, zeros == 0, zeros, zeros.astype(jnp.int32), zeros)
    last, _ = jax.lax.scan(step, start, None, length=max_episode_length)
    return last[3], last[4], last[5]


def no_op_and_random_rollout(
    env: Any,
    env_params: Any,
    rng: Array,
    init_obs: Any,
    init_env_state: Any,
    num_envs: int,
    max_episode_length: int,
) -> tuple[Any, ...]:
    """Return returns, lengths and wins of doing nothing, then those of random actions."""
    common = (env, env_params, rng, init_obs, init_env_state, num_envs, max_episode_length)
    return (*no_op_rollout(*common), *no_op_rollout(*common, do_random=True))
