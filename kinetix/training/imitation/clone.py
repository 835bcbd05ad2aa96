"""Behavioural cloning: the likelihood of what a teacher did, and a critic on what it got."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
from flax import linen as nn
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.agent import Agent
from kinetix.agents.networks.distributions import MultiCategorical
from kinetix.agents.networks.recurrent import initial_carry
from kinetix.agents.normalisation import Normalisation, normalise, update
from kinetix.datasets.sources import check_source
from kinetix.pytree import pytree
from kinetix.training.config import BcConfig
from kinetix.training.imitation.lessons import Lessons, played_again, state_at
from kinetix.training.imitation.sources import demonstrations, digest_of
from kinetix.training.ppo.update import GRADIENT, Learner
from kinetix.training.setup import Setup, make_setup
from kinetix.training.work import Work
from kinetix.wording import plural

_UPDATE = "update"
_ENOUGH_LEVELS = 5
"""Whole levels are kept back where they would be at least so many."""
_SAMPLE = 4096
"""Moments of which the statistics of observations are taken."""


@pytree
class CloneState:
    """Everything that an update changes."""

    learner: Learner
    statistics: Normalisation | None
    key: Array


class Clone:
    """Learns from demonstrations; an update is `num_minibatches` gradient steps."""

    def __init__(self, config: BcConfig, teacher: Agent | None = None) -> None:
        """Play the demonstrations again; no gradient step is compiled yet.

        Args:
            config: The configuration, already checked.
            teacher: The agent to start from.

        Raises:
            KinetixError: The demonstrations leave nothing to learn from.
        """
        steps = config.num_updates * config.num_minibatches
        setup = make_setup(config, gradient_steps=steps, teacher=teacher)
        self._config, self._teacher = config, teacher
        self.work = Work()
        self.parts_per_update = {_UPDATE: 1.0}
        self._passed_over = [each for source in config.data for each in check_source(source)]
        static_env_params, tell = setup.env.static_env_params, self._passed_over.append
        episodes = demonstrations(config.data, static_env_params, tell)
        self.setup: Setup = dataclasses.replace(setup, levels=digest_of(episodes))
        random = np.random.default_rng(config.seed)
        random.shuffle(episodes)  # pyright: ignore[reportArgumentType]
        self.played = played_again(setup.env, episodes, gamma=config.gamma)
        lessons = self.played.lessons
        lost = set(self.played.lost)
        names = [each.level for index, each in enumerate(episodes) if index not in lost]
        self.kept_back = kept_back(names, config.held_out, random)
        judged = np.isin(lessons.episode, self.kept_back.episodes)
        self._train_rows = np.flatnonzero(~judged)
        held_out = random.permutation(np.flatnonzero(judged))
        self._held_out = in_pieces(held_out, config.minibatch_size, config.num_minibatches)
        self._lessons = jax.device_put(lessons)
        self._update = jax.jit(self._one_update)
        self._judge = jax.jit(self._measured)

    @property
    def told(self) -> str:
        """Summary of the demonstrations, and a line for each file that was skipped."""
        played, held, levels = self.played, len(self.kept_back.episodes), self.kept_back.levels
        lost = f"; {len(played.lost)} are not won here and left out" if played.lost else ""
        others = f" of {plural(levels, 'other level')}" if levels else ""
        kept = f"{plural(held, 'demonstration')}{others} held out"
        kept = kept if held else "too few to hold any out"
        learnt = (
            f"learning from {plural(played.episodes, 'demonstration')} with "
            f"{plural(played.lessons.count, 'moment')}, {kept}{lost}"
        )
        return "\n".join([learnt, *(f"left out: {each}" for each in self._passed_over)])

    def start(self) -> CloneState:
        """Return the state before the first update."""
        key, learner_key, rows_key = jax.random.split(jax.random.PRNGKey(self._config.seed), 3)
        statistics = self.setup.start_statistics(self._teacher)
        if statistics is not None:
            rows = jax.random.choice(rows_key, jnp.asarray(self._train_rows), (_SAMPLE,))
            seen = jax.vmap(self.setup.env.get_obs)(state_at(self._lessons, rows))
            statistics = update(statistics, jax.tree.map(lambda x: x[None], seen))
        learner = self.setup.start_learner(learner_key, self._teacher)
        return CloneState(learner=learner, statistics=statistics, key=key)

    def update(self, state: Any) -> tuple[Any, dict[str, Array]]:
        """Learn from some minibatches.

        Args:
            state: From `start` or the last update.

        Returns:
            The next state, and metrics.
        """
        config = self._config
        key, rows_key = jax.random.split(state.key)
        shape = (config.num_minibatches, config.minibatch_size)
        rows = jax.random.choice(rows_key, jnp.asarray(self._train_rows), shape)
        learner, report = self.work(
            _UPDATE, self._update, self._lessons, state.learner, state.statistics, rows
        )
        if self._held_out.size:
            rows = jnp.asarray(self._held_out)
            judged = self._judge(self._lessons, learner, state.statistics, rows)
            report |= {f"held_out/{name}": value for name, value in judged.items()}
        return CloneState(learner=learner, statistics=state.statistics, key=key), report

    def _one_update(
        self,
        lessons: Lessons,
        learner: Learner,
        statistics: Normalisation | None,
        rows: Int[Array, "m n"],
    ) -> tuple[Learner, dict[str, Array]]:
        def gradient_step(
            learner: Learner, rows: Int[Array, " n"]
        ) -> tuple[Learner, dict[str, Array]]:
            differentiate = jax.value_and_grad(self._loss, has_aux=True)
            (_, report), gradient = differentiate(learner.params, lessons, statistics, rows)
            report[GRADIENT] = optax.tree.norm(gradient)
            change, state = self.setup.optimiser.update(gradient, learner.optimiser, learner.params)
            params = optax.apply_updates(learner.params, change)
            return dataclasses.replace(learner, params=params, optimiser=state), report

        learner, reports = jax.lax.scan(gradient_step, learner, rows)
        return learner, jax.tree.map(jnp.mean, reports)

    def _measured(
        self,
        lessons: Lessons,
        learner: Learner,
        statistics: Normalisation | None,
        rows: Int[Array, "m n"],
    ) -> dict[str, Array]:
        def of_piece(rows: Int[Array, " n"]) -> dict[str, Array]:
            return self._loss(learner.params, lessons, statistics, rows)[1]

        return jax.tree.map(jnp.mean, jax.lax.map(of_piece, rows))

    def _loss(
        self,
        params: Any,
        lessons: Lessons,
        statistics: Normalisation | None,
        rows: Int[Array, " n"],
    ) -> tuple[Array, dict[str, Array]]:
        config = self._config
        states = state_at(lessons, rows)
        observation = normalise(statistics, jax.vmap(self.setup.env.get_obs)(states))
        live = self.setup.game.live_controls(states)
        policy, value = _said(self.setup.game.network, params, observation, len(rows))
        action = lessons.action[rows]
        loss, agreement = imitation_loss(policy, action, live, smoothing=config.label_smoothing)
        critic = 0.5 * jnp.mean((value - lessons.worth[rows]) ** 2)
        report = {
            "loss/total": loss + config.vf_coef * critic,
            "loss/policy": loss,
            "loss/value": critic,
            "loss/entropy": jnp.mean(policy.restricted(live).entropy()),
            "loss/agreement": agreement,
        }
        return report["loss/total"], report


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeptBack:
    """Demonstrations that are measured and not learnt from."""

    episodes: Int[np.ndarray, " n"]
    """Their indices."""
    levels: int
    """Number of levels that they are of and nothing is learnt of; 0: of the same ones."""


def kept_back(names: Sequence[str], share: float, random: np.random.Generator) -> KeptBack:
    """Choose what is kept back: whole levels of many, as their episodes are much alike.

    Args:
        names: The level of each demonstration, the demonstrations in a random order.
        share: How many of the levels; where they are few, of the demonstrations.
        random: Chooses the levels.
    """
    levels = sorted(set(names))
    count = int(share * len(levels))
    if count < _ENOUGH_LEVELS:
        return KeptBack(episodes=np.arange(int(share * len(names))), levels=0)
    chosen = set(random.permutation(levels)[:count].tolist())
    episodes = [index for index, name in enumerate(names) if name in chosen]
    return KeptBack(episodes=np.array(episodes), levels=count)


def in_pieces(rows: Int[np.ndarray, " n"], size: int, most: int) -> Int[np.ndarray, "m k"]:
    """Return rows in equal pieces, the last one filled up with the first rows.

    Args:
        rows: Of more than fit into all pieces, the first ones.
        size: Rows of a piece at most.
        most: Pieces at most.
    """
    pieces = max(min(-(-len(rows) // size), most), 1)
    return np.resize(rows, (pieces, min(-(-len(rows) // pieces), size)))


def _said(
    network: nn.Module, params: Any, observation: Any, count: int
) -> tuple[MultiCategorical, Float[Array, " n"]]:
    """Return what a network says of moments that it has no memory of."""
    inputs = (jax.tree.map(lambda x: x[None], observation), jnp.ones((1, count), bool))
    output: Any = network.apply(params, initial_carry(count), inputs)
    _, policy, value = output
    return policy.replace(logits=policy.logits[0]), value[0]


def imitation_loss(
    policy: MultiCategorical,
    action: Int[Array, "n u"],
    live: Bool[Array, "n u"],
    *,
    smoothing: float,
) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Return the cross-entropy per live control, and how often the likeliest choice is the same.

    Args:
        policy: What the network says.
        action: What the teacher did.
        live: Controls that drive anything; the others say nothing about the policy.
        smoothing: Share of the target that is spread evenly over all choices, as a plan's choice
            is often one of several that are as good.
    """
    loss = jnp.zeros(action.shape[0])
    same = jnp.zeros(action.shape[0])
    for index, part in enumerate(policy.log_probs()):
        chosen = jax.nn.one_hot(action[:, index], part.shape[-1])
        target = (1 - smoothing) * chosen + smoothing / part.shape[-1]
        loss -= jnp.where(live[:, index], jnp.sum(target * part, axis=-1), 0.0)
        agrees = jnp.argmax(part, axis=-1) == action[:, index]
        same += jnp.where(live[:, index], agrees, False)
    controls = jnp.maximum(jnp.sum(live), 1)
    return jnp.sum(loss) / controls, jnp.sum(same) / controls
