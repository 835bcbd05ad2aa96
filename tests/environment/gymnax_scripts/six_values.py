"""Run inside an environment with gymnax 1.x: the adapter under its wrappers, with its spaces."""

import jax
import jax.numpy as jnp
from gymnax.environments import spaces
from gymnax.wrappers.purerl import FlattenObservationWrapper, LogWrapper

from kinetix import EnvParams, make_kinetix_env, make_reset_fn_list_of_levels
from kinetix.environment.gymnax import GymnaxAdapter
from kinetix.environment.params import static_env_params_from_size
from kinetix.level.model import Body, Circle, Level

STEPS = 12

level = Level(
    name="drop",
    size="s",
    next_id=3,
    max_timesteps=4,
    bodies=(
        Body(id=1, shape=Circle(radius=0.3), position=(1.0, 1.7), role="green"),
        Body(id=2, shape=Circle(radius=0.3), position=(1.0, 1.0), role="blue", fixed=True),
    ),
)
static = static_env_params_from_size("s", physics="jax2d")


def make(observation_type, action_type="discrete"):
    env = make_kinetix_env(
        action_type,
        observation_type,
        make_reset_fn_list_of_levels(level, static),
        EnvParams(),
        static,
    )
    return GymnaxAdapter(env)


adapter = make("symbolic_flat_padded")
params = adapter.default_params
assert isinstance(adapter.observation_space(params), spaces.Box)
assert isinstance(adapter.action_space(params), spaces.Discrete)
entities = make("symbolic_entity", "multi_discrete")
described = entities.observation_space(params)
assert isinstance(described, spaces.Dict)
assert described.spaces["polygons"].shape == (5, 27)
action = entities.action_space(params).sample(jax.random.key(0))
assert action.shape == (6,)
assert (action[:4] <= 2).all() and (action[4:] <= 1).all()

env = LogWrapper(FlattenObservationWrapper(adapter))
obs, state = env.reset(jax.random.key(0), params)


@jax.jit
def play(state):
    def step(state, key):
        action = env.action_space(params).sample(key)
        _, state, _, terminated, truncated, info = env.step(key, state, action, params)
        return state, (terminated, truncated, info["returned_episode"], info["final_observation"])

    return jax.lax.scan(step, state, jax.random.split(jax.random.key(1), STEPS))


_, (terminated, truncated, returned, final) = play(state)
# The level's time limit is four steps, and the ball needs more than four.
expected = (jnp.arange(STEPS) % 4) == 3
assert (truncated == expected).all(), truncated
assert not terminated.any()
assert (returned == expected).all()
assert final.shape == (STEPS, 6 * 41)

# Its Gym wrappers copy the environment and turn the spaces into Gymnasium's.
from gymnax.wrappers.dm_env import GymnaxToDmEnvWrapper  # noqa: E402
from gymnax.wrappers.gym import GymnaxToGymWrapper, GymnaxToVectorGymWrapper  # noqa: E402

gym = GymnaxToGymWrapper(entities, params)
gym.reset(seed=1)
assert len(gym.step(gym.action_space.sample())) == 5
assert gym.render().shape == (125, 125, 3)
assert gym.observation_space["polygons"].shape == (5, 27)
vector = GymnaxToVectorGymWrapper(adapter, 3, params)
vector.reset(seed=2)
assert vector.step(vector.action_space.sample())[0].shape == (3, 6, 41)
dm_env = GymnaxToDmEnvWrapper(adapter)
key = jax.random.key(0)
assert dm_env.step(key, dm_env.reset(key, params), 0, params).observation.shape == (6, 41)

import gymnax  # noqa: E402

from kinetix.environment.gymnax import register  # noqa: E402

register()
named, named_params = gymnax.make("Kinetix-level-v0", level="s/goalkeeper", physics="jax2d")
assert named.reset(key, named_params)[0].shape == (140,)

# What gymnax's own environments have: a step that never resets, and questions about a state. The
# ball falls onto the goal after some steps; in a level that lasts one step, time is up before.
short = make_reset_fn_list_of_levels(level.replace(max_timesteps=1), static)
single = GymnaxAdapter(make_kinetix_env("discrete", "symbolic_flat", short, EnvParams(), static))
_, state = single.reset(jax.random.key(0), params)
assert not single.is_terminated(state, params) and not single.is_truncated(state, params)
_, ended, _, terminated, info = single.step_env(jax.random.key(1), state, 0, params)
assert not terminated and info["truncated"] and not info["terminated"]
assert ended.timestep == 1
assert single.is_truncated(ended, params) and not single.is_terminal(ended, params)
assert single.discount(ended, params) == 1
