"""Nothing crosses a fixed wall, whatever threw it off course; and who gets contacts in a crowd."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine import Capacity, SceneSpec, solver_named
from kinetix.engine.collision import Slots, held_by_walls
from kinetix.engine.collision.driver import _near
from kinetix.engine.collision.points import Approach, PointList
from kinetix.engine.collision.scene import Rules
from kinetix.engine.maths import Vec
from kinetix.engine.shapes import turn_polygons
from kinetix.environment.simulation import simulate
from kinetix.level.builder import LevelBuilder
from kinetix.level.compile import compile_level
from kinetix.level.model import Collision, Motor

SPEC = SceneSpec(capacity=Capacity(polygons=7, circles=2, joints=1, thrusters=0))
DISC, BOX, WALL = 7, 5, 4


def share(way, *, wall=(0.05, 2.0), hinged=False, collision: Collision = "normal"):
    """Of the way of a disc of 5 cm at the origin; a box of 10 cm is beside it."""
    b = LevelBuilder("Wall", arena=False)
    b.rectangle(0.5, 0, *wall, fixed=True, collision=collision)
    box = b.rectangle(0, 0.5, 0.1, 0.1)
    disc = b.circle(0, 0, 0.05)
    if hinged:
        b.hinge(box, disc, (0, 0.25))
    scene = compile_level(b.build(), spec=SPEC, solver=solver_named("balanced"))
    world, state = jax.tree.map(lambda x: jnp.asarray(x)[..., None], (scene.world, scene.state))
    start = state.position
    end = Vec(x=start[:, 0].at[DISC].add(way[0]), y=start[:, 1].at[DISC].add(way[1]))
    polygons = turn_polygons(world.bodies, state.rotation)
    nothing_prepared = PointList.empty(1, state.rotation).points
    held = held_by_walls(world, state, polygons, nothing_prepared, end, jnp.full(1, 1 / 60))
    assert not np.any(held.back.x) and not np.any(held.back.y)
    return np.asarray(held.share)[:, 0]


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2])
@pytest.mark.parametrize("distance", [0.6, 3.0])
def test_a_centre_ends_before_the_wall_and_its_body_touches_it(angle, distance):
    way = (distance, distance * math.tan(angle) * 0.5)
    found = share(way)
    length = math.hypot(*way)
    # The wall's near side is at .475; half of the disc's radius before it the body stops.
    reached = found[DISC] * way[0]
    assert 0.475 - 0.026 * way[0] / length - 1e-3 < reached < 0.475
    others = np.delete(found, DISC)
    np.testing.assert_array_equal(others, 1)


@pytest.mark.parametrize(
    ("way", "options"),
    [
        ((0.4, 0.0), {}),
        ((-3.0, 0.0), {}),
        ((3.0, 9.0), {}),
        ((3.0, 0.0), {"collision": "ghost"}),
    ],
)
def test_who_does_not_reach_a_wall_goes_all_of_its_way(way, options):
    np.testing.assert_array_equal(share(way, **options), 1)


def test_what_is_jointed_stops_together():
    found = share((3.0, 0.0), hinged=True)
    assert found[DISC] < 0.2 and found[BOX] == found[DISC] and found[WALL] == 1


def test_a_fast_body_in_a_narrow_box_stays_there():
    """It bounces many times within each step."""
    b = LevelBuilder("Between walls", gravity=(0.0, 0.0), arena=False)
    for side in (-1, 1):
        b.rectangle(side * 0.175, 0, 0.05, 40.0, fixed=True, restitution=1)
    b.rectangle(0.01, 0, 0.1, 0.1, angle=0.3, velocity=(95.0, 3.0), restitution=1)
    run = simulate(b.build(), 0.5)
    assert np.abs(run.position[:, -1, 0]).max() < 0.15


def parted(first, second):
    """The widest gap along any edge's normal between two convex polygons, (corners, 2) [m]."""
    edges = np.concatenate([np.roll(corners, -1, 0) - corners for corners in (first, second)])
    normals = np.stack([-edges[:, 1], edges[:, 0]], 1) / np.hypot(*edges.T)[:, None]
    here, there = first @ normals.T, second @ normals.T
    return np.maximum(there.min(0) - here.max(0), here.min(0) - there.max(0)).max()


@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_a_long_body_across_a_thin_wall_is_parted_from_it(gravity):
    """Its contact would push its centre through the wall, which nothing may cross."""
    b = LevelBuilder("Triangle across a slab", gravity=(0.0, gravity), arena=False)
    slab = [(0.28, -0.14), (0.3, -0.08), (-0.28, 0.14), (-0.3, 0.08)]
    b.polygon(slab, fixed=True)
    triangle = b.polygon([(0.36, 0.19), (0.15, 0.17), (-0.3, -0.27)])
    level = b.build()
    run = simulate(level, 2.0)
    speed = np.hypot(*run.velocity[:, 1].T)
    way = np.hypot(*np.diff(run.position[:, 1], axis=0).T) * 60
    assert not np.any((speed[1:] > 1) & (way < 0.1 * speed[1:]))
    cos, sin = np.cos(run.rotation[-1, 1]), np.sin(run.rotation[-1, 1])
    corners = np.asarray(level.body(triangle).shape.vertices) @ [[cos, sin], [-sin, cos]]
    assert parted(np.asarray(slab), corners + run.position[-1, 1]) > -1e-3


def test_a_fast_body_slides_over_the_ends_of_tiles():
    """The end of a tile is no far side that it could be pushed to."""
    slope, length = 0.3, 0.905
    along = np.array((math.cos(slope), -math.sin(slope)))
    b = LevelBuilder("Tiles", arena=False)
    for k in range(6):
        x, y = along * (0.5 + k) * length - 0.1 * along[::-1] * (-1, 1)
        b.rectangle(x, y, length, 0.2, angle=-slope, fixed=True, friction=0)
    shape = [(-0.21312992, -0.004636425), (0.17328578, -0.124168806), (0.03984413, 0.12880524)]
    corners = np.array(shape) + along * 0.26 + (0.0, 0.068)
    body = b.polygon(corners, velocity=tuple(7.08 * along), friction=0)
    run = simulate(b.build(), 0.5, physics="balanced")
    went = run.position[-1, body - 1] - run.position[0, body - 1]
    expected = 7.08 * 0.5 + 0.5 * 9.81 * math.sin(slope) * 0.5**2
    assert went @ along == pytest.approx(expected, abs=0.01)


def chosen(separation, meets, room, points=100):
    """Return the polygon pairs that get contacts."""
    count = len(separation)
    gap = jnp.asarray(separation, jnp.float32)[:, None]
    some = jnp.zeros((0, 1))
    coming = Approach(
        separation=gap,
        face=jnp.zeros((count, 1), jnp.int32),
        time=jnp.zeros((count, 1)),
        meets=jnp.asarray(meets)[:, None],
    )
    nothing = Approach(separation=some, face=some.astype(int), time=some, meets=some.astype(bool))
    rules = Rules(
        may_touch=jnp.ones((count, 1), bool),
        pushes=jnp.ones((count, 1), bool),
        margin=jnp.full((count, 1), 1.0),
    )
    slots = Slots(polygon_polygon=room, circle_polygon=0, circle_circle=0, points=points)
    places = [slice(0, count), slice(count, count), slice(count, count)]
    near, overflow = _near(rules, [coming, nothing, nothing], places, slots)
    return np.flatnonzero(np.asarray(near)[:, 0]).tolist(), bool(overflow[0])


def test_where_room_is_short_the_urgent_pairs_are_kept():
    separation = [0.9, 0.5, 0.001, 0.7, 0.3, 2.0]
    meets = [False, False, True, True, False, True]
    assert chosen(separation, meets, 6) == ([0, 1, 2, 3, 4], False)
    assert chosen(separation, meets, 4) == ([1, 2, 3, 4], False)
    assert chosen(separation, meets, 2) == ([2, 3], False)
    assert chosen(separation, meets, 1) == ([2], False)
    assert chosen(separation, meets, 6, points=4) == ([2, 3], False)


def test_more_pairs_that_touch_than_there_is_room_for_are_told():
    found, overflow = chosen([0.0, 0.0, 0.0], [True, True, True], 2)
    assert overflow and found == [0, 1, 2]


def test_a_ball_that_motors_press_does_not_creep():
    """Their arms are not foreseen to bend as if the ball were not there."""
    b = LevelBuilder("Held ball", arena=False)
    for side in (-1, 1):
        post = b.rectangle(side * 0.25, 0.0, 0.1, 0.1, fixed=True, collision="ghost")
        arm = b.rectangle(side * 0.25, 0.4, 0.1, 0.8)
        b.hinge(post, arm, (side * 0.25, 0.0), motor=Motor(speed=side * 1.0, power=5.0))
    b.circle(0.0, 0.6, 0.2)
    run = simulate(b.build(), 1.0, actions=np.eye(1, 6)[0])
    assert np.abs(run.position[:, -1] - run.position[0, -1]).max() < 1e-4


def test_an_impact_takes_what_housner_says():
    """A slender block that rocks: the old corner holds it until the new one hits the floor."""
    width, height = 0.4, 1.6
    alpha, reach = math.atan(width / height), math.hypot(width, height) / 2
    b = LevelBuilder("Rocking block", arena=False)
    b.rectangle(0, -0.5, 10, 1, fixed=True, friction=2.0)
    place = (reach * math.sin(alpha / 2), reach * math.cos(alpha / 2))
    b.rectangle(*place, width, height, angle=alpha / 2, friction=2.0)
    run = simulate(b.build(), 2.0)
    turn, spin = run.rotation[:, 1], run.angular_velocity[:, 1]
    impacts = np.flatnonzero(np.sign(turn[1:]) * np.sign(turn[:-1]) < 0) + 1
    # About a corner the block turns by the law of a pendulum upside down.
    size = 4 / 3 * reach**2
    energy = 0.5 * size * spin**2 + 9.81 * reach * np.cos(alpha - np.abs(turn)) - 9.81 * height / 2
    loss = 1 - energy[impacts[:2] + 2] / energy[impacts[:2] - 2]
    np.testing.assert_allclose(loss, 1 - (1 - 1.5 * math.sin(alpha) ** 2) ** 2, rtol=0.12)
