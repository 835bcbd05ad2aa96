"""Measure how hard the bundled levels are for a search: `python -m scripts.difficulty [NAME …]`.

The measure is the number of plans that a win takes on average. Each level is played by 256 random
plans; where some of them win, 256 divided by their number is the answer. Where none does, the
search a stretch at a time goes on, one pass counting as 256 plans more, at most `PASSES` times.
Results go to scripts/library/difficulty.json, from which `scripts.build_levels` makes the levels'
tags. A level that has changed since is graded by its builder's estimate until it is measured again.
Without names, all levels are measured that have not been as they are.
"""

import functools
import json
import sys
from collections.abc import Iterator
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from kinetix.environment.env import KinetixEnv
from kinetix.environment.plans import channels_in_use, random_plans
from kinetix.environment.replay import play_actions
from kinetix.environment.reset import level_state
from kinetix.environment.search import ROWS, solving_env
from kinetix.environment.state import EnvState
from kinetix.environment.stretches import BATCH, Task, stretches
from kinetix.level.codec import level_hash, load_level
from kinetix.level.model import Level
from kinetix.level.sets import level_files
from kinetix.paths import levels_dir
from scripts.library.grades import MEASURED, Effort, read_efforts, write_efforts

PHYSICS: Final = "balanced"
PASSES: Final = 4
"""How often the search goes through a level that no random plan wins."""


def chosen(names: list[str]) -> Iterator[tuple[str, Level]]:
    """The levels to measure by name, such as `s/hang_on`."""
    efforts = read_efforts()
    for size in ("s", "m", "l"):
        for path in level_files(levels_dir() / size):
            name, level = f"{size}/{path.stem}", load_level(path)
            known = name in efforts and efforts[name].level == level_hash(level)
            if name in names or not (names or known):
                yield name, level


def effort_of(level: Level) -> Effort:
    """Play random plans, and search where none of them wins."""
    # Compiled for this level alone: at size l, playing with all that others need costs more.
    env = solving_env([level], physics=PHYSICS)

    def wins(actions: Int[np.ndarray, "k 6"]) -> bool:
        return play_actions(level, actions.tolist(), physics=PHYSICS).outcome == "won"

    task = Task(
        env=env,
        start=level_state(level, env.static_env_params),
        limit=level.max_timesteps,
        channels=channels_in_use(level),
        random=np.random.default_rng(0),
        wins=wins,
    )
    plans = random_plans(task.random, BATCH, task.limit, task.channels)
    padded = np.pad(plans, ((0, 0), (0, -plans.shape[1] % ROWS), (0, 0)))
    lucky = int(np.asarray(_won(env, task.start, jnp.asarray(padded))).sum())
    passes = 0
    if not lucky:
        passes = next(
            (
                count
                for count, found in zip(range(1, PASSES + 1), stretches(task), strict=False)
                if found.actions is not None
            ),
            PASSES + 1,
        )
    return Effort(level=level_hash(level), plans=BATCH, lucky=lucky, passes=passes)


@functools.partial(jax.jit, static_argnums=0)
def _won(env: KinetixEnv, start: EnvState, plans: Int[Array, "n k 6"]) -> Bool[Array, " n"]:
    """Which plans win, each played to the end of its episode."""
    count, limit = plans.shape[:2]
    step = jax.vmap(env.step, in_axes=(None, 0, 0))
    key = jax.random.key(0)  # nothing in a step of one level is random

    def going_on(carry: tuple[Any, ...]) -> Array:
        t, _, over, _ = carry
        return (t < limit) & ~jnp.all(over)

    def advance(carry: tuple[Any, ...]) -> tuple[Any, ...]:
        t, state, over, won = carry
        _, state, _, ended, info = step(key, state, plans[:, t])
        return t + 1, state, over | ended | info["nan"], won | (~over & info["GoalR"])

    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *jnp.shape(x))), start)
    no = jnp.zeros(count, bool)
    return jax.lax.while_loop(going_on, advance, (jnp.int32(0), states, no, no))[3]


def main(names: list[str]) -> None:
    """Measure the named levels, or all, and keep what comes out."""
    for name, level in chosen(names):
        effort = effort_of(level)
        # After each level, so that nothing is lost when it is stopped.
        write_efforts(read_efforts() | {name: effort})
        sys.stdout.write(f"{name}: {json.dumps(effort.tree())}\n")
        sys.stdout.flush()
        jax.clear_caches()
    sys.stdout.write(f"{MEASURED}\n")


if __name__ == "__main__":
    main(sys.argv[1:])
