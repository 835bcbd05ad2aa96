"""Environment steps per second of PPO, played and learnt from: one loop for kinetix-env and for us.

Both packages are called `kinetix` and have the names used here, so this same file is run by the
Python of either. Nothing but the environment differs: networks, loop and optimiser are written out
below. Episodes start on random levels of size s, which each package draws in its own way.

The job has `network` (`flat`: three layers of 128; `entity`: two transformer layers of width 64),
`environments`, `steps`, `minibatches`, `epochs`, `updates` (how many are timed; the median counts),
`free` (worlds stand still at no cost: what the rest of the loop takes) and, for ours alone,
`physics`.
"""

import functools
import importlib.metadata
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import optax
from flax import linen as nn
from protocol import read_job, write_answer

from kinetix.environment import (
    ActionType,
    EnvParams,
    ObservationType,
    UEDParams,
    make_kinetix_env,
    sample_kinetix_level,
    static_env_params_from_size,
)

SIZES = (3, 3, 3, 3, 2, 2)
"""Choices of the six parts of a multi-discrete action."""
GAMMA, LAMBDA, CLIP, ENTROPY, VALUE = 0.995, 0.9, 0.2, 0.01, 0.5
OURS = "kinetix-editor"
OPTIMISER = optax.chain(optax.clip_by_global_norm(1.0), optax.adam(1e-3, eps=1e-5))
Step = Callable[[jax.Array, Any, Any, jax.Array], Any]
"""Keys, observations, states and actions to what `env.step` returns."""


class Head(nn.Module):
    """Logits and value from an embedding."""

    @nn.compact
    def __call__(self, x: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Apply two layers each for policy and value."""
        actor = critic = x
        for _ in range(2):
            actor, critic = nn.tanh(nn.Dense(128)(actor)), nn.tanh(nn.Dense(128)(critic))
        return nn.Dense(sum(SIZES))(actor), nn.Dense(1)(critic)[..., 0]


class Flat(nn.Module):
    """For the flat observation."""

    @nn.compact
    def __call__(self, x: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Return one layer, then the head."""
        return Head()(nn.relu(nn.Dense(128)(x)))


class Entity(nn.Module):
    """For the entity observation: bodies attend to bodies; joints and thrusters send messages."""

    width: int = 64

    @nn.compact
    def __call__(self, seen: Any) -> tuple[jax.Array, jax.Array]:
        """Encode, attend twice, average over the active bodies."""

        def encode(rows: jax.Array) -> jax.Array:
            return nn.tanh(nn.Dense(self.width)(rows))

        x = jnp.concatenate([encode(seen.polygons), encode(seen.circles)], axis=-2)
        active = jnp.concatenate([seen.polygon_mask, seen.circle_mask], axis=-1)
        mask = jnp.repeat(seen.attention_mask, 2, axis=-3)
        count = x.shape[-2]
        joints, thrusters = encode(seen.joints), encode(seen.thrusters)
        a, b = (jax.nn.one_hot(seen.joint_indexes[..., side], count) for side in (0, 1))
        carrier = jax.nn.one_hot(seen.thruster_indexes, count)
        for _ in range(2):
            attention = nn.MultiHeadDotProductAttention(num_heads=8, qkv_features=16)
            x = x + nn.relu(attention(nn.LayerNorm()(x), mask=mask))
            x = x + nn.relu(nn.Dense(self.width)(nn.LayerNorm()(x)))
            pair = jnp.concatenate([a @ x, b @ x, joints], axis=-1)
            sent = nn.Dense(self.width)(pair) * seen.joint_mask[..., None]
            thrust = nn.Dense(self.width)(jnp.concatenate([carrier @ x, thrusters], axis=-1))
            thrust = thrust * seen.thruster_mask[..., None]
            x = x + jnp.swapaxes(a, -1, -2) @ sent + jnp.swapaxes(carrier, -1, -2) @ thrust
        weight = active.astype(x.dtype)[..., None]
        return Head()(jnp.sum(x * weight, axis=-2) / jnp.maximum(jnp.sum(weight, axis=-2), 1.0))


NETWORKS: dict[str, tuple[nn.Module, Any]] = {
    "flat": (Flat(), ObservationType.SYMBOLIC_FLAT),
    "entity": (Entity(), ObservationType.SYMBOLIC_ENTITY),
}


def make_env(observation: Any, physics: str, *, size: str = "s", random: bool = True) -> Any:
    """Return the environment on random levels of a size, or on one, at the published frame skip."""
    static = static_env_params_from_size(size).replace(frame_skip=2)
    if is_ours():
        static = static.replace(physics=physics)
    params, options = EnvParams(), (ActionType.MULTI_DISCRETE, observation)
    engine = make_kinetix_env(*options, None, params, static).physics_engine

    def reset(key: jax.Array) -> Any:
        return sample_kinetix_level(key, engine, params, static, UEDParams())

    level = None if random else jax.jit(reset)(jax.random.PRNGKey(0))
    start = reset if random else lambda _: level
    return make_kinetix_env(*options, start, params, static), params


def is_ours() -> bool:
    """Return whether this is our own Python."""
    try:
        importlib.metadata.version(OURS)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


def by_part(logits: jax.Array) -> list[jax.Array]:
    """Return log-probabilities of each part of the action."""
    edges = [sum(SIZES[:index]) for index in range(1, len(SIZES))]
    return [nn.log_softmax(part) for part in jnp.split(logits, edges, axis=-1)]


def log_prob(logits: jax.Array, action: jax.Array) -> jax.Array:
    """Return the log-probability of a whole action."""
    chosen = [
        jnp.take_along_axis(part, action[..., index, None], axis=-1)[..., 0]
        for index, part in enumerate(by_part(logits))
    ]
    return sum(chosen[1:], chosen[0])


def loss(network: nn.Module, params: Any, batch: Any) -> jax.Array:
    """PPO's objective on a minibatch."""
    seen, action, old_log_prob, old_value, advantage, target = batch
    logits, value = network.apply(params, seen)
    ratio = jnp.exp(log_prob(logits, action) - old_log_prob)
    advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
    clipped = jnp.clip(ratio, 1 - CLIP, 1 + CLIP)
    policy = -jnp.minimum(ratio * advantage, clipped * advantage).mean()
    near = old_value + jnp.clip(value - old_value, -CLIP, CLIP)
    critic = 0.5 * jnp.maximum((value - target) ** 2, (near - target) ** 2).mean()
    entropy = -sum((jnp.exp(part) * part).sum(-1) for part in by_part(logits)).mean()
    return policy + VALUE * critic - ENTROPY * entropy


def play(network: nn.Module, step: Step, params: Any, carry: Any, key: jax.Array) -> tuple:
    """Play one step of all environments; returns it and the row to learn from."""
    seen, state = carry
    act_key, step_key = jax.random.split(key)
    logits, value = network.apply(params, seen)
    keys = jax.random.split(act_key, len(SIZES))
    drawn = [jax.random.categorical(k, p) for k, p in zip(keys, by_part(logits), strict=True)]
    action = jnp.stack(drawn, axis=-1)
    keys = jax.random.split(step_key, value.shape[0])
    following, state, reward, done, _ = step(keys, seen, state, action)
    row = (seen, action, log_prob(logits, action), value, reward, done)
    return (following, state), row


def advantages(last: jax.Array, value: jax.Array, reward: jax.Array, done: jax.Array) -> Any:
    """Generalised advantages, with the value after the last step."""

    def back(carry: Any, row: Any) -> Any:
        advantage, next_value = carry
        value, reward, done = row
        goes_on = 1.0 - done
        error = reward + GAMMA * next_value * goes_on - value
        advantage = error + GAMMA * LAMBDA * goes_on * advantage
        return (advantage, value), advantage

    rows = (value, reward, done.astype(jnp.float32))
    return jax.lax.scan(back, (jnp.zeros_like(last), last), rows, reverse=True)[1]


def update(network: nn.Module, step: Step, job: dict[str, Any], carry: Any) -> tuple[Any, Any]:
    """Play, then learn from it: (what there is after, the mean loss)."""
    params, memory, seen, state, key = carry
    key, play_key, learn_key = jax.random.split(key, 3)
    (seen, state), rows = jax.lax.scan(
        functools.partial(play, network, step, params),
        (seen, state),
        jax.random.split(play_key, job["steps"]),
    )
    looked, action, chosen, value, reward, done = rows
    advantage = advantages(network.apply(params, seen)[1], value, reward, done)
    batch = (looked, action, chosen, value, advantage, advantage + value)

    def epoch(learner: Any, key: jax.Array) -> Any:
        order = jax.random.permutation(key, value.shape[1])

        def split(x: jax.Array) -> jax.Array:
            shuffled = x[:, order].reshape(job["steps"], job["minibatches"], -1, *x.shape[2:])
            return jnp.moveaxis(shuffled, 1, 0)

        def gradient_step(learner: Any, part: Any) -> Any:
            params, memory = learner
            lost, gradient = jax.value_and_grad(functools.partial(loss, network))(params, part)
            change, memory = OPTIMISER.update(gradient, memory, params)
            return (optax.apply_updates(params, change), memory), lost

        return jax.lax.scan(gradient_step, learner, jax.tree.map(split, batch))

    keys = jax.random.split(learn_key, job["epochs"])
    (params, memory), lost = jax.lax.scan(epoch, (params, memory), keys)
    return (params, memory, seen, state, key), lost.mean()


def make_update(job: dict[str, Any]) -> tuple[Any, Any]:
    """(the state before the first update, a compiled update)."""
    network, observation = NETWORKS[job["network"]]
    env, env_params = make_env(observation, job.get("physics", "balanced"))
    count = job["environments"]

    @jax.jit
    def start(key: jax.Array) -> Any:
        seen, state = jax.vmap(env.reset, in_axes=(0, None))(
            jax.random.split(key, count), env_params
        )
        params = network.init(key, seen)
        return params, OPTIMISER.init(params), seen, state, key

    def step(keys: jax.Array, seen: Any, state: Any, action: jax.Array) -> Any:
        if job.get("free"):
            return seen, state, jnp.zeros(count), jnp.zeros(count, bool), {}
        return jax.vmap(env.step, in_axes=(0, 0, 0, None))(keys, state, action, env_params)

    return start(jax.random.PRNGKey(0)), jax.jit(lambda carry: update(network, step, job, carry)[0])


def main() -> None:
    """Do the job."""
    job, folder = read_job()
    carry, update = make_update(job)
    seconds = []
    for _ in range(job["updates"] + 1):
        began = time.perf_counter()
        carry = jax.block_until_ready(update(carry))
        seconds.append(time.perf_counter() - began)
    first, *rest = seconds
    steps = job["environments"] * job["steps"]
    answer = {
        "engine": "kinetix" if is_ours() else "kinetix-env",
        "version": importlib.metadata.version(OURS if is_ours() else "kinetix-env"),
        "jax": importlib.metadata.version("jax"),
        "steps_per_s": steps / statistics.median(rest),
        "compile_s": first,
        "finite": bool(jnp.isfinite(jax.tree.leaves(carry[0])[0]).all()),
    }
    write_answer(folder, answer)


if __name__ == "__main__":
    main()
