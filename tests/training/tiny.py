"""Tiny runs, and what the tests of runs compare."""

import math

import numpy as np

from kinetix.agents.agent import load_agent
from kinetix.agents.arrays import flatten
from kinetix.level.codec import save_level
from kinetix.level.model import Body, Circle, Level, Polygon, Thruster
from kinetix.training.settings import make_config
from kinetix.training.trainer import make_trainer

TINY = {
    "size": "s",
    "num_train_envs": 8,
    "num_steps": 4,
    "num_minibatches": 2,
    "update_epochs": 2,
    "total_timesteps": 8 * 4 * 6,
    "eval_freq": 0,
    "checkpoint_save_freq": 2,
    "observation_type": "symbolic_flat",
    "physics": "jax2d",
    "actor_depth": 1,
    "critic_depth": 1,
    "actor_width": 16,
    "critic_width": 16,
    "batch_size": 8,
    "num_batches": 2,
    "num_to_save": 8,
    "rollout_steps": 8,
    "buffer_update_frequency": 2,
    "level_buffer_capacity": 8,
    "outer_rollout_steps": 2,
}


def tiny_config(algorithm, **changes):
    from kinetix.agents.networks.config import NetworkConfig
    from kinetix.training.config import CONFIGS

    names = set(CONFIGS[algorithm].__dataclass_fields__) | set(NetworkConfig.__dataclass_fields__)
    values = {name: value for name, value in (TINY | changes).items() if name in names}
    if algorithm in ("plr", "accel", "dr") and "total_timesteps" not in changes:
        values["total_timesteps"] *= 2
    return make_config(algorithm, values=values)


def without_time(rows):
    return [
        {name: value for name, value in row.items() if name not in ("timing/sps", "timing/seconds")}
        for row in rows
    ]


def same_parameters(a, b):
    a, b = (dict(flatten(load_agent(run).params["params"])) for run in (a, b))
    assert a.keys() == b.keys()
    for name, leaf in a.items():
        np.testing.assert_array_equal(leaf, b[name])


class Stop(Exception):
    pass


def stop_after(updates):
    def report(progress):
        if progress.update == updates:
            raise Stop

    return report


def rocket():
    """A box with a thruster below a blue ball: random play reaches it now and then."""
    corners = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
    box = Body(id=1, shape=Polygon(vertices=corners), position=(2.5, 0.45), role="green")
    ball = Body(id=2, shape=Circle(radius=0.3), position=(2.5, 2.5), fixed=True, role="blue")
    up = Thruster(id=3, body=1, position=(0.0, -0.2), angle=math.pi / 2, power=0.24)
    return Level(name="rocket", size="s", next_id=4, bodies=(box, ball), thrusters=(up,))


def sfl_on(path, **changes):
    """A tiny SFL whose only source of levels is a file, in an environment that does nothing."""
    save_level(rocket(), path)
    levels = {"levels": (str(path),), "size": "s", "dummy_env": True}
    return make_trainer(tiny_config("sfl", num_to_save=4, **levels, **changes))
