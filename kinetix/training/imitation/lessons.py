"""Demonstrations played again: every moment of the wins, with what was done and what it was worth.

What is kept of a moment is where the bodies are; observations are made of it when it is learnt
from, so that memory does not depend on what the agent sees.
"""

import dataclasses
import functools
from collections.abc import Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from kinetix.environment.actions import MultiDiscreteActions
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.pytree import pytree
from kinetix.training.imitation.sources import Demonstration

BATCH: Final = 128
"""Episodes that are played again at once."""
_ROWS: Final = 64
"""Episodes are padded to a multiple of so many steps."""
_KEPT: Final = ("position", "rotation", "velocity", "angular_velocity", "touching")


@pytree
class Lessons:
    """All moments; axes: moment, episode."""

    starts: EnvState
    """First states of the episodes; axis 0 episodes."""
    episode: Int[Array, " r"]
    """Index of the episode that a moment belongs to."""
    moving: dict[str, Array]
    """Poses and speeds of the bodies, and pairs that touch."""
    timestep: Int[Array, " r"]
    action: Int[Array, "r 6"]
    worth: Float[Array, " r"]
    """Discounted reward from there to the end."""

    @property
    def count(self) -> int:
        """Number of moments."""
        return self.episode.shape[0]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Replayed:
    """Results of playing demonstrations again."""

    lessons: Lessons
    episodes: int
    lost: tuple[int, ...]
    """Indices of the episodes that are not won here any more; they are left out."""


class NothingWonError(KinetixError):
    """No demonstration wins under the present physics."""


def played_again(env: KinetixEnv, episodes: Sequence[Demonstration], *, gamma: float) -> Replayed:
    """Play demonstrations again and keep the moments of those that win.

    Args:
        env: Where; its observations, actions and reset function do not matter.
        episodes: The demonstrations, in slots of the environment's size.
        gamma: Discount a step.

    Raises:
        NothingWonError: None of the demonstrations wins.
    """
    env = _replaying(env)
    parts: list[dict[str, Any]] = []
    starts: list[EnvState] = []
    lost: list[int] = []
    for first in range(0, len(episodes), BATCH):
        batch = episodes[first : first + BATCH]
        filled = [*batch, *[batch[0]] * (BATCH - len(batch))]
        states = jax.tree.map(lambda *x: np.stack(x), *(each.state for each in filled))
        longest = max(len(each.actions) for each in batch)
        actions = np.zeros((BATCH, -(-longest // _ROWS) * _ROWS, 6), np.int32)
        for row, each in enumerate(filled):
            actions[row, : len(each.actions)] = each.actions
        told = jax.device_get(_replay(env, states, jnp.asarray(actions)))
        for row, each in enumerate(batch):
            part = _won_part(told, row, actions[row], gamma)
            if part is None:
                lost.append(first + row)
                continue
            part["episode"] = np.full(len(part["worth"]), len(starts), np.int32)
            parts.append(part)
            starts.append(each.state)
    if not parts:
        raise NothingWonError(
            f"none of the {len(episodes)} demonstrations wins under this physics; record them "
            "again with `kinetix teach`"
        )
    joined = jax.tree.map(lambda *x: np.concatenate(x), *parts)
    lessons = Lessons(
        starts=jax.tree.map(lambda *x: np.stack(x), *starts),
        episode=joined["episode"],
        moving=joined["moving"],
        timestep=joined["timestep"],
        action=joined["action"],
        worth=joined["worth"],
    )
    return Replayed(lessons=lessons, episodes=len(starts), lost=tuple(lost))


def _replaying(env: KinetixEnv) -> KinetixEnv:
    """The environment for recorded actions, which are multi-discrete; it ends its episodes."""
    kind = env.actions
    recorded = MultiDiscreteActions(
        motor_bindings=kind.motor_bindings, thruster_bindings=kind.thruster_bindings
    )
    return dataclasses.replace(env, actions=recorded, reset_fn=None, auto_reset=False)


@functools.partial(jax.jit, static_argnums=0)
def _replay(env: KinetixEnv, states: EnvState, actions: Int[Array, "n t 6"]) -> dict[str, Array]:
    """Every moment of every episode: state before the step, reward, whether it won or ended."""
    key = jax.random.key(0)  # nothing in a step of one level is random

    def advance(state: EnvState, action: Array) -> tuple[EnvState, dict[str, Any]]:
        before = {name: getattr(state.physics, name) for name in _KEPT}
        _, after, reward, done, info = jax.vmap(env.step, in_axes=(None, 0, 0))(key, state, action)
        told = {"moving": before, "timestep": state.timestep, "reward": reward}
        return after, told | {"done": done, "won": info["GoalR"]}

    states = jax.tree.map(lambda x: jnp.asarray(x, jnp.result_type(x)), states)
    return jax.lax.scan(advance, states, jnp.swapaxes(actions, 0, 1))[1]


def _won_part(
    told: dict[str, Any], row: int, actions: np.ndarray, gamma: float
) -> dict[str, Any] | None:
    """Return the moments of one episode up to its win; None where it is not won."""
    done = np.flatnonzero(told["done"][:, row])
    if not len(done) or not told["won"][done[0], row]:
        return None
    end = int(done[0]) + 1
    worth = np.zeros(end, np.float32)
    rest = 0.0
    for k in range(end - 1, -1, -1):
        rest = float(told["reward"][k, row]) + gamma * rest
        worth[k] = rest
    return {
        "moving": {name: x[:end, row] for name, x in told["moving"].items()},
        "timestep": told["timestep"][:end, row],
        "action": actions[:end],
        "worth": worth,
    }


def state_at(lessons: Lessons, rows: Int[Array, " n"]) -> EnvState:
    """Return the states of some moments.

    Args:
        lessons: All of them.
        rows: Which.
    """
    chosen = jax.tree.map(lambda x: jnp.asarray(x)[rows], (lessons.episode, lessons.moving))
    episode, moving = chosen
    start = jax.tree.map(lambda x: jnp.asarray(x)[episode], lessons.starts)
    physics = dataclasses.replace(start.physics, **moving)
    return dataclasses.replace(start, physics=physics, timestep=jnp.asarray(lessons.timestep)[rows])
