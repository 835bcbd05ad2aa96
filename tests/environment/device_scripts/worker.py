"""Step some worlds, spread over all devices of all processes, and print this process's share.

Arguments: how many worlds, and for several processes their number, this one's index, and the port
of the first one on the loopback address.
"""

import json
import sys

import jax
import jax.numpy as jnp

worlds = int(sys.argv[1])
if len(sys.argv) > 2:
    processes, index, port = (int(word) for word in sys.argv[2:])
    jax.distributed.initialize(f"127.0.0.1:{port}", processes, index)
else:
    processes, index = 1, 0

from kinetix import EnvParams, make_kinetix_env  # noqa: E402 (the processes must meet first)
from kinetix.environment.devices import own_part, place, spread  # noqa: E402 (the processes must meet first)
from kinetix.environment.params import static_env_params_from_size  # noqa: E402 (the processes must meet first)
from kinetix.environment.reset import level_state  # noqa: E402 (the processes must meet first)
from kinetix.level.model import Body, Circle, Level  # noqa: E402 (the processes must meet first)

static = static_env_params_from_size("4,1,0,0", physics="jax2d")
ball = Body(id=1, shape=Circle(radius=0.3), position=(1.0, 1.7), role="green")
start = level_state(Level(name="ball", next_id=2, bodies=(ball,)), static)
env = make_kinetix_env("discrete", "symbolic_flat", None, EnvParams(), static)

share = worlds // processes
numbers = jnp.arange(share) + index * share


def rollout(numbers):
    def one(number):
        speed = jnp.zeros((5, 2)).at[4, 0].set(0.1 * number)
        state = start.replace(physics=start.physics.replace(velocity=speed))
        for _ in range(3):
            obs, state, *_ = env.step(jax.random.key(0), state, 8, EnvParams(), start)
        return obs

    return jax.vmap(one)(numbers)


observations = own_part(spread(rollout)(place(numbers)))
sys.stdout.write(
    json.dumps({"devices": jax.device_count(), "observations": observations.tolist()}) + "\n"
)
