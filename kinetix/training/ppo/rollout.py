"""Playing: a batch of environments, one policy, a fixed number of steps."""

import dataclasses
from typing import Any, Final

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.networks.recurrent import Carry, initial_carry
from kinetix.agents.normalisation import Normalisation, normalise
from kinetix.engine.batch import in_a_round
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree
from kinetix.training.devices import OWN, OWN_COLUMNS, WHOLE, on_each_device, own_keys, placed

_TIMEOUT_CHUNK: Final = 64
"""Cut-off episodes whose last state is valued at once, at least."""


@pytree
class Playing:
    """A batch of environments on their way."""

    env_state: EnvState
    observation: Any
    carry: Carry
    begins: Bool[Array, " n"]
    """True where an episode has just begun."""
    episode_return: Float[Array, " n"]
    """Reward of the running episode."""
    episode_length: Int[Array, " n"]
    """Steps of the running episode."""


def as_updates_leave_it(state: Any) -> Any:
    """Return a stored training state with its arrays on the devices where updates leave them.

    From anywhere else, the first update after a resume would be one program and the second
    another, each compiled.

    Args:
        state: As numpy arrays; of an algorithm that plays on all devices.
    """

    def is_playing(part: Any) -> bool:
        return isinstance(part, Playing)

    if jax.device_count() == 1:
        return state
    return jax.tree.map(
        lambda part: placed(part, OWN if is_playing(part) else WHOLE), state, is_leaf=is_playing
    )


@pytree
class Trajectory:
    """Steps of a rollout; axes time and environments."""

    observation: Any
    """Before the step, as the environment gave it."""
    action: Array
    live: Bool[Array, "k n u"]
    """Controls that count in log-probabilities and entropies."""
    log_prob: Float[Array, "k n"]
    value: Float[Array, "k n"]
    reward: Float[Array, "k n"]
    """As learnt from: with the value of the last state where the time limit cut an episode."""
    begins: Bool[Array, "k n"]
    """True where the step was the first of its episode."""
    done: Bool[Array, "k n"]
    """True where it was the last."""
    solved: Bool[Array, "k n"]
    """True where it reached the goal."""
    bad: Bool[Array, "k n"]
    """True where it ended in NaN."""
    dropped: Bool[Array, "k n"]
    """True where the step had no room for all contacts."""
    episode_return: Float[Array, "k n"]
    """Reward of the episode so far, this step included."""
    episode_length: Int[Array, "k n"]
    """Steps of the episode so far, this one included."""


@pytree
class Rollout:
    """A trajectory and what is needed to learn from it."""

    trajectory: Trajectory
    last_value: Float[Array, " n"]
    """The critic's value after the last step."""
    carry: Carry
    """Recurrent state before the first step."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Game:
    """Constants of a training: the environment, the network, two numbers. Hashable."""

    env: KinetixEnv
    network: nn.Module
    gamma: float
    bootstrap_on_timeout: bool
    masks_controls: bool = True
    """True if controls that a level does not have are left out of the policy's log-probabilities
    and entropies; kinetix-env counts them."""

    def live_controls(self, state: EnvState) -> Bool[Array, "n u"]:
        """Return the controls that count, for a batch of states."""
        live = jax.vmap(self.env.actions.live)(state.world, state.labels)
        return live if self.masks_controls else jnp.ones_like(live)


def begin(game: Game, key: Array, count: int, levels: EnvState | None = None) -> Playing:
    """Start `count` environments.

    Args:
        game: Environment and network.
        key: Draws the levels where none are given.
        count: How many.
        levels: Where each starts; None: the environment's own reset function.
    """

    def start(keys: Array, levels: EnvState | None) -> Playing:
        own = keys.shape[0]
        observation, env_state = jax.vmap(game.env.reset, in_axes=(0, None, 0))(keys, None, levels)
        return Playing(
            env_state=env_state,
            observation=observation,
            carry=initial_carry(own),
            begins=jnp.ones(own, bool),
            episode_return=jnp.zeros(own),
            episode_length=jnp.zeros(own, jnp.int32),
        )

    return on_each_device(start, (OWN, OWN), OWN)(jax.random.split(key, count), levels)


def rollout(
    game: Game,
    params: Any,
    playing: Playing,
    key: Array,
    length: int,
    *,
    levels: EnvState | None = None,
    statistics: Normalisation | None = None,
) -> tuple[Playing, Rollout]:
    """Play `length` steps with actions drawn from the policy.

    Args:
        game: Environment and network.
        params: Variables of the network.
        playing: The environments.
        key: Random key.
        length: Number of environment steps.
        levels: Where each environment starts again; None: the environment's own reset function.
        statistics: Normalise observations by these.

    Returns:
        The environments afterwards, and what happened.
    """

    def play(
        params: Any,
        statistics: Normalisation | None,
        playing: Playing,
        levels: EnvState | None,
        keys: Array,
    ) -> tuple[Playing, Rollout]:
        return _play(game, params, playing, keys, levels, statistics)

    happened: Any = Rollout(trajectory=OWN_COLUMNS, last_value=OWN, carry=OWN)  # pyright: ignore
    shares = on_each_device(play, (WHOLE, WHOLE, OWN, OWN, WHOLE), (OWN, happened))
    return shares(params, statistics, playing, levels, jax.random.split(key, length))


def _play(
    game: Game,
    params: Any,
    playing: Playing,
    keys: Array,
    levels: EnvState | None,
    statistics: Normalisation | None,
) -> tuple[Playing, Rollout]:
    """`rollout` on one device: a step a key."""

    def step(playing: Playing, key: Array) -> tuple[Playing, Trajectory]:
        action_key, step_key = jax.random.split(key)
        observation = normalise(statistics, playing.observation)
        carry, policy, value = _apply(game, params, playing.carry, observation, playing.begins)
        live = game.live_controls(playing.env_state)
        count = playing.begins.shape[0]
        action = jax.vmap(lambda key, logits: policy.replace(logits=logits).sample(key))(
            own_keys(action_key, count), policy.logits
        )
        keys = own_keys(step_key, count)
        stepped = jax.vmap(game.env.step, in_axes=(0, 0, 0, None, 0))
        following, env_state, reward, done, info = stepped(
            keys, playing.env_state, action, None, levels
        )
        returns, lengths = playing.episode_return + reward, playing.episode_length + 1
        learnt = reward
        if game.bootstrap_on_timeout:
            terminal = normalise(statistics, info["terminal_observation"])
            learnt = reward + game.gamma * _values_where(
                game, params, carry, terminal, info["truncated"]
            )
        trajectory = Trajectory(
            observation=playing.observation,
            action=action,
            live=live,
            log_prob=policy.restricted(live).log_prob(action),
            value=value,
            reward=learnt,
            begins=playing.begins,
            done=done,
            solved=info["GoalR"],
            bad=info["nan"],
            dropped=info["overflow"],
            episode_return=returns,
            episode_length=lengths,
        )
        following_play = Playing(
            env_state=env_state,
            observation=following,
            carry=carry,
            begins=done,
            episode_return=jnp.where(done, 0.0, returns),
            episode_length=jnp.where(done, 0, lengths),
        )
        return following_play, trajectory

    before = playing.carry
    playing, trajectory = jax.lax.scan(step, playing, keys)
    observation = normalise(statistics, playing.observation)
    _, _, last_value = _apply(game, params, playing.carry, observation, playing.begins)
    return playing, Rollout(trajectory=trajectory, last_value=last_value, carry=before)


def act(
    game: Game,
    params: Any,
    playing: Playing,
    key: Array,
    *,
    levels: EnvState | None = None,
    statistics: Normalisation | None = None,
) -> tuple[Playing, Bool[Array, " n"], Bool[Array, " n"]]:
    """Play one step of which nothing is kept but how it ended.

    Args:
        game: Environment and network.
        params: Variables of the network.
        playing: The environments.
        key: Random key.
        levels: As for `rollout`.
        statistics: As for `rollout`.

    Returns:
        The environments afterwards, which episodes ended, and which reached the goal.
    """
    without = dataclasses.replace(game, bootstrap_on_timeout=False)
    playing, played = rollout(
        without, params, playing, key, 1, levels=levels, statistics=statistics
    )
    return playing, played.trajectory.done[0], played.trajectory.solved[0]


def episode_means(trajectory: Trajectory) -> dict[str, Float[Array, ""]]:
    """Means over the episodes that ended, under the published names; NaN where none did."""
    ended = jnp.sum(trajectory.done)

    def mean(values: Array) -> Array:
        return jnp.sum(jnp.where(trajectory.done, values, 0)) / ended

    return {
        "episode_return": mean(trajectory.episode_return),
        "episode_length": mean(trajectory.episode_length),
        "episode_solved": mean(trajectory.solved),
        "episodes": ended,
        "nan_episodes": jnp.sum(trajectory.done & trajectory.bad),
        "dropped_contacts": jnp.sum(trajectory.dropped),
    }


def _apply(
    game: Game, params: Any, carry: Carry, observation: Any, begins: Array
) -> tuple[Carry, Any, Array]:
    """Apply the network to one step: the axis of time comes and goes."""
    inputs = jax.tree.map(lambda x: x[None], (observation, begins))
    output: Any = game.network.apply(params, carry, inputs)
    carry, policy, value = output
    return carry, policy.replace(logits=policy.logits[0]), value[0]


def _values_where(
    game: Game, params: Any, carry: Carry, observation: Any, wanted: Bool[Array, " n"]
) -> Float[Array, " n"]:
    """Return the critic's values of some observations, 0 elsewhere.

    Few episodes are cut off in any one step, so the rows are packed and worked off in chunks.
    """
    count = wanted.shape[0]
    chunk = in_a_round(count, _TIMEOUT_CHUNK)
    (rows,) = jnp.nonzero(wanted, size=count, fill_value=count)
    rows = jnp.pad(rows, (0, chunk), constant_values=count)
    total = jnp.sum(wanted)

    def value_chunk(state: tuple[Array, Array]) -> tuple[Array, Array]:
        first, values = state
        chosen = jax.lax.dynamic_slice_in_dim(rows, first, chunk)
        take = lambda x: jnp.take(x, chosen, axis=0, mode="clip")  # noqa: E731 (used once)
        part_carry, part = jax.tree.map(take, (carry, observation))
        _, _, value = _apply(game, params, part_carry, part, jnp.zeros(chunk, bool))
        return first + chunk, values.at[chosen].set(value, mode="drop")

    start = (jnp.zeros((), total.dtype), jnp.zeros(count))
    return jax.lax.while_loop(lambda state: state[0] < total, value_chunk, start)[1]
