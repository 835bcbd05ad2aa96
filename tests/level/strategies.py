"""Hypothesis strategies: levels that the format allows, with every feature in them."""

import math
import string

from hypothesis import strategies as st

from kinetix.level.geometry import recentred
from kinetix.level.model import (
    ARENA_NAMES,
    COLLISIONS,
    ROLES,
    Arena,
    ArenaBody,
    Body,
    Circle,
    Geometry,
    Joint,
    Level,
    Limits,
    MassProperties,
    Motor,
    Polygon,
    SizeHint,
    Solution,
    Thruster,
)


def reals(low=-1e6, high=1e6):
    return st.floats(low, high, width=32, allow_nan=False, allow_subnormal=False)


def points(low=-1e3, high=1e3):
    return st.tuples(reals(low, high), reals(low, high))


@st.composite
def polygons(draw):
    """Corners on an ellipse in rising order of angle: counter-clockwise and strictly convex."""
    count = draw(st.integers(3, 4))
    start = draw(reals(0.0, 6.0))
    turns = [start + 2 * math.pi * (k + draw(reals(-0.25, 0.25))) / count for k in range(count)]
    a, b = draw(reals(0.125, 2.0)), draw(reals(0.125, 2.0))
    return Polygon(vertices=tuple((a * math.cos(t), b * math.sin(t)) for t in turns))


entity_names = st.none() | st.text(st.characters(codec="utf-8"), min_size=1, max_size=60)
circles = st.builds(Circle, radius=reals(0.03125, 5.0))
roles, collisions = st.sampled_from(ROLES), st.sampled_from(COLLISIONS)
masses = st.builds(MassProperties, mass=reals(0.0625, 1e3), inertia=reals(0.0625, 1e3))


@st.composite
def bodies(draw, body_id, inertia_model):
    body = Body(
        id=body_id,
        name=draw(entity_names),
        shape=draw(circles | polygons()),
        position=draw(points(-10.0, 10.0)),
        angle=draw(reals(-100.0, 100.0)),
        velocity=draw(points(-100.0, 100.0)),
        angular_velocity=draw(reals(-50.0, 50.0)),
        density=draw(reals(0.0625, 1000.0)),
        friction=draw(reals(0.0, 10.0)),
        restitution=draw(reals(0.0, 1.0)),
        role=draw(roles),
        fixed=draw(st.booleans()),
        collision=draw(collisions),
        mass_properties=draw(st.none() | masses),
    )
    return recentred(body, inertia_model)


arena_parts = st.builds(
    ArenaBody,
    role=roles,
    friction=reals(0.0, 10.0),
    restitution=reals(0.0, 1.0),
    density=reals(0.0625, 1000.0),
    collision=collisions,
    geometry=st.none()
    | st.builds(Geometry, position=points(), vertices=polygons().map(lambda p: p.vertices)),
)
motors = st.builds(
    Motor,
    on=st.booleans(),
    speed=reals(-20.0, 20.0),
    power=reals(0.0, 20.0),
    binding=st.integers(0, 3),
    auto=st.booleans(),
)
limits = st.builds(Limits, on=st.booleans(), min=reals(-100.0, 100.0), max=reals(-100.0, 100.0))
runs = st.tuples(st.integers(1, 300), st.tuples(*[st.integers(0, 2)] * 6))
solutions = st.builds(
    Solution,
    physics=st.sampled_from(["balanced", "jax2d"]),
    frame_skip=st.integers(1, 4),
    actions=st.lists(runs, max_size=4).map(tuple),
)
tags = st.text(string.ascii_lowercase + string.digits + "-_", min_size=1, max_size=40)
texts = st.text(st.characters(codec="utf-8"), max_size=60)


@st.composite
def joints(draw, joint_id, references):
    a, b = draw(st.lists(st.sampled_from(references), min_size=2, max_size=2, unique=True))
    return Joint(
        id=joint_id,
        name=draw(entity_names),
        kind=draw(st.sampled_from(["revolute", "fixed"])),
        a=a,
        b=b,
        anchor_a=draw(points()),
        anchor_b=draw(points()),
        reference_angle=draw(reals()),
        motor=draw(st.none() | motors),
        limits=draw(st.none() | limits),
    )


def thrusters(thruster_id, body_ids):
    return st.builds(
        Thruster,
        id=st.just(thruster_id),
        name=entity_names,
        body=st.sampled_from(body_ids),
        position=points(),
        angle=reals(),
        power=reals(0.0, 100.0),
        binding=st.integers(0, 1),
    )


@st.composite
def levels(draw, max_bodies=6):
    """Any level that the reader accepts, ids with gaps and out of order."""
    model = draw(st.sampled_from(["exact", "kinetix"]))
    counts = [draw(st.integers(0, max_bodies)), draw(st.integers(0, 4)), draw(st.integers(0, 3))]
    if counts[0] == 0:
        counts[2] = 0
    ids = draw(
        st.lists(st.integers(1, 200), unique=True, min_size=sum(counts), max_size=sum(counts))
    )
    body_ids, rest = ids[: counts[0]], ids[counts[0] :]
    made = [draw(bodies(body_id, model)) for body_id in body_ids]
    return Level(
        name=draw(texts.filter(bool)),
        description=draw(texts),
        tags=tuple(draw(st.lists(tags, unique=True, max_size=3))),
        size=draw(
            st.none()
            | st.just("l")
            | st.builds(
                SizeHint,
                polygons=st.integers(10, 20),
                circles=st.integers(6, 9),
                joints=st.integers(4, 6),
                thrusters=st.integers(3, 5),
            )
        )
        if counts[0] <= 4 and counts[2] <= 2
        else None,
        gravity=draw(points(-100.0, 100.0)),
        max_timesteps=draw(st.integers(1, 100_000)),
        inertia_model=model,
        arena=Arena(**{name: draw(arena_parts) for name in ARENA_NAMES}),
        next_id=draw(st.integers(max(ids, default=0) + 1, 1000)),
        bodies=tuple(made),
        joints=tuple(
            draw(joints(joint_id, [*ARENA_NAMES, *body_ids])) for joint_id in rest[: counts[1]]
        ),
        thrusters=tuple(
            draw(thrusters(thruster_id, body_ids)) for thruster_id in rest[counts[1] :]
        ),
        solution=draw(st.none() | solutions),
    )
