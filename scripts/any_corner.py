"""Teach an agent to say the same wherever lists of corners begin: `any_corner AGENT OUT LEVELS …`.

A student with the agent's parameters plays scenes whose polygons list their corners from a random
one on, and learns what the agent says of the same scenes as they are: every choice's probability,
and the value. The agent plays half of the environments, the student the other half. What is kept
is the average of the student's parameters over the last part of the training.

Source: Rusu et al., "Policy Distillation" (2016).
"""

import argparse
import dataclasses
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import jax
import jax.numpy as jnp
import optax
from jaxtyping import Array, Bool, Float, Int

from kinetix import load_agent, save_agent
from kinetix.agents.agent import Agent
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.engine.spec import ARENA_BODIES
from kinetix.errors import KinetixError
from kinetix.training.ppo.rollout import Game, Playing
from kinetix.training.settings import make_config, settings_of
from kinetix.training.setup import Setup, make_setup

ENVIRONMENTS: Final = 512
DECISIONS: Final = 8
"""Of each environment between two lessons."""
MINIBATCHES: Final = 2
EPOCHS: Final = 2
AS_THEY_ARE: Final = 0.2
"""Share of the scenes that the student sees unchanged."""
VALUE_WEIGHT: Final = 0.5
"""Of the squared difference of values beside the divergence."""
AVERAGED: Final = 0.3
"""Last share of the training, over which parameters are averaged."""
CORNERS: Final = 4


class Lesson(NamedTuple):
    """Scenes, and what the teacher says of them."""

    seen: Any
    logits: Float[Array, "n choices"]
    values: Float[Array, " n"]
    live: Bool[Array, "n u"]


def begun_elsewhere(key: Array, observation: Any) -> Any:
    """Return the same scenes with each list of corners rolled at random, the arena's as they are.

    Args:
        key: Random key.
        observation: `symbolic_entity` observations with one leading axis.
    """
    rows = observation.polygons
    first = observation.circles.shape[-1] - 2
    end = first + 2 * CORNERS
    corners = rows[..., first:end].reshape(*rows.shape[:-1], CORNERS, 2)
    used = jnp.where(rows[..., end] > 0.5, CORNERS - 1, CORNERS)
    roll_key, keep_key = jax.random.split(key)
    shift = jax.random.randint(roll_key, used.shape, 0, CORNERS * (CORNERS - 1))
    kept = jax.random.uniform(keep_key, (used.shape[0], 1)) < AS_THEY_ARE
    shift = jnp.where(kept | (jnp.arange(used.shape[-1]) < ARENA_BODIES), 0, shift)
    at: Int[Array, " c"] = jnp.arange(CORNERS)
    turned = (at + shift[..., None]) % used[..., None]
    index = jnp.where(at < used[..., None], turned, at)
    rolled = jnp.einsum("...ij,...jk->...ik", jax.nn.one_hot(index, CORNERS), corners)
    flat = rolled.reshape(*rows.shape[:-1], 2 * CORNERS)
    rows = jnp.concatenate([rows[..., :first], flat, rows[..., end:]], axis=-1)
    return observation._replace(polygons=rows)


def said(game: Game, params: Any, observation: Any) -> tuple[Any, Float[Array, " n"]]:
    """Return the policy and the values of one step of a batch."""
    count = observation.polygons.shape[0]
    inputs = jax.tree.map(lambda x: x[None], (observation, jnp.zeros(count, bool)))
    output: Any = game.network.apply(params, initial_carry(count), inputs)
    return output[1].replace(logits=output[1].logits[0]), output[2][0]


def make_play(setup: Setup, teacher: Any) -> Callable[[Any, Playing, Array], Any]:
    """Return what plays on: it gives the environments, and the scenes with the teacher's words."""
    game = setup.game
    is_teachers = jnp.arange(ENVIRONMENTS)[:, None] < ENVIRONMENTS // 2

    def step(params: Any, playing: Playing, key: Array) -> tuple[Playing, Lesson]:
        draw, roll, move = jax.random.split(key, 3)
        seen = playing.observation
        policy, values = said(game, teacher, seen)
        own, _ = said(game, params, begun_elsewhere(roll, seen))
        logits = jnp.where(is_teachers, policy.logits, own.logits)
        action = policy.replace(logits=logits).sample(draw)
        keys = jax.random.split(move, ENVIRONMENTS)
        observation, state, _, done, _ = jax.vmap(game.env.step, in_axes=(0, 0, 0, None))(
            keys, playing.env_state, action, None
        )
        lesson = Lesson(seen, policy.logits, values, game.live_controls(playing.env_state))
        playing = dataclasses.replace(
            playing, env_state=state, observation=observation, begins=done
        )
        return playing, lesson

    @jax.jit
    def play(params: Any, playing: Playing, key: Array) -> tuple[Playing, Lesson]:
        keys = jax.random.split(key, DECISIONS)
        playing, lessons = jax.lax.scan(partial(step, params), playing, keys)
        return playing, jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), lessons)

    return play


def make_learn(game: Game, optimiser: optax.GradientTransformation) -> Callable[..., Any]:
    """Return what learns from the scenes; it tells the mean divergence [nat]."""

    def loss(params: Any, lesson: Lesson, key: Array) -> tuple[Array, Array]:
        own, values = said(game, params, begun_elsewhere(key, lesson.seen))
        wanted = own.replace(logits=lesson.logits).restricted(lesson.live)
        apart = jnp.mean(wanted.divergence(own))
        return apart + VALUE_WEIGHT * jnp.mean((values - lesson.values) ** 2), apart

    def minibatch(carry: Any, drawn: tuple[Lesson, Array]) -> tuple[Any, Array]:
        params, state = carry
        (_, apart), gradient = jax.value_and_grad(loss, has_aux=True)(params, *drawn)
        change, state = optimiser.update(gradient, state, params)
        return (optax.apply_updates(params, change), state), apart

    @jax.jit
    def learn(params: Any, state: Any, lessons: Lesson, key: Array) -> tuple[Any, Any, Array]:
        def epoch(carry: Any, key: Array) -> tuple[Any, Array]:
            order = jax.random.permutation(key, len(lessons.values)).reshape(MINIBATCHES, -1)
            drawn = jax.tree.map(lambda x: x[order], lessons)
            keys = jax.random.split(jax.random.fold_in(key, 1), MINIBATCHES)
            return jax.lax.scan(minibatch, carry, (drawn, keys))

        (params, state), apart = jax.lax.scan(epoch, (params, state), jax.random.split(key, EPOCHS))
        return params, state, jnp.mean(apart)

    return learn


def taught(agent: Agent, levels: list[str], moments: int, rate: float, seed: int) -> Agent:
    """Return the student, averaged.

    Args:
        agent: A relational agent.
        levels: Folders, files and sets of levels.
        moments: Decisions that are learnt from.
        rate: Learning rate at the beginning; it falls to 0.
        seed: Of all that is drawn.

    Raises:
        KinetixError: The agent or the levels do not fit; the sentence says what.
    """
    values = settings_of(agent.card) | {
        "seed": seed,
        "size": "l",
        "level_mode": "list",
        "levels": levels,
        "physics": agent.card.environment.physics,
        "num_train_envs": ENVIRONMENTS,
        "num_steps": DECISIONS,
        "num_minibatches": MINIBATCHES,
        "bootstrap_on_timeout": False,
    }
    rounds = max(moments // (ENVIRONMENTS * DECISIONS), 1)
    setup = make_setup(make_config("ppo", values=values), gradient_steps=rounds, teacher=agent)
    teacher = {"params": agent.params["params"]}
    decay = optax.linear_schedule(rate, 0.0, rounds * EPOCHS * MINIBATCHES)
    optimiser = optax.chain(optax.clip_by_global_norm(1.0), optax.adam(decay, eps=1e-5))
    play, learn = make_play(setup, teacher), make_learn(setup.game, optimiser)
    key = jax.random.key(seed)
    playing = setup.start_playing(jax.random.fold_in(key, rounds))
    params, state = teacher, optimiser.init(teacher)
    average, averaged = params, 0
    for index in range(rounds):
        play_key, learn_key = jax.random.split(jax.random.fold_in(key, index))
        playing, lessons = play(params, playing, play_key)
        params, state, apart = learn(params, state, lessons, learn_key)
        if index % 10 == 0:
            print(f"round {index} of {rounds}: {float(apart):.3f} nat from the agent", flush=True)
        if index >= (1 - AVERAGED) * rounds:
            averaged += 1
            share = 1 / averaged
            average = jax.tree.map(lambda a, p, s=share: a + s * (p - a), average, params)
    facts = agent.card.training | {"any_corner": {"moments": moments, "learning_rate": rate}}
    return Agent(agent.card.replace(results={}, training=facts), average["params"])


def main() -> None:
    """Read the agent, teach the student, write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("agent")
    parser.add_argument("out", type=Path)
    parser.add_argument("levels", nargs="+")
    parser.add_argument("--moments", type=int, default=900_000)
    parser.add_argument("--learning-rate", type=float, default=3e-4)
    parser.add_argument("--seed", type=int, default=5)
    given = parser.parse_args()
    try:
        agent = load_agent(given.agent)
        student = taught(agent, given.levels, given.moments, given.learning_rate, given.seed)
        save_agent(student, given.out)
    except KinetixError as error:
        parser.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
