"""Small scenes that share one capacity, so that a solver is compiled once for all of them."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np

from kinetix.engine import Capacity, Control, SceneSpec, default_parameters, step
from kinetix.engine.solvers import AbstractSolver
from kinetix.level.compile import compile_level
from kinetix.level.model import Arena, ArenaBody, Body, Circle, Joint, Level, Limits, Motor, Polygon

SPEC = SceneSpec(capacity=Capacity(polygons=10, circles=1, joints=5, thrusters=0))
FEW = SceneSpec(capacity=Capacity(polygons=7, circles=1, joints=1, thrusters=0))
"""For a few bodies: what is compiled with all optimisations."""
NO_ARENA = Arena(
    **{
        name: ArenaBody(collision="ghost")
        for name in ("floor", "left_wall", "right_wall", "ceiling")
    }
)
FLOOR = 100


def box(width, height):
    x, y = width / 2, height / 2
    return Polygon(vertices=((x, y), (-x, y), (-x, -y), (x, -y)))


def friction(mu):
    """The value that gives a pair of equal bodies the coefficient mu."""
    return mu / (0.4 * math.sqrt(2))


def level(*bodies, joints=(), gravity=(0.0, -9.81), mu=None, restitution=0.0):
    floor = ()
    if mu is not None:
        floor = (
            Body(
                id=FLOOR,
                shape=box(9.0, 1.0),
                position=(0.0, -0.5),
                fixed=True,
                friction=friction(mu),
                restitution=restitution,
            ),
        )
    return Level(
        name="scene",
        arena=NO_ARENA,
        gravity=gravity,
        bodies=floor + bodies,
        joints=tuple(joints),
        next_id=1000,
    )


def stack(count, density=1.0):
    """Boxes of 0.2 m, the top one of another density."""
    return level(
        *(
            Body(
                id=1 + i,
                shape=box(0.2, 0.2),
                position=(0.0, 0.1 + 0.2 * i),
                friction=friction(0.566),
                density=density if i == count - 1 else 1.0,
            )
            for i in range(count)
        ),
        mu=0.566,
    )


def bouncing_ball(restitution):
    ball = Body(
        id=1,
        shape=Circle(radius=0.2),
        position=(0.0, 1.2),
        restitution=restitution,
        friction=0.0,
    )
    return level(ball, mu=0.0, restitution=restitution)


def slope(mu, angle):
    gravity = (9.81 * math.sin(angle), -9.81 * math.cos(angle))
    block = Body(id=1, shape=box(0.4, 0.2), position=(-2.0, 0.1), friction=friction(mu))
    return level(block, mu=mu, gravity=gravity)


def pendulum(angle):
    rod = Body(
        id=2,
        shape=box(0.1, 1.0),
        position=(0.5 * math.sin(angle), 3.0 - 0.5 * math.cos(angle)),
        angle=angle,
    )
    joint = Joint(id=10, kind="revolute", a=1, b=2, anchor_a=(0.0, 0.0), anchor_b=(0.0, 0.5))
    return level(post((0.0, 3.0)), rod, joints=(joint,))


def post(position):
    return Body(id=1, shape=box(0.2, 0.2), position=position, fixed=True)


def hanging_chain(ratio):
    """Four links of 0.2 m and a disc that is `ratio` times as heavy as one of them."""
    bodies = [post((0.0, 4.0))]
    joints = []
    for i in range(4):
        bodies.append(
            Body(
                id=2 + i,
                shape=box(0.2, 0.05),
                position=(0.0, 4.0 - 0.2 * i - 0.1),
                angle=-math.pi / 2,
                collision="ghost",
            )
        )
        joints.append(
            Joint(
                id=10 + i,
                kind="revolute",
                a=1 + i,
                b=2 + i,
                anchor_a=(0.0, 0.0) if i == 0 else (0.1, 0.0),
                anchor_b=(-0.1, 0.0),
            )
        )
    disc = Body(
        id=6,
        shape=Circle(radius=0.3),
        position=(0.0, 2.9),
        density=0.01 * ratio / (math.pi * 0.09),
        collision="ghost",
    )
    joints.append(Joint(id=14, kind="revolute", a=5, b=6, anchor_a=(0.1, 0.0), anchor_b=(0.0, 0.3)))
    return level(*bodies, disc, joints=joints)


def cantilever(count):
    bodies = [post((0.0, 4.0))]
    joints = []
    for i in range(count):
        bodies.append(Body(id=2 + i, shape=box(0.4, 0.2), position=(0.3 + 0.4 * i, 4.0)))
        joints.append(
            Joint(
                id=10 + i,
                kind="fixed",
                a=1 + i,
                b=2 + i,
                anchor_a=(0.1, 0.0) if i == 0 else (0.2, 0.0),
                anchor_b=(-0.2, 0.0),
            )
        )
    return level(*bodies, joints=joints)


def motor_wheel(power):
    wheel = Body(id=2, shape=Circle(radius=0.2), position=(0.0, 4.0))
    joint = Joint(
        id=10,
        kind="revolute",
        a=1,
        b=2,
        anchor_a=(0.0, 0.0),
        anchor_b=(0.0, 0.0),
        motor=Motor(on=True, speed=1.0, power=power, binding=0, auto=False),
    )
    return level(post((0.0, 4.0)), wheel, joints=(joint,))


def falling_arm(reach):
    """An arm pinned at its end, let go at its upper limit."""
    arm = Body(
        id=2,
        shape=box(0.8, 0.1),
        position=(0.4 * math.cos(reach), 4.0 + 0.4 * math.sin(reach)),
        angle=reach,
    )
    return level(post((0.0, 4.0)), arm, joints=(within(reach, anchor=-0.4),))


def thrown_arm(spin, reach):
    """An arm pinned at its centre that turns from just below the middle of its limits."""
    arm = Body(id=2, shape=box(0.8, 0.1), position=(0.0, 4.0), angle=-0.01, angular_velocity=spin)
    joint = within(reach, anchor=0.0)
    return level(post((0.0, 4.0)), arm, joints=(joint,), gravity=(0.0, 0.0))


def within(reach, *, anchor):
    """A hinge of an arm on a post that turns by no more than `reach` to either side."""
    return Joint(
        id=10,
        kind="revolute",
        a=1,
        b=2,
        anchor_a=(0.0, 0.0),
        anchor_b=(anchor, 0.0),
        limits=Limits(min=-reach, max=reach),
    )


@functools.cache
def _roll(solver: AbstractSolver, steps: int, spec: SceneSpec):
    parameters = default_parameters()

    def one(world, state, motor):
        def body(state, _):
            control = Control(motor=motor, thruster=jnp.zeros(0))
            state = step(world, state, control, parameters, spec=spec, solver=solver)
            return state, state.replace(cache=None)

        return jax.lax.scan(body, state, None, length=steps)[1]

    return jax.jit(jax.vmap(one))


def play(solver, levels, *, seconds, motor=1.0, spec=SPEC):
    """All levels at once: the states after each step, (level, step, …), and the compiled worlds."""
    scenes = [compile_level(item, spec=spec, solver=solver) for item in levels]
    stacked = jax.tree.map(lambda *x: jnp.stack(x), *scenes)
    drive = jnp.full((len(levels), spec.capacity.joints), motor, jnp.float32)
    states = _roll(solver, round(seconds * 60), spec)(stacked.world, stacked.state, drive)
    return jax.tree.map(np.asarray, states), stacked.world


def joint_gap(world, states, index):
    """Largest distance of the two anchors of any joint of one world, over all steps [m]."""
    joints = jax.tree.map(lambda x: np.asarray(x[index]), world.joints)
    position, rotation = states.position[index], states.rotation[index]

    def place(body, anchor):
        cos, sin = np.cos(rotation[:, body]), np.sin(rotation[:, body])
        turned = np.stack(
            [cos * anchor[0] - sin * anchor[1], sin * anchor[0] + cos * anchor[1]], axis=-1
        )
        return position[:, body] + turned

    return max(
        np.linalg.norm(
            place(joints.body_a[k], joints.anchor_a[k])
            - place(joints.body_b[k], joints.anchor_b[k]),
            axis=-1,
        ).max()
        for k in range(len(joints.body_a))
        if joints.active[k]
    )
