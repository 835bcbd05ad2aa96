"""jax2d: scenes in its own words, as a black box behind `PhysicsEngine.step`. See protocol.py.

Settings: `iterations`, `substeps`. Scenes of one set are padded to one capacity and run together.
"""

import importlib.metadata
import os
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax2d.engine import PhysicsEngine, calculate_collision_matrix, create_empty_sim
from jax2d.sim_state import SimParams, StaticSimParams
from jax_timing import stacked, time_loop
from protocol import Scene, read_job, write_answer

FRICTION = 0.4 * 2**0.5
"""Coefficient of friction between two bodies of friction value 1."""
NO_CLIP = 1e6
MODES = {"ghost": 0, "normal": 1, "always": 2}


def static_of(scenes: list[Scene], iterations: int) -> StaticSimParams:
    """Return the least capacities that all scenes fit in and that the engine can be made with.

    It needs one candidate pair of every kind, so two circles, and two polygons that may meet.
    """

    def most(count: Any) -> int:
        return max(count(scene) for scene in scenes)

    fixed = min(_leading_fixed(scene) for scene in scenes)
    return StaticSimParams(
        num_polygons=max(fixed + 2, most(lambda s: sum("vertices" in b for b in s["bodies"]))),
        num_circles=max(2, most(lambda s: sum("radius" in b for b in s["bodies"]))),
        num_joints=max(1, most(lambda s: len(s["joints"]))),
        num_thrusters=max(1, most(lambda s: len(s["thrusters"]))),
        num_solver_iterations=iterations,
        num_static_fixated_polys=fixed,
    )


def _leading_fixed(scene: Scene) -> int:
    """Count the first polygons that are fixed: it never pairs them with each other."""
    fixed = [not body["mass"] for body in scene["bodies"] if "vertices" in body]
    return fixed.index(False) if False in fixed else len(fixed)


def params_of(scene: Scene, substeps: int) -> SimParams:
    """Return Jax2D's default parameters, without clips."""
    return SimParams(
        dt=scene["dt"] / substeps,
        clip_position=NO_CLIP,
        clip_velocity=NO_CLIP,
        clip_angular_velocity=NO_CLIP,
    )


def slots_of(scene: Scene, static: StaticSimParams) -> list[int]:
    """Return the index of every body: polygons first, circles from `num_polygons` on."""
    polygon, circle, slots = 0, static.num_polygons, []
    for body in scene["bodies"]:
        if "vertices" in body:
            slots.append(polygon)
            polygon += 1
        else:
            slots.append(circle)
            circle += 1
    return slots


def state_of(scene: Scene, static: StaticSimParams) -> Any:
    """Return a scene as its state, from its own empty one."""
    state = jax.tree.map(
        np.array, create_empty_sim(static, add_floor=False, add_walls_and_ceiling=False)
    )
    slots = slots_of(scene, static)
    shapes = {"polygon": state.polygon, "circle": state.circle}
    for shape in shapes.values():
        shape.active[:] = False
    for body, slot in zip(scene["bodies"], slots, strict=True):
        polygon = "vertices" in body
        row = slot if polygon else slot - static.num_polygons
        _put_body(shapes["polygon" if polygon else "circle"], row, body, not scene["inactive"])
    _put_joints(state.joint, scene, slots)
    _put_thrusters(state.thruster, scene, slots)
    state = state.replace(gravity=np.array(scene["gravity"], np.float32))
    matrix = calculate_collision_matrix(static, jax.tree.map(jnp.asarray, state.joint))
    return state.replace(collision_matrix=np.array(matrix))


def _put_body(shape: Any, row: int, body: Scene, active: bool) -> None:
    shape.position[row] = body["position"]
    shape.rotation[row] = body["angle"]
    shape.velocity[row] = body["velocity"] if body["mass"] else 0
    shape.angular_velocity[row] = body["angular_velocity"] if body["mass"] else 0
    shape.inverse_mass[row] = 1 / body["mass"] if body["mass"] else 0
    shape.inverse_inertia[row] = 1 / body["inertia"] if body["inertia"] else 0
    shape.friction[row] = body["friction"] / FRICTION
    shape.restitution[row] = body["restitution"]
    shape.collision_mode[row] = MODES[body["collision"]]
    shape.active[row] = active
    if "radius" in body:
        shape.radius[row] = body["radius"]
    else:
        first, *rest = body["vertices"]
        corners = [first, *reversed(rest)]  # clockwise
        shape.n_vertices[row] = len(corners)
        shape.vertices[row] = 0
        shape.vertices[row, : len(corners)] = corners


def _put_joints(joints: Any, scene: Scene, slots: list[int]) -> None:
    joints.active[:] = False
    for row, joint in enumerate(scene["joints"]):
        joints.active[row] = not scene["inactive"]
        joints.a_index[row], joints.b_index[row] = slots[joint["a"]], slots[joint["b"]]
        joints.a_relative_pos[row] = joint["anchor_a"]
        joints.b_relative_pos[row] = joint["anchor_b"]
        joints.is_fixed_joint[row] = joint["weld"]
        joints.rotation[row] = joint["reference"]
        joints.motor_on[row] = joint["motor"] is not None
        joints.motor_speed[row], joints.motor_power[row] = joint["motor"] or (0, 0)
        joints.motor_has_joint_limits[row] = joint["limits"] is not None
        joints.min_rotation[row], joints.max_rotation[row] = joint["limits"] or (0, 0)


def _put_thrusters(thrusters: Any, scene: Scene, slots: list[int]) -> None:
    thrusters.active[:] = False
    for row, thruster in enumerate(scene["thrusters"]):
        thrusters.active[row] = not scene["inactive"]
        thrusters.object_index[row] = slots[thruster["body"]]
        thrusters.relative_position[row] = thruster["position"]
        thrusters.rotation[row] = thruster["angle"]
        thrusters.power[row] = thruster["power"]


def actions_of(scene: Scene, static: StaticSimParams) -> np.ndarray:
    """Return the constant action: motors, then thrusters."""
    return np.array(
        [scene["motor"]] * static.num_joints + [scene["thruster"]] * static.num_thrusters,
        np.float32,
    )


def make_step(static: StaticSimParams, substeps: int) -> Any:
    """One frame of one world. Not to be called under jit, which its engine's making is not for."""
    engine = PhysicsEngine(static)

    def step(state: Any, params: SimParams, actions: jax.Array) -> Any:
        for _ in range(substeps):
            state, _ = engine.step(state, params, actions)
        return state

    return step


def rollout(step: Any, states: Any, params: Any, actions: jax.Array, steps: int) -> np.ndarray:
    """(step, world, slot, 6), polygons before circles; with the start."""

    def seen(states: Any) -> jax.Array:
        shapes = [
            jnp.concatenate(
                [
                    shape.position,
                    shape.rotation[..., None],
                    shape.velocity,
                    shape.angular_velocity[..., None],
                ],
                axis=-1,
            )
            for shape in (states.polygon, states.circle)
        ]
        return jnp.concatenate(shapes, axis=1)

    @jax.jit
    def scanned(states: Any, params: Any, actions: jax.Array) -> jax.Array:
        def once(states: Any, _: None) -> Any:
            states = jax.vmap(step)(states, params, actions)
            return states, seen(states)

        return jax.lax.scan(once, states, None, length=steps)[1]

    rest = scanned(states, params, actions)
    return np.concatenate([np.asarray(seen(states))[None], np.asarray(rest)])


def record(job: dict[str, Any]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return all sets, each in one program."""
    motions = {}
    settings = job["settings"]
    for name, scenes in job["sets"].items():
        static = static_of(scenes, settings["iterations"])
        every = rollout(
            make_step(static, settings["substeps"]),
            stacked([state_of(scene, static) for scene in scenes]),
            stacked([params_of(scene, settings["substeps"]) for scene in scenes]),
            jnp.stack([actions_of(scene, static) for scene in scenes]),
            max(scene["steps"] for scene in scenes),
        )
        for index, scene in enumerate(scenes):
            slots = slots_of(scene, static)[: scene["recorded"]]
            motions[f"{name}/{index}"] = every[: scene["steps"] + 1, index][:, slots]
    return {"unsaid": {}}, motions


def measure(job: dict[str, Any]) -> dict[str, Any]:
    """Seconds per step and world, all scenes cycled over the batch; the compile time apart."""
    settings, batch = job["settings"], job["batch"]
    scenes = [job["scenes"][k % len(job["scenes"])] for k in range(min(batch, len(job["scenes"])))]
    static = static_of(scenes, settings["iterations"])
    kinds = stacked([state_of(scene, static) for scene in scenes])
    chosen = jnp.arange(batch) % len(scenes)
    states = jax.tree.map(lambda x: x[chosen], kinds)
    actions = jnp.stack([actions_of(scene, static) for scene in scenes])[chosen]
    params = params_of(scenes[0], settings["substeps"])
    step = jax.vmap(make_step(static, settings["substeps"]), in_axes=(0, None, 0))

    def loop(states: Any, actions: jax.Array, count: jax.Array) -> Any:
        return jax.lax.fori_loop(0, count[0], lambda _, s: step(s, params, actions), states)

    return time_loop(loop, batch, states, actions)


def main() -> None:
    """Do the job."""
    job, folder = read_job()
    # How long it compiles is measured with kinetix-env's environment.
    jax.config.update("jax_compilation_cache_dir", os.environ.get("KINETIX_PEER_CACHE"))
    if job["task"] == "record":
        answer, motions = record(job)
        np.savez(folder / "motions.npz", **motions)
    else:
        answer = measure(job)
    versions = {"version": importlib.metadata.version("jax2d"), "jax": jax.__version__}
    write_answer(folder, answer | versions)


if __name__ == "__main__":
    main()
