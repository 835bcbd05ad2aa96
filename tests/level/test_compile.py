"""Compiled arrays: what stands in which slot, and the way back."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import Capacity, Features, SceneSpec, Used
from kinetix.errors import LevelError
from kinetix.level.codec import dumps, load_document, load_level, loads
from kinetix.level.compile import compile_level
from kinetix.level.decompile import level_from_scene
from kinetix.level.features import features_of, features_union, pushing_pairs
from kinetix.level.kinetix_env.compile import compile_kinetix_env
from kinetix.level.kinetix_env.document import parse_kinetix_env
from kinetix.level.model import (
    Arena,
    ArenaBody,
    Body,
    Circle,
    Joint,
    Level,
    Limits,
    MassProperties,
    Motor,
    Polygon,
    Thruster,
)
from kinetix.level.sizes import SIZES, capacity_of, needed_capacity, parse_capacity
from kinetix.level.slots import body_slots
from tests.level.strategies import levels

FIXTURES = Path(__file__).parent / "fixtures"


@dataclasses.dataclass(frozen=True)
class Still(AbstractSolver):
    """Keeps a cache that shows which capacity it was asked for."""

    name = "still"

    def empty_cache(self, spec: SceneSpec) -> Any:
        return np.zeros(spec.capacity.joints, np.float32)

    def step(self, world, state, control, parameters, spec):
        return state


SOLVER = Still()


def compiled(level, size=None):
    capacity = SIZES[size] if size else capacity_of(level)
    return compile_level(level, spec=SceneSpec(capacity=capacity), solver=SOLVER)


def assert_same(a, b):
    """The same bits, types and shapes in every leaf."""
    assert jax.tree.structure(a) == jax.tree.structure(b)
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        assert x.dtype == y.dtype
        assert x.shape == y.shape
        assert x.tobytes() == y.tobytes()


LAMP = Level(
    name="lamp",
    arena=Arena(floor=ArenaBody(role="red", friction=0.5)),
    bodies=(
        Body(id=1, shape=Circle(radius=0.25), position=(1, 2), role="green", density=2.0),
        Body(
            id=4,
            shape=Polygon(vertices=((0.0, 0.2), (-0.3, -0.1), (0.3, -0.1))),
            position=(3, 2),
            angle=0.5,
            velocity=(1, -1),
            angular_velocity=2,
            restitution=0.5,
            collision="ghost",
        ),
        Body(
            id=2,
            shape=Polygon(vertices=((0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1))),
            position=(4, 3),
            role="blue",
            fixed=True,
        ),
    ),
    joints=(
        Joint(
            id=5,
            kind="revolute",
            a=4,
            b=1,
            anchor_a=(0, 0),
            anchor_b=(1, 0),
            reference_angle=0.25,
            motor=Motor(speed=-2, power=3, binding=1, auto=True),
            limits=Limits(min=-1, max=0.5),
        ),
    ),
    thrusters=(Thruster(id=6, body=1, position=(0, -0.2), angle=1.5, power=0.5, binding=1),),
)


def test_bodies_stand_in_their_slots_clockwise():
    scene = compiled(LAMP, "m")
    bodies, state, labels = scene.world.bodies, scene.state, scene.labels
    assert bodies.active.tolist() == [True] * 6 + [True, False, False]
    assert bodies.vertex_count.tolist() == [4, 4, 4, 4, 3, 4]
    np.testing.assert_array_equal(
        bodies.vertices[4], np.float32([[0, 0.2], [0.3, -0.1], [-0.3, -0.1], [0, 0]])
    )
    assert bodies.vertices[0, 0].tolist() == [2.5, np.float32(5.2)]
    assert bodies.vertices[0, 1].tolist() == [2.5, np.float32(-5.2)]
    assert bodies.radius.tolist() == [0.25, 0, 0]
    assert labels.role.tolist() == [3, 0, 0, 0, 0, 2, 1, 0, 0]
    assert labels.density.tolist() == [1, 1, 1, 1, 1, 1, 2, 1, 1]
    assert bodies.collision_mode.tolist() == [2, 2, 2, 2, 0, 1, 1, 1, 1]
    assert bodies.friction.tolist() == [0.5] + [1.0] * 8
    assert bodies.restitution[4] == 0.5
    assert state.position[6].tolist() == [1, 2]
    assert state.rotation[4] == 0.5
    assert state.velocity[4].tolist() == [1, -1]
    assert state.angular_velocity[4] == 2
    assert bodies.inverse_mass[:6].tolist() == pytest.approx([0, 0, 0, 0, 1 / 0.09, 0], rel=1e-6)
    assert bodies.inverse_mass[6] == pytest.approx(1 / (2 * np.pi * 0.0625), rel=1e-6)


def test_unused_slots_hold_the_agreed_values():
    scene = compiled(Level(name="empty"), "l")
    bodies = scene.world.bodies
    assert bodies.active.tolist() == [True] * 4 + [False] * 12
    assert not bodies.inverse_mass.any()
    assert not bodies.inverse_inertia.any()
    assert (bodies.friction == 1).all()
    assert (scene.labels.density == 1).all()
    assert (bodies.collision_mode[4:] == 1).all()
    assert (bodies.vertex_count == 4).all()
    assert not scene.world.joints.active.any()
    assert len(scene.state.touching) == len(candidate_pairs(SIZES["l"]))
    assert not scene.state.touching.any()
    assert not scene.state.overflow
    assert scene.state.cache.shape == (6,)


def test_joints_and_thrusters_refer_to_global_indices():
    scene = compiled(LAMP, "m")
    joints, thrusters, labels = scene.world.joints, scene.world.thrusters, scene.labels
    assert (joints.body_a[0], joints.body_b[0]) == (4, 6)
    assert joints.active.tolist() == [True, False]
    assert joints.motor_on[0]
    assert joints.motor_speed[0] == -2
    assert joints.motor_power[0] == 3
    assert joints.reference_angle[0] == 0.25
    assert joints.limited[0]
    assert (joints.limit_min[0], joints.limit_max[0]) == (-1, 0.5)
    assert labels.motor_binding[0] == 1
    assert labels.motor_auto.tolist() == [True, False]
    assert thrusters.body[0] == 6
    assert thrusters.angle[0] == 1.5
    assert labels.thruster_binding.tolist() == [1, 0]
    assert not scene.world.collides[4, 6]
    assert scene.world.collides[4, 5]
    assert body_slots(LAMP, SIZES["l"])[1] == 12


def test_a_joint_without_motor_and_limits_has_their_defaults():
    level = LAMP.replace(joints=(LAMP.joints[0].replace(motor=None, limits=None),))
    joints = compiled(level).world.joints
    assert not joints.motor_on[0]
    assert (joints.motor_speed[0], joints.motor_power[0]) == (1, 1)
    assert not joints.limited[0]


def test_types_are_what_the_engine_expects():
    for leaf in jax.tree.leaves(compiled(LAMP)):
        assert isinstance(leaf, np.ndarray)
        assert leaf.dtype in (np.float32, np.int32, np.bool_)


def test_own_mass_properties_and_fixed_bodies():
    own = MassProperties(mass=4.0, inertia=0.5)
    level = LAMP.replace(bodies=(LAMP.bodies[0].replace(mass_properties=own), *LAMP.bodies[1:]))
    bodies = compiled(level, "m").world.bodies
    assert (bodies.inverse_mass[6], bodies.inverse_inertia[6]) == (0.25, 2.0)


def test_what_does_not_fit_is_told():
    with pytest.raises(LevelError, match="Uses 6 of 5 polygons: does not fit size s"):
        compiled(LAMP, "s")
    broken = LAMP.replace(thrusters=(LAMP.thrusters[0].replace(body=77),))
    with pytest.raises(LevelError, match="missing body 77"):
        compiled(broken)
    pentagon = Polygon(vertices=tuple((np.cos(k), np.sin(k)) for k in range(5)))
    with pytest.raises(LevelError, match="5 vertices"):
        compiled(
            LAMP.replace(bodies=(LAMP.bodies[1].replace(shape=pentagon),), joints=(), thrusters=())
        )


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(levels(max_bodies=5))
def test_a_level_and_its_round_trip_compile_to_the_same_bits(level):
    scene = compiled(level)
    assert_same(scene, compiled(loads(dumps(level))))
    back = level_from_scene(
        scene, name=level.name, inertia_model=level.inertia_model, description=level.description
    )
    again = compiled(back.replace(size=level.size))
    # Masses go through an inverse and back, so that they may differ in the last digits.
    one, other = scene.world.bodies, again.world.bodies
    np.testing.assert_allclose(one.inverse_mass, other.inverse_mass, rtol=2e-5)
    np.testing.assert_allclose(one.inverse_inertia, other.inverse_inertia, rtol=2e-5)
    bodies = dataclasses.replace(
        other, inverse_mass=one.inverse_mass, inverse_inertia=one.inverse_inertia
    )
    again = dataclasses.replace(again, world=dataclasses.replace(again.world, bodies=bodies))
    assert_same(scene, again)


def test_the_way_back_gives_the_level():
    back = level_from_scene(compiled(LAMP, "m"), name="lamp")
    assert back.size == "m"
    assert [body.shape for body in back.bodies] == [
        LAMP.bodies[1].shape,
        LAMP.bodies[2].shape,
        LAMP.bodies[0].shape,
    ]
    assert back.joints[0].replace(id=5, a=4, b=1) == LAMP.joints[0]
    assert back.thrusters[0].body == 3
    assert back.arena == LAMP.arena
    assert not any(body.mass_properties for body in back.bodies)


# --- files of kinetix-env


def test_files_of_the_peer_keep_their_slots():
    document = parse_kinetix_env((FIXTURES / "kinetix_env" / "gaps.json").read_text())
    scene = compile_kinetix_env(document, solver=SOLVER)
    assert scene.world.bodies.active.tolist() == [True] * 6 + [False, True, True]
    assert scene.world.bodies.radius[0] == np.float32(0.1)
    assert sorted(scene.world.joints.body_b.tolist()) == [7, 8]
    larger = compile_kinetix_env(document, solver=SOLVER, spec=SceneSpec(capacity=SIZES["l"]))
    assert np.flatnonzero(larger.world.bodies.active).tolist() == [0, 1, 2, 3, 4, 5, 13, 14]
    assert sorted(larger.world.joints.body_b[:2].tolist()) == [13, 14]
    with pytest.raises(LevelError, match="does not fit"):
        compile_kinetix_env(document, solver=SOLVER, spec=SceneSpec(capacity=SIZES["s"]))


def test_gravity_and_time_limit_of_a_file_can_be_overridden():
    tree = json.loads((FIXTURES / "kinetix_env" / "cart_and_bell.json").read_text())
    tree["env_state"]["gravity"] = {"0": 1.0, "1": 2.0}
    tree["env_params"]["max_timesteps"] = 99
    document = parse_kinetix_env(json.dumps(tree))
    scene = compile_kinetix_env(document, solver=SOLVER)
    assert scene.world.gravity.tolist() == [1, 2]
    assert scene.labels.max_timesteps == 99
    fixed = compile_kinetix_env(document, solver=SOLVER, gravity="fixed", time_limit="fixed")
    assert fixed.world.gravity.tolist() == [0, np.float32(-9.81)]
    assert fixed.labels.max_timesteps == 256


def test_contacts_of_a_snapshot_are_kept():
    tree = json.loads((FIXTURES / "kinetix_env" / "cart_and_bell.json").read_text())
    pairs = candidate_pairs(SIZES["m"]).tolist()
    tree["env_state"]["acc_rr_manifolds"][2 * pairs.index([0, 5]) + 1]["active"] = True
    circles = pairs.index([6, 0])
    tree["env_state"]["acc_cr_manifolds"][0]["active"] = True
    document = parse_kinetix_env(json.dumps(tree))
    touching = compile_kinetix_env(document, solver=SOLVER).state.touching
    assert np.flatnonzero(touching).tolist() == [pairs.index([0, 5]), circles]
    large = SceneSpec(capacity=SIZES["l"])
    assert not compile_kinetix_env(document, solver=SOLVER, spec=large).state.touching.any()


@pytest.mark.peer
def test_published_files_compile_to_what_they_store(peer):
    for path in sorted((peer / "levels").rglob("*.json")):
        loaded = load_document(path)
        state = json.loads(loaded.source.text)["env_state"]
        scene = compile_kinetix_env(loaded.source, solver=SOLVER)
        matrix = [
            [row[str(k)] for k in range(len(row))] for row in unkeyed(state["collision_matrix"])
        ]
        np.testing.assert_array_equal(scene.world.collides, matrix)
        rows = state["polygon"] + state["circle"]
        for array, key in (
            (scene.world.bodies.inverse_mass, "inverse_mass"),
            (scene.world.bodies.inverse_inertia, "inverse_inertia"),
            (scene.state.rotation, "rotation"),
            (scene.labels.role, "role"),
        ):
            np.testing.assert_array_equal(array, np.array([row[key] for row in rows], array.dtype))
        native = compiled(loaded.level)
        active = scene.world.bodies.active
        np.testing.assert_array_equal(
            scene.state.position[active], native.state.position[native.world.bodies.active]
        )
        np.testing.assert_allclose(
            scene.world.bodies.inverse_inertia[active],
            native.world.bodies.inverse_inertia[native.world.bodies.active],
            rtol=1e-6,
        )
        assert (
            level_from_scene(scene, name=loaded.level.name, inertia_model="kinetix") == loaded.level
        )


def unkeyed(tree):
    return [tree[str(k)] for k in range(len(tree))]


# --- features


def test_features_say_exactly_what_a_level_uses():
    assert features_of(LAMP) == Features(
        pairs=features_of(LAMP).pairs,
        used=features_of(LAMP).used,
        restitution=True,
        triangles=True,
        limits=True,
        welds=False,
        motors=True,
        thrusters=True,
    )
    empty = features_of(Level(name="x"))
    assert empty == Features(
        pairs=(), used=Used(bodies=(0, 1, 2, 3), joints=(), thrusters=()),
        restitution=False, triangles=False, limits=False, welds=False, motors=False,
        thrusters=False,
    )  # fmt: skip
    weld = LAMP.replace(joints=(LAMP.joints[0].replace(kind="fixed"),))
    assert features_of(weld).welds
    assert not features_of(weld).motors
    assert not features_of(weld).limits


def test_used_slots_are_those_that_a_world_fills():
    world = compiled(LAMP, "m").world
    used = features_of(world).used
    arena = (0, 1, 2, 3)
    assert used.bodies == arena + tuple(np.flatnonzero(world.bodies.active)[4:])
    assert len(used.bodies) == 4 + len(LAMP.bodies) < SIZES["m"].bodies
    assert len(used.joints) == len(LAMP.joints)
    assert len(used.thrusters) == len(LAMP.thrusters)


def brute_force_pairs(scene):
    """Tests each candidate pair by the words of the rule."""
    bodies = scene.world.bodies
    kept = []
    for i, j in candidate_pairs(SIZES["m"]).tolist():
        both = {i, j}
        modes = {int(bodies.collision_mode[k]) for k in both}
        if (
            all(bodies.active[k] for k in both)
            and any(bodies.inverse_mass[k] for k in both)
            and (2 in modes or modes == {1})
            and scene.world.collides[i, j]
        ):
            kept.append((min(both), max(both)))
    return tuple(kept)


def test_pruned_pairs_are_those_that_can_push():
    scene = compiled(LAMP, "m")
    assert pushing_pairs(scene.world) == brute_force_pairs(scene)
    assert (4, 6) not in pushing_pairs(scene.world)  # jointed
    assert (4, 5) not in pushing_pairs(scene.world)  # a ghost meets only "always"
    assert (0, 4) in pushing_pairs(scene.world)
    assert (0, 5) not in pushing_pairs(scene.world)  # both fixed


def test_features_of_several_levels_cover_each():
    capacity = SIZES["m"]
    one = features_of(LAMP, capacity=capacity)
    other = features_of(load_level(FIXTURES / "v1" / "cart_and_bell.json"), capacity=capacity)
    both = features_union([one, other], capacity)
    assert set(both.pairs) == set(one.pairs) | set(other.pairs)
    order = [(min(p), max(p)) for p in candidate_pairs(capacity).tolist()]
    assert list(both.pairs) == [pair for pair in order if pair in both.pairs]
    assert both.triangles
    assert both.limits
    assert set(both.used.bodies) == {*one.used.bodies, *other.used.bodies}
    assert features_union([one, Features()], capacity).pairs is None
    assert features_union([one, Features()], capacity).used is None


def test_features_of_a_batch_cover_each_of_its_worlds():
    levels = (LAMP, load_level(FIXTURES / "v1" / "cart_and_bell.json"))
    worlds = [compiled(level, "m").world for level in levels]
    batch = jax.tree.map(lambda *leaves: np.stack(leaves), *worlds)
    assert features_of(batch) == features_union(map(features_of, worlds), SIZES["m"])


# --- sizes


def test_the_smallest_size_that_fits():
    assert capacity_of(Level(name="x")) == SIZES["s"]
    assert capacity_of(LAMP) == SIZES["m"]
    assert capacity_of(LAMP.replace(size="locomotion")) == SIZES["locomotion"]
    many = LAMP.replace(bodies=tuple(LAMP.bodies[0].replace(id=k) for k in range(1, 9)), joints=())
    assert needed_capacity(many) == Capacity(polygons=4, circles=8, joints=0, thrusters=1)
    assert capacity_of(many) == needed_capacity(many)


def test_sizes_are_read_from_text():
    assert parse_capacity("locomotion") == SIZES["locomotion"]
    assert parse_capacity("12,4,6,2") == SIZES["l"]
    for text in ("xl", "1,2,3", "3,1,1,1", "4,1,1,-1", "9999,0,0,0"):
        with pytest.raises(LevelError, match="four numbers"):
            parse_capacity(text)
