"""Levels made or judged by the environment: mutations, and how a level plays without a plan."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from editor.worker.requests import (
    MUTATIONS,
    CheckDynamics,
    DynamicsReport,
    Mutate,
    Progress,
    RandomLevel,
)
from editor.worker.simulation.stepping import environment, start_state
from kinetix.environment.env import KinetixEnv
from kinetix.environment.replay import play_actions
from kinetix.environment.state import EnvState
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of


def drawn(request: RandomLevel) -> Level:
    """Return a random level; the same seed gives the same level."""
    # Imported on use: the generators are large and play does not need them.
    if request.machine:
        from kinetix.environment.generators.machines import random_machines

        return next(random_machines(request.seed, request.size, 1))
    from kinetix.environment.generators.documents import random_level

    return random_level(request.seed, request.size)


def mutated(request: Mutate) -> Level:
    """A mutation of a level: the named one, or the first of a random order that changes anything.

    Raises:
        KinetixError: No mutation has this name.
    """
    from kinetix.environment.generators.documents import mutate_level

    if request.mutation is not None:
        return mutate_level(request.level, request.mutation, request.seed)
    names = [name for name, _ in MUTATIONS]
    for k in np.random.default_rng(request.seed).permutation(len(names)):
        level = mutate_level(request.level, names[k], request.seed)
        if level != request.level:
            return level
    return request.level


def check_dynamics(request: CheckDynamics, progress: Progress) -> DynamicsReport:
    """Play a level with no action, then at random.

    Raises:
        KinetixError: The level does not fit its size.
    """
    level = request.level
    progress.report(0.0, "Playing without any action")
    noop = play_actions(level, [(0,) * 6] * level.max_timesteps, physics=request.physics)
    progress.report(0.3, f"Playing {request.attempts} times at random")
    env = environment(capacity_of(level), request.physics)
    state = start_state(level, request.physics)
    won = _random_play(env, state, request.attempts, level.max_timesteps)
    return DynamicsReport(
        noop_outcome=noop.outcome,
        noop_steps=noop.steps,
        random_solved=float(np.mean(won)),
        attempts=request.attempts,
    )


@functools.partial(jax.jit, static_argnums=(0, 2))
def _random_play(
    env: KinetixEnv, state: EnvState, attempts: int, limit: Int[Array, ""] | int
) -> Bool[Array, " n"]:
    """Mark the random plays of a level that win."""
    keys = jax.random.split(jax.random.key(0), attempts)
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (attempts, *x.shape)), state)
    no = jnp.zeros(attempts, bool)

    def going_on(loop: tuple[Array, EnvState, Array, Array]) -> Array:
        step, _, over, _ = loop
        return (step < limit) & ~jnp.all(over)

    def advance(
        loop: tuple[Array, EnvState, Array, Array],
    ) -> tuple[Array, EnvState, Array, Array]:
        step, states, over, won = loop
        now = jax.vmap(jax.random.fold_in, in_axes=(0, None))(keys, step)
        actions = jax.vmap(env.actions.random_action)(now)
        _, states, _, done, info = jax.vmap(env.step)(now, states, actions)
        return step + 1, states, over | done, won | (info["GoalR"] & ~over)

    return jax.lax.while_loop(going_on, advance, (jnp.int32(0), states, no, no))[3]
