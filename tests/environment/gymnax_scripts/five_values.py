"""Run with gymnax 0.0.9 installed: its wrappers round ours, in a loop as of PureJaxRL."""

import jax
import jax.numpy as jnp
from gymnax.wrappers.purerl import FlattenObservationWrapper, LogWrapper

from kinetix import EnvParams, make_kinetix_env, make_reset_fn_list_of_levels
from kinetix.environment.params import static_env_params_from_size
from kinetix.level.model import Body, Circle, Level

WORLDS, STEPS = 4, 20

level = Level(
    name="drop",
    size="s",
    next_id=3,
    bodies=(
        Body(id=1, shape=Circle(radius=0.3), position=(1.0, 1.7), role="green"),
        Body(id=2, shape=Circle(radius=0.3), position=(1.0, 1.0), role="blue", fixed=True),
    ),
)
static = static_env_params_from_size("s", physics="jax2d")
env_params = EnvParams()
env = make_kinetix_env(
    "discrete",
    "symbolic_flat_padded",
    make_reset_fn_list_of_levels(level, static),
    env_params,
    static,
)
env = LogWrapper(FlattenObservationWrapper(env))


def update(carry, key):
    state, obs, total = carry
    act_key, step_key = jax.random.split(key)
    action = jax.vmap(env.action_space(env_params).sample)(jax.random.split(act_key, WORLDS))
    obs, state, reward, done, info = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
        jax.random.split(step_key, WORLDS), state, action, env_params
    )
    ended = (info["returned_episode"], info["returned_episode_returns"], done)
    return (state, obs, total + reward), ended


@jax.jit
def train(key):
    reset_key, key = jax.random.split(key)
    obs, state = jax.vmap(env.reset, in_axes=(0, None))(
        jax.random.split(reset_key, WORLDS), env_params
    )
    state = state.replace(episode_returns=jnp.zeros(WORLDS), episode_lengths=jnp.zeros(WORLDS, int))
    state = state.replace(
        returned_episode_returns=jnp.zeros(WORLDS), returned_episode_lengths=jnp.zeros(WORLDS, int)
    )
    return jax.lax.scan(update, (state, obs, jnp.zeros(WORLDS)), jax.random.split(key, STEPS))


(state, obs, total), (ended, returns, done) = train(jax.random.key(0))
assert obs.shape == (WORLDS, 6 * 41), obs.shape
assert (ended == done).all()
assert ended.any(axis=0).all(), "every ball reaches the other one"
assert (returns[-1] > 0.9).all(), returns[-1]
assert (total >= returns[-1]).all()
assert env.num_actions == 11

# Its Gym wrappers copy the environment, replace its methods and ask for its own classes.
from gymnax.environments import spaces  # noqa: E402
from gymnax.wrappers.gym import GymnaxToGymWrapper, GymnaxToVectorGymWrapper  # noqa: E402

bare = env._env._env
assert isinstance(bare.observation_space(env_params), spaces.Box)
assert isinstance(bare.action_space(env_params), spaces.Discrete)
gym = GymnaxToGymWrapper(bare, env_params)
gym.reset(seed=1)
assert len(gym.step(gym.action_space.sample())) == 5
assert gym.render().shape == (125, 125, 3)
vector = GymnaxToVectorGymWrapper(bare, 3, env_params)
vector.reset(seed=2)
assert vector.step(vector.action_space.sample())[0].shape == (3, 6, 41)
