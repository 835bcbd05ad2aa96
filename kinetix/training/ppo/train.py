"""PPO as one loop body: play, learn, report."""

from typing import Any, Final

import jax
from jaxtyping import Array

from kinetix.agents.agent import Agent
from kinetix.agents.normalisation import Normalisation
from kinetix.pytree import pytree
from kinetix.training.config import PpoConfig
from kinetix.training.ppo.rollout import Playing, episode_means, rollout
from kinetix.training.ppo.update import Learner
from kinetix.training.setup import make_setup
from kinetix.training.work import Work

_UPDATE: Final = "update"


@pytree
class PpoState:
    """Everything that an update changes: saving it and going on from it is exact."""

    learner: Learner
    statistics: Normalisation | None
    key: Array
    playing: Playing


class Ppo:
    """Trains on the levels that the environment's resets draw."""

    def __init__(self, config: PpoConfig, teacher: Agent | None = None) -> None:
        """Prepare; nothing is compiled yet.

        Args:
            config: The configuration, already checked.
            teacher: The agent to start from.
        """
        steps = config.num_updates * config.update_epochs * config.num_minibatches
        self.setup = make_setup(config, gradient_steps=steps, teacher=teacher)
        self.work = Work()
        self.parts_per_update = {_UPDATE: 1.0}
        self._teacher = teacher
        # Made in one compiled piece: the initialisers alone are dozens of small operations.
        self._start = jax.jit(self._first_state)
        self._update = jax.jit(self._one_update)

    def start(self) -> PpoState:
        """Return the state before the first update."""
        return self._start()

    def _first_state(self) -> PpoState:
        key, learner_key, playing_key = jax.random.split(
            jax.random.PRNGKey(self.setup.config.seed), 3
        )
        return PpoState(
            learner=self.setup.start_learner(learner_key, self._teacher),
            statistics=self.setup.start_statistics(self._teacher),
            key=key,
            playing=self.setup.start_playing(playing_key),
        )

    def update(self, state: Any) -> tuple[Any, dict[str, Array]]:
        """Do one rollout and learn from it.

        Args:
            state: From `start` or the last update.

        Returns:
            The next state, and metrics by their published names.
        """
        return self.work(_UPDATE, self._update, state)

    def _one_update(self, state: PpoState) -> tuple[PpoState, dict[str, Array]]:
        setup, learner = self.setup, state.learner
        key, play_key, learn_key = jax.random.split(state.key, 3)
        playing, played = rollout(
            setup.game,
            learner.params,
            state.playing,
            play_key,
            setup.config.num_steps,
            statistics=state.statistics,
        )
        learner, statistics, losses = setup.learn(learner, played, learn_key, state.statistics)
        following = PpoState(learner=learner, statistics=statistics, key=key, playing=playing)
        return following, episode_means(played.trajectory) | losses
