"""One episode that is watched while it happens: an agent decides, or somebody takes over."""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.agents.player import Policy
from kinetix.environment.actions import (
    AbstractAction,
    ContinuousActions,
    DiscreteActions,
    MultiDiscreteActions,
)
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree


@pytree
class Thought:
    """State of a player when it chose an action."""

    action: Float[Array, " u"]
    """The unified action that was played: the player's, or the hand's."""
    own_action: Float[Array, " u"]
    """The unified action that the player chose."""
    intention: Float[Array, " u"]
    """The player's expected unified action; the chosen one for scripted players."""
    value: Float[Array, ""]
    """Expected future return; 0 for scripted players."""
    entropy: Float[Array, ""]
    """Entropy of the policy over the level's controls [nat]; 0 for scripted players."""
    chances: Float[Array, "u 3"]
    """Each control's probabilities of −1, 0 and +1; 0 throughout for scripted players."""
    sane: Bool[Array, ""]
    """True if all outputs of the network are finite."""
    outlook: Any = None
    """The futures that a planner tried (`planner.policy.Outlook`); None for other players."""


@functools.partial(jax.jit, static_argnums=(0, 1), static_argnames="deterministic")
def play_step(  # noqa: PLR0913 - everything that one step of a watched episode depends on
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    state: EnvState,
    carry: Any,
    begins: Bool[Array, ""],
    key: Array,
    hand: Float[Array, " u"],
    by_hand: Bool[Array, ""],
    *,
    deterministic: bool = False,
) -> tuple[EnvState, Any, Thought, dict[str, Array]]:
    """Play one environment step of one episode.

    The player decides in every step, so that its memory goes on while somebody else drives.

    Args:
        env: The environment, without auto-reset.
        policy: Policy that chooses the actions.
        params: Parameters of the policy.
        state: Where the episode is.
        carry: The player's memory, a batch of one.
        begins: True for the first step: the memory is reset.
        key: For the player's draw; `fold_in(episode key, step)` for the draws of an evaluation.
        hand: A unified action from elsewhere.
        by_hand: Whether that one is played.
        deterministic: Take the likeliest action instead of drawing one.

    Returns:
        The next state, the player's memory, its thought, and `info` with `reward` and `done`.
    """
    observation = jax.tree.map(lambda x: x[None], env.get_obs(state))
    actions, carry, said = policy.decide(
        params, carry, observation, key[None], begins[None], deterministic=deterministic
    )
    own = env.actions.unified(jax.tree.map(lambda x: x[0], actions))
    played = jnp.where(by_hand, hand, own)
    # The action is given in the form that both have; the control that follows is the same.
    unified = ContinuousActions(
        motor_bindings=env.actions.motor_bindings, thruster_bindings=env.actions.thruster_bindings
    )
    live = env.actions.live(state.world, state.labels)
    thought = _thought(env, said, own, played, live)
    _, state, reward, done, info = dataclasses.replace(env, actions=unified).step(
        key, state, played
    )
    return state, carry, thought, info | {"reward": reward, "done": done}


@pytree
class Reading:
    """Output of a network for one environment, for overlays and records."""

    value: Float[Array, ""]
    """Expected future return."""
    entropy: Float[Array, ""]
    """Of its policy over the controls that the level has [nat]."""
    chances: Float[Array, "u 3"]
    """Each control's probabilities of −1, 0 and +1."""
    intention: Float[Array, " u"]
    """Expected unified action."""


def read_policy(env: KinetixEnv, said: dict[str, Any], live: Bool[Array, " u"]) -> Reading:
    """Return the network's output for the first environment of its batch.

    Args:
        env: The environment.
        said: The information of `player.Policy.decide`, with a leading axis.
        live: Controls that the level has, `env.actions.live`.
    """
    made = said["policy"]
    policy = made.replace(logits=made.logits[0])
    return Reading(
        value=said["value"][0],
        entropy=policy.restricted(live).entropy(),
        chances=policy.chances(env.actions.motor_bindings),
        intention=intention(env.actions, policy.logits),
    )


def intention(actions: AbstractAction, logits: Float[Array, " k"]) -> Float[Array, " u"]:
    """Return the expected unified action of a policy.

    Args:
        actions: The kind of action.
        logits: The policy's raw output for one environment (for a normal distribution its mean).

    Returns:
        A number −1 … 1 per motor binding (probability of forward minus that of backward), then one
        0 … 1 per thruster binding.
    """
    kind: Any = actions
    if isinstance(actions, MultiDiscreteActions):
        split = 3 * kind.motor_bindings
        motors = jax.nn.softmax(logits[:split].reshape(kind.motor_bindings, 3), axis=-1)
        thrusters = jax.nn.softmax(logits[split:].reshape(kind.thruster_bindings, 2), axis=-1)
        return jnp.concatenate([motors[:, 1] - motors[:, 2], thrusters[:, 1]])
    if isinstance(actions, DiscreteActions):
        each = jax.vmap(actions.unified)(jnp.arange(logits.shape[0]))
        return jax.nn.softmax(logits) @ each
    return actions.unified(logits)


def _thought(
    env: KinetixEnv, said: dict[str, Any], own: Array, played: Array, live: Array
) -> Thought:
    if "policy" not in said:
        nothing = jnp.zeros(())
        return Thought(
            action=played,
            own_action=own,
            intention=own,
            value=nothing,
            entropy=nothing,
            chances=jnp.zeros((*own.shape, 3)),
            sane=jnp.ones((), bool),
            outlook=jax.tree.map(lambda x: x[0], said.get("outlook")),
        )
    reading = read_policy(env, said, live)
    return Thought(
        action=played,
        own_action=own,
        intention=reading.intention,
        value=reading.value,
        entropy=reading.entropy,
        chances=reading.chances,
        sane=jnp.all(jnp.isfinite(said["logits"])) & jnp.isfinite(reading.value),
    )
