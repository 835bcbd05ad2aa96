"""PPO in one file, in the manner of PureJaxRL: copy it and change what you like.

Trains on random levels of a size, or on listed ones, and plots what it learnt:

    python examples/ppo.py --size s --steps 2_000_000
    python examples/ppo.py --levels s/goalkeeper s/plank_dash --steps 1_000_000 --seeds 3
"""

import argparse
import dataclasses
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import flax.linen as nn
import jax
import jax.numpy as jnp
import numpy as np
import optax
from flax.training.train_state import TrainState

from kinetix import (
    EnvParams,
    LogWrapper,
    make_kinetix_env,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
)
from kinetix.errors import one_sentence
from kinetix.files.folders import made_folder


@dataclasses.dataclass(frozen=True, kw_only=True)
class Config:
    """Hyper-parameters."""

    envs: int = 256
    rollout: int = 64
    steps: int = 2_000_000
    epochs: int = 4
    minibatches: int = 8
    width: int = 128
    lr: float = 5e-4
    gamma: float = 0.995
    gae_lambda: float = 0.9
    clip: float = 0.2
    entropy: float = 0.01
    value: float = 0.5
    max_grad_norm: float = 1.0

    @property
    def updates(self) -> int:
        """Rollouts in the whole training."""
        return max(1, self.steps // (self.envs * self.rollout))


class ActorCritic(nn.Module):
    """Two stacks of layers: the logits of all parts of an action, and the value."""

    logits: int
    width: int

    @nn.compact
    def __call__(self, obs: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Return the logits and the value."""

        def stack(outputs: int, gain: float) -> jax.Array:
            x = obs
            for _ in range(2):
                x = nn.tanh(nn.Dense(self.width, kernel_init=nn.initializers.orthogonal(2**0.5))(x))
            return nn.Dense(outputs, kernel_init=nn.initializers.orthogonal(gain))(x)

        return stack(self.logits, 0.01), stack(1, 1.0)[..., 0]


class Policy:
    """Independent choices whose logits lie one after the other (multi-discrete actions)."""

    def __init__(self, logits: jax.Array, sizes: tuple[int, ...]) -> None:
        bounds = np.cumsum(sizes)[:-1]
        self.parts = [jax.nn.log_softmax(part) for part in jnp.split(logits, bounds, axis=-1)]

    def sample(self, key: jax.Array) -> jax.Array:
        """Draw an action."""
        keys = jax.random.split(key, len(self.parts))
        drawn = [jax.random.categorical(k, p) for k, p in zip(keys, self.parts, strict=True)]
        return jnp.stack(drawn, axis=-1)

    def log_prob(self, action: jax.Array) -> jax.Array:
        """Log-probability of an action, summed over its parts."""
        each = [
            jnp.take_along_axis(part, action[..., index, None], axis=-1)[..., 0]
            for index, part in enumerate(self.parts)
        ]
        return sum(each[1:], start=each[0])

    def entropy(self) -> jax.Array:
        """Entropy, summed over the parts of an action."""
        each = [-jnp.sum(jnp.exp(part) * part, axis=-1) for part in self.parts]
        return sum(each[1:], start=each[0])


class Transition(NamedTuple):
    """One step of all environments."""

    obs: jax.Array
    action: jax.Array
    log_prob: jax.Array
    value: jax.Array
    reward: jax.Array
    done: jax.Array
    info: dict[str, jax.Array]


def make_env(size: str, levels: list[str], physics: str) -> tuple[Any, EnvParams]:
    """Return the environment on random levels of a size, or on listed levels that fit it."""
    env_params = EnvParams(dense_reward_scale=0.2)
    static = static_env_params_from_size(size, physics=physics)
    if levels:
        reset_fn = make_reset_fn_list_of_levels(levels, static)
    else:
        reset_fn = make_reset_fn_sample_kinetix_level(env_params, static)
    env = make_kinetix_env("multi_discrete", "symbolic_flat", reset_fn, env_params, static)
    return LogWrapper(env), env_params


def make_train(config: Config, env: Any, env_params: EnvParams) -> Callable[[jax.Array], Any]:
    """Return the whole training as one function of a key, to be compiled and mapped over seeds."""
    sizes = env.action_space(env_params).number_of_dims_per_distribution
    network = ActorCritic(sum(sizes), config.width)
    reset = jax.vmap(env.reset, in_axes=(0, None))
    step = jax.vmap(env.step, in_axes=(0, 0, 0, None))
    gradient_steps = config.updates * config.epochs * config.minibatches
    optimiser = optax.chain(
        optax.clip_by_global_norm(config.max_grad_norm),
        optax.adam(optax.linear_schedule(config.lr, 0.0, gradient_steps), eps=1e-5),
    )

    def play(carry: tuple[Any, ...], _: None) -> tuple[tuple[Any, ...], Transition]:
        state, env_state, obs, key = carry
        key, act_key, step_key = jax.random.split(key, 3)
        logits, value = network.apply(state.params, obs)
        policy = Policy(logits, sizes)
        action = policy.sample(act_key)
        keys = jax.random.split(step_key, config.envs)
        after, env_state, reward, done, info = step(keys, env_state, action, env_params)
        seen = Transition(obs, action, policy.log_prob(action), value, reward, done, info)
        return (state, env_state, after, key), seen

    def advantages(batch: Transition, last_value: jax.Array) -> jax.Array:
        def back(carry: tuple[jax.Array, jax.Array], t: Transition) -> tuple[Any, jax.Array]:
            advantage, following = carry
            goes_on = 1.0 - t.done
            error = t.reward + config.gamma * following * goes_on - t.value
            advantage = error + config.gamma * config.gae_lambda * goes_on * advantage
            return (advantage, t.value), advantage

        start = (jnp.zeros_like(last_value), last_value)
        return jax.lax.scan(back, start, batch, reverse=True)[1]

    def loss(params: Any, batch: Transition, advantage: jax.Array, target: jax.Array) -> jax.Array:
        logits, value = network.apply(params, batch.obs)
        policy = Policy(logits, sizes)
        ratio = jnp.exp(policy.log_prob(batch.action) - batch.log_prob)
        advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
        clipped = jnp.clip(ratio, 1 - config.clip, 1 + config.clip)
        actor = -jnp.minimum(ratio * advantage, clipped * advantage).mean()
        near = batch.value + jnp.clip(value - batch.value, -config.clip, config.clip)
        critic = 0.5 * jnp.maximum((value - target) ** 2, (near - target) ** 2).mean()
        return actor + config.value * critic - config.entropy * policy.entropy().mean()

    def learn(state: TrainState, minibatch: tuple[Any, ...]) -> tuple[TrainState, None]:
        return state.apply_gradients(grads=jax.grad(loss)(state.params, *minibatch)), None

    def update(carry: tuple[Any, ...], _: None) -> tuple[tuple[Any, ...], dict[str, jax.Array]]:
        carry, batch = jax.lax.scan(play, carry, length=config.rollout)
        state, env_state, obs, key = carry
        _, last_value = network.apply(state.params, obs)
        gained = advantages(batch, last_value)
        data = (batch._replace(info={}), gained, gained + batch.value)
        flat = jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), data)

        def epoch(state: TrainState, key: jax.Array) -> tuple[TrainState, None]:
            order = jax.random.permutation(key, config.envs * config.rollout)
            parts = jax.tree.map(
                lambda x: x[order].reshape(config.minibatches, -1, *x.shape[1:]), flat
            )
            return jax.lax.scan(learn, state, parts)

        key, shuffle_key = jax.random.split(key)
        state, _ = jax.lax.scan(epoch, state, jax.random.split(shuffle_key, config.epochs))
        ended = batch.info["returned_episode"]
        count = jnp.maximum(ended.sum(), 1)
        metrics = {
            "return": (batch.info["returned_episode_returns"] * ended).sum() / count,
            "solved": (batch.info["returned_episode_solved"] * ended).sum() / count,
        }
        return (state, env_state, obs, key), metrics

    def train(key: jax.Array) -> tuple[Any, dict[str, jax.Array]]:
        key, init_key, reset_key = jax.random.split(key, 3)
        obs, env_state = reset(jax.random.split(reset_key, config.envs), env_params)
        params = network.init(init_key, obs)
        state = TrainState.create(apply_fn=network.apply, params=params, tx=optimiser)
        carry, metrics = jax.lax.scan(update, (state, env_state, obs, key), length=config.updates)
        return carry[0].params, metrics

    return train


def plot(solved: np.ndarray, config: Config, file: Path) -> None:
    """Draw the share of solved episodes, one line per seed."""
    import matplotlib.pyplot as plt

    steps = np.arange(1, solved.shape[1] + 1) * config.envs * config.rollout
    figure, axes = plt.subplots(figsize=(6, 4))
    axes.plot(steps, solved.T)
    axes.set(xlabel="environment steps", ylabel="solved", ylim=(0, 1))
    figure.savefig(file, dpi=120, bbox_inches="tight")
    print(file)


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="s")
    parser.add_argument("--levels", nargs="*", default=[])
    parser.add_argument("--physics", default="balanced")
    parser.add_argument("--steps", type=int, default=Config.steps)
    parser.add_argument("--envs", type=int, default=Config.envs)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--plot", type=Path, help="a PNG (needs matplotlib)")
    arguments = parser.parse_args()
    for word in ("steps", "envs", "seeds"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")
    if arguments.plot:
        if arguments.plot.suffix.lower() not in (".png", ".svg", ".pdf"):
            parser.error(f"--plot {arguments.plot}: expected a name that ends in .png")
        made_folder(arguments.plot.parent)

    config = Config(steps=arguments.steps, envs=arguments.envs)
    env = make_env(arguments.size, arguments.levels, arguments.physics)
    train = make_train(config, *env)
    began = time.perf_counter()
    keys = jax.random.split(jax.random.key(0), arguments.seeds)
    # On a GPU jax.vmap(train) takes all seeds at once; a processor is as fast one after the other.
    run = jax.jit(train)
    solved = np.stack([np.asarray(run(key)[1]["solved"]) for key in keys])
    last = solved[:, -max(1, config.updates // 10) :].mean(axis=1)
    took = time.perf_counter() - began
    print(f"{config.updates} updates in {took:.0f} s, compilation included")
    print("solved at the end, per seed: " + " ".join(f"{rate:.2f}" for rate in last))
    if arguments.plot:
        plot(solved, config, arguments.plot)


if __name__ == "__main__":
    with one_sentence():
        main()
