"""Model-predictive play: a plan that is carried along, and improved every few decisions."""

import dataclasses
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, Shaped

from kinetix.agents.planner.futures import STRETCH, WAY, Futures, best_first, play_futures
from kinetix.agents.planner.proposals import CHANNELS, fresh_plans, varied_plans
from kinetix.agents.planner.simulator import Simulator
from kinetix.agents.player import Decision
from kinetix.environment.env import KinetixEnv
from kinetix.pytree import pytree

PLANS: Final = 32
"""Plans of a group."""
WHOLES: Final = (PLANS, PLANS // 2)
"""Plans of each group that are played as they are; the others are its beam."""
GROUPS: Final = len(WHOLES)
ELITE: Final = 4
"""Plans of a group that a round keeps."""
CHILDREN: Final = 9
"""Variations of them; all others are new, or of the beam."""
LENGTH: Final = 256
"""Of a plan [environment steps]."""
SHOWN: Final = 12
"""Futures of a group that are reported, from the best to mediocre ones."""
NOISE: Final = 0.05
"""Scale of the noise by which the beam chooses [m]."""


@pytree
class Outlook:
    """The futures that were tried when the planner last planned, for overlays."""

    ways: Float[Array, "n k 2"]
    """Ways of the green body from there [m]; the first is that of the plan chosen."""
    won: Bool[Array, " n"]
    lost: Bool[Array, " n"]
    steps: Int[Array, " n"]
    """Environment steps until it ended, or as far as it was played."""


@pytree
class Mind:
    """Memory that a planner carries from decision to decision, for one episode."""

    elite: Int[Array, "g k t 6"]
    """The best plans of each group from here on, the best first."""
    best: Int[Array, "t 6"]
    """The plan that is played, from here on."""
    score: Float[Array, ""]
    """Of that plan when it was last played through; see `Futures.score`."""
    age: Int[Array, ""]
    """Decisions since the episode began."""
    outlook: Outlook


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlannerPolicy:
    """Chooses by playing futures; see `player.Policy`.

    Its params are numbers of rounds: `rounds` whenever it plans again, `first` before its first
    move. A round plays `GROUPS` × `PLANS` plans.
    """

    every: int = 4
    """Decisions between two times that it plans."""
    horizon: int = 64
    """Length of its futures once it moves [environment steps]; at first, to the end of a plan."""

    rows = 1
    """Episodes that an evaluation plays at once: the futures fill the machine."""

    def init_carry(self, batch: int) -> Mind:
        """No plan yet: doing nothing."""
        return Mind(
            elite=jnp.zeros((batch, GROUPS, ELITE, LENGTH, 6), jnp.int8),
            best=jnp.zeros((batch, LENGTH, 6), jnp.int8),
            score=jnp.full(batch, jnp.inf),
            age=jnp.zeros(batch, jnp.int32),
            outlook=Outlook(
                ways=jnp.zeros((batch, GROUPS * SHOWN, WAY, 2), jnp.float16),
                won=jnp.zeros((batch, GROUPS * SHOWN), bool),
                lost=jnp.zeros((batch, GROUPS * SHOWN), bool),
                steps=jnp.zeros((batch, GROUPS * SHOWN), jnp.int32),
            ),
        )

    def decide(
        self,
        params: Any,
        carry: Mind,
        observation: Simulator,
        keys: Array,
        done: Bool[Array, " n"],
        *,
        deterministic: bool = False,
    ) -> Decision:
        """See `player.Policy`; `deterministic` changes nothing."""
        del deterministic

        def one(row: tuple[Mind, Simulator, Array, Array]) -> tuple[Array, Mind]:
            return self._decide_one(params, *row)

        rows = (carry, observation, keys, done)
        if keys.shape[0] == 1:
            taken = one(jax.tree.map(lambda x: x[0], rows))
            action, carry = jax.tree.map(lambda x: x[None], taken)
        else:
            action, carry = jax.lax.map(one, rows)
        return action, carry, {"outlook": carry.outlook}

    def _decide_one(
        self, params: Any, mind: Mind, simulator: Simulator, key: Array, begins: Array
    ) -> tuple[Array, Mind]:
        nothing = jax.tree.map(lambda x: x[0], self.init_carry(1))
        mind = jax.tree.map(lambda a, b: jnp.where(begins, a, b), nothing, mind)
        rounds = jnp.where(mind.age == 0, params["first"], params["rounds"])
        stretches = jnp.where(mind.age == 0, LENGTH, self.horizon) // STRETCH
        rounds = jnp.where(mind.age % self.every == 0, rounds, 0)
        env = simulator.env

        def going_on(loop: tuple[Array, Mind]) -> Array:
            index, mind = loop
            # A plan that wins is played through once more, from where the episode really is.
            return (index < rounds) & ((index == 0) | (mind.score >= 0))

        def think(loop: tuple[Array, Mind]) -> tuple[Array, Mind]:
            index, mind = loop
            round_key = jax.random.fold_in(key, index)
            return index + 1, _round(env, simulator, mind, round_key, stretches)

        _, mind = jax.lax.while_loop(going_on, think, (jnp.int32(0), mind))
        action = mind.best[0].astype(jnp.int32)
        return action, Mind(
            elite=_later(mind.elite),
            best=_later(mind.best),
            score=mind.score,
            age=mind.age + 1,
            outlook=mind.outlook,
        )


def _later(plans: Int[Array, "... t 6"]) -> Int[Array, "... t 6"]:
    """Plans a step on; their last action is held."""
    return jnp.concatenate([plans[..., 1:, :], plans[..., -1:, :]], axis=-2)


def _round(
    env: KinetixEnv, simulator: Simulator, mind: Mind, key: Shaped[Array, ""], stretches: Array
) -> Mind:
    """Play the best plans again, variations of them and new ones; keep the best."""
    state = simulator.state
    live = env.actions.live(state.world, state.labels)

    chance = jax.random.uniform(key, (GROUPS, PLANS, LENGTH + 1, 2 * CHANNELS))

    def propose(elite: Int[Array, "k t 6"], chance: Float[Array, "n t k"]) -> Int[Array, "n t 6"]:
        fresh = fresh_plans(chance[ELITE:, 1:], live)
        varied = varied_plans(chance[:CHILDREN, 0], elite, fresh[:CHILDREN], live)
        return jnp.concatenate([elite, varied, fresh[CHILDREN:]])

    plans = jax.vmap(propose)(mind.elite, chance)
    # All groups look after the plan that is played.
    plans = plans.at[:, 0].set(mind.best)
    # Distributed as gumbel numbers are: the beam draws its parents with odds, not by rank alone.
    noise = -NOISE * jnp.log(-jnp.log(chance[:, :, 1 : 1 + LENGTH // STRETCH, 0] + 1e-9))
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (GROUPS, *jnp.shape(x))), state)
    futures = play_futures(env, states, plans, noise, jnp.array(WHOLES), stretches)
    return _kept(mind, futures)


def _kept(mind: Mind, futures: Futures) -> Mind:
    order = jax.vmap(best_first)(futures.score)
    elite = jnp.take_along_axis(futures.plans, order[:, :ELITE, None, None], axis=1)
    group = jnp.argmin(jnp.min(futures.score, axis=1))
    return dataclasses.replace(
        mind,
        elite=elite,
        best=elite[group, 0],
        score=jnp.min(futures.score),
        outlook=_outlook(futures, order[:, : 2 * SHOWN : 2], group),
    )


def _outlook(futures: Futures, shown: Int[Array, "g k"], group: Array) -> Outlook:
    """Return some futures, those of one group first."""

    def told(x: Array) -> Array:
        taken = jnp.take_along_axis(x, shown.reshape(*shown.shape, *[1] * (x.ndim - 2)), axis=1)
        rolled = jnp.roll(taken, -group, axis=0)
        return rolled.reshape(-1, *taken.shape[2:])

    return Outlook(
        ways=told(futures.ways).astype(jnp.float16),
        won=told(futures.won),
        lost=told(futures.lost),
        steps=told(futures.steps),
    )
