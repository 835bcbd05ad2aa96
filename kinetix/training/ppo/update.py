"""Learning from one rollout: epochs of minibatches."""

import dataclasses
import functools
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
import optax
from flax import linen as nn
from jaxtyping import Array, Float, Int

from kinetix.agents.networks.critics import for_the_critic_alone
from kinetix.agents.networks.recurrent import Carry
from kinetix.engine.backend import takes_whole_batches
from kinetix.pytree import pytree
from kinetix.training.config import PpoConfig
from kinetix.training.devices import (
    OWN,
    OWN_COLUMNS,
    WHOLE,
    average,
    on_each_device,
    own_keys,
    shares,
    shuffle_groups,
)
from kinetix.training.ppo.losses import (
    generalised_advantages,
    normalised,
    policy_loss,
    value_loss,
)
from kinetix.training.ppo.rollout import Rollout, Trajectory
from kinetix.training.schedule import adam_anew

GRADIENT: Final = "loss/grad_norm"
"""Column of the gradient's norm before it is clipped."""


@pytree
class Batch:
    """A rollout as learnt from; leading axes time and environments."""

    trajectory: Trajectory
    advantage: Float[Array, "k n"]
    target: Float[Array, "k n"]


@pytree
class Learner:
    """State that learning changes."""

    params: Any
    """Variables of the network, with the root "params"."""
    optimiser: Any
    """State of the optimiser."""
    teacher: Any = None
    """Variables of the agent that it must not leave too soon; None: it may."""
    age: Int[Array, ""] | None = None
    """Rollouts learnt from so far, where that matters."""


def learn(
    config: PpoConfig,
    network: nn.Module,
    optimiser: optax.GradientTransformation,
    learner: Learner,
    rollout: Rollout,
    key: Array,
) -> tuple[Learner, dict[str, Array]]:
    """Improve policy and value on one rollout.

    Args:
        config: Hyper-parameters.
        network: The network.
        optimiser: The optimiser.
        learner: Parameters and the optimiser's state.
        rollout: What was played with these parameters; observations as the network saw them.
        key: Shuffles the minibatches.

    Returns:
        The improved learner, and means of the losses over all gradient steps.
    """

    def improve(learner: Learner, rollout: Rollout, key: Array) -> tuple[Learner, dict[str, Array]]:
        return _learn(config, network, optimiser, learner, rollout, key)

    happened: Any = Rollout(trajectory=OWN_COLUMNS, last_value=OWN, carry=OWN)  # pyright: ignore
    return on_each_device(improve, (WHOLE, happened, WHOLE), WHOLE)(learner, rollout, key)


def _learn(
    config: PpoConfig,
    network: nn.Module,
    optimiser: optax.GradientTransformation,
    learner: Learner,
    rollout: Rollout,
    key: Array,
) -> tuple[Learner, dict[str, Array]]:
    """`learn` on one device, from its share of the rollout; gradients are those of all."""
    trajectory, carry = rollout.trajectory, rollout.carry
    advantage, target = generalised_advantages(
        trajectory.reward,
        trajectory.value,
        trajectory.done,
        rollout.last_value,
        gamma=config.gamma,
        gae_lambda=config.gae_lambda,
    )
    batch = Batch(trajectory=trajectory, advantage=advantage, target=target)
    warm = config.critic_warmup * config.rollouts_per_update
    if warm and learner.age is not None:
        policy_begins = learner.age == warm
        learner = dataclasses.replace(
            learner, optimiser=adam_anew(learner.optimiser, policy_begins)
        )

    def gradient_step(
        learner: Learner, inputs: tuple[Batch, Carry, Array]
    ) -> tuple[Learner, dict[str, Array]]:
        gradient, report = average(_gradient(config, network, learner, *inputs))
        if warm and learner.age is not None:
            gradient = jax.lax.cond(
                learner.age < warm,
                functools.partial(for_the_critic_alone, config.network),
                lambda gradient: gradient,
                gradient,
            )
        report[GRADIENT] = optax.tree.norm(gradient)
        change, state = optimiser.update(gradient, learner.optimiser, learner.params)
        params = optax.apply_updates(learner.params, change)
        return dataclasses.replace(learner, params=params, optimiser=state), report

    def epoch(learner: Learner, key: Array) -> tuple[Learner, dict[str, Array]]:
        shuffle_key, dropout_key = jax.random.split(key)
        parts, carries = _minibatches(config, batch, carry, shuffle_key)
        parts = dataclasses.replace(parts, advantage=jax.vmap(normalised)(parts.advantage))
        keys = jax.random.split(own_keys(dropout_key, 1)[0], config.num_minibatches)
        return jax.lax.scan(gradient_step, learner, (parts, carries, keys))

    learner, reports = jax.lax.scan(epoch, learner, jax.random.split(key, config.update_epochs))
    if learner.age is not None:
        learner = dataclasses.replace(learner, age=learner.age + 1)
    return learner, jax.tree.map(jnp.mean, reports)


def _gradient(
    config: PpoConfig,
    network: nn.Module,
    learner: Learner,
    batch: Batch,
    carry: Carry,
    key: Array,
) -> tuple[Any, dict[str, Array]]:
    """Return a minibatch's gradient and its losses, piece by piece where that is quicker."""
    differentiate = jax.grad(_loss, argnums=2, has_aux=True)

    def of_piece(batch: Batch, carry: Carry, key: Array) -> tuple[Any, dict[str, Array]]:
        return differentiate(config, network, learner.params, batch, carry, key, learner)

    at_once = _rows_at_once(config, batch.trajectory.observation)
    steps, environments = batch.advantage.shape
    pieces = _pieces(steps, environments, at_once)
    if pieces == 1:
        return of_piece(batch, carry, key)
    columns = jax.tree.map(lambda x: _split(x, pieces), batch)
    carries = jax.tree.map(lambda x: x.reshape(pieces, -1, *x.shape[1:]), carry)
    inputs = (columns, carries, jax.random.split(key, pieces))
    first = jax.tree.map(lambda x: x[0], inputs)
    zeros = jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), jax.eval_shape(of_piece, *first))

    def add(total: Any, inputs: Any) -> tuple[Any, None]:
        return jax.tree.map(jnp.add, total, of_piece(*inputs)), None

    total, _ = jax.lax.scan(add, zeros, inputs)
    return jax.tree.map(lambda x: x / pieces, total)


_ROWS_AT_ONCE: Final = 512
"""Rows that a processor learns from at once: what a network computes of more is too much for its
caches, and a gradient of 4096 rows takes up to 1.8 times as long as 8 of 512."""
_NUMBERS_AT_ONCE: Final = {
    "entity_transformer": (25_000, "transformer_encoder_size"),
    "relational": (100_000, "encoder_size"),
}
"""The same for networks of entities: numbers of one layer for all bodies together, and the option
that is its width. A transformer has many layers: its gradient of 512 rows of size l takes 1.6 times
as long as 8 of 64."""


def _rows_at_once(config: PpoConfig, observation: Any) -> int:
    """Count the rows that fit a processor's caches, for a network."""
    if config.network.kind not in _NUMBERS_AT_ONCE or not hasattr(observation, "polygons"):
        return _ROWS_AT_ONCE
    numbers, width = _NUMBERS_AT_ONCE[config.network.kind]
    bodies = observation.polygons.shape[-2] + observation.circles.shape[-2]
    of_a_row = bodies * getattr(config.network, width)
    return min(max(numbers // of_a_row, 1), _ROWS_AT_ONCE)


def _pieces(steps: int, environments: int, at_once: int) -> int:
    """Count the equal pieces that a minibatch is learnt from in."""
    pieces = 1
    if takes_whole_batches() or jax.default_backend() != "cpu":
        return pieces
    while environments % (2 * pieces) == 0 and steps * environments >= 2 * pieces * at_once:
        pieces *= 2
    return pieces


def _split(x: Array, pieces: int) -> Array:
    """Columns in pieces, on a new leading axis."""
    return jnp.moveaxis(x.reshape(x.shape[0], pieces, -1, *x.shape[2:]), 1, 0)


def _loss(
    config: PpoConfig,
    network: nn.Module,
    params: Any,
    batch: Batch,
    carry: Carry,
    key: Array,
    learner: Learner,
) -> tuple[Array, dict[str, Array]]:
    old = batch.trajectory
    output: Any = network.apply(
        params, carry, (old.observation, old.begins), train=True, rngs={"dropout": key}
    )
    _, policy, value = output
    policy = policy.restricted(old.live)
    log_prob = policy.log_prob(old.action)
    actor = policy_loss(log_prob, old.log_prob, batch.advantage, clip_eps=config.clip_eps)
    critic = value_loss(value, old.value, batch.target, clip_eps=config.clip_eps)
    entropy = jnp.mean(policy.entropy())
    acting = actor - config.ent_coef * entropy
    pull: Array | None = None
    if learner.teacher is not None and config.teacher_coef:
        said: Any = network.apply(learner.teacher, carry, (old.observation, old.begins))
        pull = jnp.mean(said[1].restricted(old.live).divergence(policy))
        acting = acting + _teacher_weight(config, learner) * pull
    total = acting + config.vf_coef * critic
    ratio = jnp.exp(log_prob - old.log_prob)
    report = {
        "loss/total": total,
        "loss/policy": actor,
        "loss/value": critic,
        "loss/entropy": entropy,
        # Schulman's low-variance estimate of the divergence, http://joschu.net/blog/kl-approx.html
        "loss/approx_kl": jnp.mean(ratio - 1.0 - jnp.log(ratio)),
        "loss/clip_fraction": jnp.mean(jnp.abs(ratio - 1.0) > config.clip_eps),
    }
    return total, report if pull is None else report | {"loss/from_teacher": pull}


def _teacher_weight(config: PpoConfig, learner: Learner) -> Float[Array, ""]:
    """Return the weight of the teacher's pull: it falls to 0 once the critic has warmed up."""
    assert learner.age is not None
    each = config.rollouts_per_update
    rollouts = max(config.teacher_frac * config.learning_updates, 1.0) * each
    done = jnp.maximum(learner.age - config.critic_warmup * each, 0) / rollouts
    return config.teacher_coef * jnp.maximum(1.0 - done, 0.0)


def _minibatches(
    config: PpoConfig, batch: Batch, carry: Carry, key: Array
) -> tuple[Batch, tuple[Array, Array]]:
    """Return the rollout in shuffled parts, on a new leading axis.

    Whole environments stay together, so that memory can be replayed, unless single steps are asked
    for. Every part takes equally many from each group of environments.
    """
    parts = config.num_minibatches
    steps, environments = batch.advantage.shape
    single = config.full_minibatch_shuffle
    rows, everywhere = steps if single else 1, shares()
    groups = shuffle_groups(environments * everywhere, rows, parts) // everywhere
    order = _order(key, groups, rows, environments, parts)
    if single:

        def shuffle(x: Array) -> Array:
            flat = x.reshape(steps * environments, *x.shape[2:])[order]
            return flat.reshape(parts, 1, -1, *x.shape[2:])

        empty = jnp.zeros((parts, steps * environments // parts, carry[0].shape[1]))
        return jax.tree.map(shuffle, batch), (empty, empty)

    def split(x: Array) -> Array:
        return _split(jnp.take(x, order, axis=1), parts)

    first, second = (x[order].reshape(parts, -1, x.shape[1]) for x in carry)
    return jax.tree.map(split, batch), (first, second)


def _order(key: Array, groups: int, steps: int, environments: int, parts: int) -> Int[Array, " m"]:
    """Rows of a table (steps, environments) in the order of the parts, shuffled group by group."""
    members = np.arange(steps * environments).reshape(steps, groups, environments // groups)
    members = np.moveaxis(members, 1, 0).reshape(groups, -1)
    shuffled = jax.vmap(jax.random.permutation)(own_keys(key, groups), jnp.asarray(members))
    return shuffled.reshape(groups, parts, -1).swapaxes(0, 1).reshape(-1)
