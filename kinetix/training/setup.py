"""From a configuration to the parts that every algorithm uses."""

import dataclasses
import hashlib
import json
from typing import Any

import jax
import jax.numpy as jnp
import msgspec
import optax
from jaxtyping import Array, Float

from kinetix.agents.agent import Agent
from kinetix.agents.card import (
    ActionCard,
    AgentCard,
    CapacityCard,
    EnvironmentCard,
    NormalisationCard,
    ObservationCard,
)
from kinetix.agents.from_card import init_parameters, network_of_card, observations_of_card
from kinetix.agents.normalisation import Normalisation, from_card, normalise, start, update
from kinetix.engine.spec import Features
from kinetix.environment.env import DummyEnv, KinetixEnv, ResetFunction, make_kinetix_env
from kinetix.environment.generators.filters import sample_filtered_levels
from kinetix.environment.generators.locomotion import locomotion_sampler
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.starts import mixed_sampler
from kinetix.environment.params import (
    EnvParams,
    StaticEnvParams,
    physics_engine,
    static_env_params_from_size,
    with_parity,
)
from kinetix.environment.rearrange import permute_state
from kinetix.environment.reset import (
    make_reset_fn_empty,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
    static_env_params_for_levels,
)
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.sets import SetLevel, gather_levels, training_part
from kinetix.training.config import PpoConfig
from kinetix.training.devices import OWN, check_divisible, on_each_device
from kinetix.training.imitation.starts import beginning_on_the_way, starts_on_the_way
from kinetix.training.ppo.rollout import Game, Playing, Rollout, begin
from kinetix.training.ppo.update import Learner, learn
from kinetix.training.schedule import make_optimiser


@dataclasses.dataclass(frozen=True, kw_only=True)
class Setup:
    """The parts: environment and network, optimiser, the agent's description."""

    config: PpoConfig
    game: Game
    optimiser: optax.GradientTransformation
    card: AgentCard
    """Describes the agent that is being trained; without name and results yet."""
    longest_episode: int
    """Environment steps of the longest episode that a level allows."""
    ued: UEDParams
    """Options of random levels and mutations."""
    levels: str
    """SHA-256 of the listed levels in their order, or of demonstrations; empty where levels are
    drawn."""
    different: int = 0
    """Number of different levels that can come to be played; 0: without end."""
    without_starts: tuple[str, ...] = ()
    """Listed levels of which no episode begins on the way of a win, though asked for."""

    @property
    def env(self) -> KinetixEnv:
        """The environment."""
        return self.game.env

    @property
    def reset_fn(self) -> ResetFunction:
        """Draws the level of an episode."""
        assert self.game.env.reset_fn is not None
        return self.game.env.reset_fn

    def fresh_levels(self, key: Array, count: int) -> EnvState:
        """Return levels from the reset function, without those that are won by doing nothing.

        Args:
            key: Random key.
            count: How many.
        """
        filtered = self.config.level_mode in ("random", "random_all")
        return self._drawn(key, count, self.reset_fn, self.env, filtered=filtered)

    def random_levels(self, key: Array, count: int) -> EnvState:
        """Random levels to measure an agent on: like those it is trained on, else of its size.

        Args:
            key: Random key.
            count: How many.
        """
        config, env_params = self.config, self.env.env_params
        if config.level_mode not in ("list", "empty"):
            return self.fresh_levels(key, count)
        # The step of a training on listed levels does nothing else.
        static = dataclasses.replace(self.env.static_env_params, features=Features())
        env: Any = make_kinetix_env(
            config.action_type, "blind", None, env_params, static, parity=config.parity
        )
        reset_fn = make_reset_fn_sample_kinetix_level(env_params, env.static_env_params, self.ued)
        return self._drawn(key, count, reset_fn, env, filtered=True)

    def _drawn(
        self, key: Array, count: int, reset_fn: ResetFunction, env: KinetixEnv, *, filtered: bool
    ) -> EnvState:
        config = self.config
        plays = filtered and config.filter_levels and not config.dummy_env
        return sample_filtered_levels(
            key,
            count,
            reset_fn,
            env,
            env.env_params,
            steps=config.level_filter_n_steps if plays else 0,
            ratio=config.level_filter_sample_ratio,
        )

    def arranged(self, levels: EnvState, key: Array) -> EnvState:
        """Stored levels as they are to be played: with entities in other slots, if so configured.

        Args:
            levels: The levels, on the first axis.
            key: Draws the arrangements.
        """
        if not self.config.permute_state_during_training:
            return levels
        return jax.vmap(permute_state)(jax.random.split(key, levels.timestep.shape[0]), levels)

    def start_learner(self, key: Array, teacher: Agent | None) -> Learner:
        """Return fresh parameters, or those of an agent to be fine-tuned, and a fresh optimiser.

        Args:
            key: Random key.
            teacher: The agent to start from.
        """
        tree = init_parameters(self.card, key) if teacher is None else teacher.params["params"]
        params = {"params": tree}
        learner = Learner(params=params, optimiser=self.optimiser.init(params))
        if not (self.config.teacher_coef or self.config.critic_warmup):
            return learner
        kept = jax.tree.map(jnp.copy, params) if self.config.teacher_coef else None
        return dataclasses.replace(learner, teacher=kept, age=jnp.zeros((), jnp.int32))

    def start_statistics(self, teacher: Agent | None) -> Normalisation | None:
        """Return statistics of observations, where they are normalised.

        Args:
            teacher: The agent to start from; its statistics go on.
        """
        if not self.config.rms_norm:
            return None
        card: NormalisationCard | None = None if teacher is None else teacher.card.normalisation
        if card is not None:
            return from_card(card)
        state = jax.eval_shape(self.reset_fn, jax.random.PRNGKey(0))
        shapes = jax.eval_shape(self.env.get_obs, state)
        return start(jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), shapes))

    def start_playing(self, key: Array) -> Playing:
        """Return all environments at the start of episodes from the reset function.

        Args:
            key: Random key.
        """
        playing = begin(self.game, key, self.config.num_train_envs)
        if not self.config.stagger_starts or self.config.parity is not None:
            return playing
        # Otherwise episodes that time out do so all at once, for a long while.
        spread = jax.random.uniform(jax.random.fold_in(key, 1), playing.begins.shape)
        return on_each_device(self._under_way, (OWN, OWN), OWN)(playing, spread)

    def _under_way(self, playing: Playing, spread: Float[Array, " n"]) -> Playing:
        """Episodes with a share of their time behind them.

        They do not begin any more: there curricula put their levels.
        """
        state = playing.env_state
        own = state.labels.max_timesteps
        limit = jnp.where(own > 0, own, self.env.env_params.max_timesteps)
        timestep = jnp.floor(spread * limit).astype(state.timestep.dtype)
        state = dataclasses.replace(state, timestep=timestep)
        return dataclasses.replace(playing, env_state=state, begins=jnp.zeros_like(playing.begins))

    def learn(
        self,
        learner: Learner,
        rollout: Rollout,
        key: Array,
        statistics: Normalisation | None,
    ) -> tuple[Learner, Normalisation | None, dict[str, Array]]:
        """Improve on a rollout, then take its observations into the statistics.

        Args:
            learner: Parameters and optimiser.
            rollout: What was played.
            key: Random key.
            statistics: What the rollout's observations were normalised by.
        """
        raw = rollout.trajectory.observation
        seen = dataclasses.replace(rollout.trajectory, observation=normalise(statistics, raw))
        rollout = dataclasses.replace(rollout, trajectory=seen)
        learner, report = learn(
            self.config, self.game.network, self.optimiser, learner, rollout, key
        )
        if statistics is not None:
            statistics = update(statistics, raw)
        return learner, statistics, report


def make_setup(config: PpoConfig, *, gradient_steps: int, teacher: Agent | None = None) -> Setup:
    """Put the parts together.

    Args:
        config: The configuration, already checked.
        gradient_steps: Gradient steps of the whole training, for learning-rate schedules.
        teacher: The agent to start from; its network, observation and action must be those of the
            configuration.

    Raises:
        KinetixError: Something does not fit; the message says what.
    """
    check_divisible(config)
    ued = UEDParams(legacy_ceiling=True) if config.parity == "kinetix-3" else UEDParams()
    static_env_params = static_env_params_from_size(
        config.size, frame_skip=config.frame_skip, physics=config.physics
    )
    listed: list[SetLevel] = []
    if config.level_mode == "list":
        listed = training_part(gather_levels(config.levels))
    if config.only_listed:
        static_env_params = static_env_params_for_levels(listed, static_env_params)
    env_params = EnvParams(dense_reward_scale=config.dense_reward_scale)
    card = _card(config, env_params, static_env_params)
    if teacher is not None:
        _check_teacher(teacher.card, card, config)
    reset_fn = _reset_function(config, env_params, static_env_params, ued, listed)
    env: Any = make_kinetix_env(
        action_type=config.action_type,
        observation_type=config.observation_type,
        reset_fn=reset_fn,
        env_params=env_params,
        static_env_params=static_env_params,
        keep_terminal_observation=config.bootstrap_on_timeout,
        parity=config.parity,
    )
    without_starts: tuple[str, ...] = ()
    if config.demo_starts and listed and not config.dummy_env:
        starts = starts_on_the_way(listed, env)
        reset_fn = beginning_on_the_way(reset_fn, starts, config.demo_starts)
        without_starts = starts.without
    env = dataclasses.replace(env, reset_fn=_shuffled(config, reset_fn))
    observations = observations_of_card(card, env_params, env.static_env_params)
    env = dataclasses.replace(env, observations=observations)
    if config.dummy_env:
        env = DummyEnv(env=env)
    game = Game(
        env=env,
        network=network_of_card(card),
        gamma=config.gamma,
        bootstrap_on_timeout=config.bootstrap_on_timeout and not config.dummy_env,
        masks_controls=config.parity is None,
    )
    return Setup(
        config=config,
        game=game,
        optimiser=make_optimiser(config, gradient_steps),
        card=card,
        longest_episode=max(
            [level.level.max_timesteps for level in listed], default=env_params.max_timesteps
        ),
        ued=ued,
        levels=_digest(listed),
        different=0 if config.permute_state_during_training or config.demo_starts else len(listed),
        without_starts=without_starts,
    )


def _digest(listed: list[SetLevel]) -> str:
    """Not of `level_hash`es, each of which takes a millisecond."""
    if not listed:
        return ""
    found = hashlib.sha256()
    for each in listed:
        found.update(msgspec.json.encode(each.level))
    return found.hexdigest()


def _shuffled(config: PpoConfig, reset_fn: ResetFunction) -> ResetFunction:
    """Return the reset function, with entities in other slots each time, if so configured."""
    if not config.permute_state_during_training:
        return reset_fn

    def reset(key: Array) -> EnvState:
        level_key, order_key = jax.random.split(key)
        return permute_state(order_key, reset_fn(level_key))

    return reset


def _card(
    config: PpoConfig, env_params: EnvParams, static_env_params: StaticEnvParams
) -> AgentCard:
    capacity = CapacityCard(
        polygons=static_env_params.num_polygons,
        circles=static_env_params.num_circles,
        joints=static_env_params.num_joints,
        thrusters=static_env_params.num_thrusters,
        motor_bindings=static_env_params.num_motor_bindings,
        thruster_bindings=static_env_params.num_thruster_bindings,
    )
    environment = EnvironmentCard(
        physics=config.physics,
        frame_skip=config.frame_skip,
        dt=env_params.dt,
        dense_reward_scale=config.dense_reward_scale,
        parity=config.parity,
    )
    return AgentCard(
        name="training",
        observation=ObservationCard(type=config.observation_type),
        action=ActionCard(type=config.action_type),
        capacity=capacity,
        network=config.network,
        environment=environment,
    )


def _check_teacher(teacher: AgentCard, card: AgentCard, config: PpoConfig) -> None:
    parts = ["network", "observation", "action"]
    if not teacher.plays_any_capacity:
        parts.append("capacity")
    for part in parts:
        have, need = getattr(teacher, part), getattr(card, part)
        for name in need.__annotations__:
            old, new = getattr(have, name), getattr(need, name)
            if old != new:
                raise KinetixError(
                    f"the agent {teacher.name!r} cannot be trained on: its {part} has "
                    f"{name} = {json.dumps(old)}, the configuration's has {json.dumps(new)}"
                )
    if teacher.normalisation is not None and not config.rms_norm:
        raise KinetixError(
            f"the agent {teacher.name!r} cannot be trained on: it normalises what it sees, and the "
            "configuration has rms_norm = false"
        )
    if teacher.normalisation is None and config.rms_norm:
        raise KinetixError(
            f"the agent {teacher.name!r} cannot be trained on: it sees everything as it is, and "
            "the configuration has rms_norm = true"
        )


def _reset_function(
    config: PpoConfig,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued: UEDParams,
    listed: list[SetLevel],
) -> ResetFunction:
    static_env_params = with_parity(static_env_params, config.parity)
    match config.level_mode:
        case "random":
            return make_reset_fn_sample_kinetix_level(env_params, static_env_params, ued)
        case "random_all":
            return mixed_sampler(physics_engine(static_env_params), ued)
        case "locomotion":
            return locomotion_sampler(physics_engine(static_env_params))
        case "empty":
            return make_reset_fn_empty(static_env_params)
        case "list":
            return make_reset_fn_list_of_levels(listed, static_env_params)
