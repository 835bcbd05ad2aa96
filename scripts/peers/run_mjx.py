"""MJX, MuJoCo in JAX (package `mujoco-mjx`): scenes as planar_model.py says them. See protocol.py.

Settings: `substeps`.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
from jax_scenes import motor_law, part, repeated, serve_compiled, thrust
from mujoco import mjx
from planar_model import coordinates, planar_model, starting_speeds
from protocol import Scene, UnsaidError, axial_inertia, motors_of


class MjxScene:
    """One scene."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build and compile MuJoCo's model, and put it on MJX's side."""
        self._scene = scene
        self._substeps = settings["substeps"]
        self._place = coordinates(scene)
        if not self._place:
            raise UnsaidError("no body that moves")
        self._motors = motors_of(scene)
        self._thrusters = [each for each in scene["thrusters"] if each["body"] in self._place]
        bodies = scene["bodies"]
        self.given = {
            "model": mjx.put_model(planar_model(scene, timestep=scene["dt"] / self._substeps)),
            "speeds": [float(speed) for speed in starting_speeds(scene)],
            "origins": [[*body["position"], body["angle"]] for body in bodies],
            "inertias": [axial_inertia(bodies[j["a"]], bodies[j["b"]]) for j in self._motors],
            "motors": [part(joint, "motor", "limits", "reference") for joint in self._motors],
            "thrusters": [part(each, "position", "angle", "power") for each in self._thrusters],
            "motor": scene["motor"],
            "thruster": scene["thruster"],
        }

    def begin(self, given: Any) -> Any:
        """Its state at the start."""
        data = mjx.make_data(given["model"])
        return data.replace(qvel=jnp.asarray(given["speeds"]))

    def advance(self, given: Any, state: Any) -> Any:
        """Advance by one frame."""
        return repeated(functools.partial(self._step, given), state, self._substeps)

    def _step(self, given: Any, state: Any) -> Any:
        if self._motors or self._thrusters:
            state = state.replace(qfrc_applied=self._forces(given, state))
        return mjx.step(given["model"], state)

    def seen(self, given: Any, state: Any) -> jax.Array:
        """Return the poses and velocities, as the protocol asks."""
        return self._every(given, state)[: self._scene["recorded"]]

    def _every(self, given: Any, state: Any) -> jax.Array:
        rows = []
        for index, origin in enumerate(given["origins"]):
            moved = jnp.zeros(6)
            if index in self._place:
                own = slice(self._place[index], self._place[index] + 3)
                moved = jnp.concatenate([state.qpos[own], state.qvel[own]])
            rows.append(moved + jnp.concatenate([jnp.asarray(origin), jnp.zeros(3)]))
        return jnp.stack(rows)

    def _forces(self, given: Any, state: Any) -> jax.Array:
        rows, found = self._every(given, state), jnp.zeros_like(state.qfrc_applied)
        told_motors = zip(self._motors, given["motors"], given["inertias"], strict=True)
        for joint, told, inertia in told_motors:
            a, b = rows[joint["a"]], rows[joint["b"]]
            turn = b[2] - a[2] - told["reference"]
            pull = motor_law(told, given["motor"], turn, b[5] - a[5]) * inertia
            for index, sign in ((joint["a"], -1), (joint["b"], 1)):
                if index in self._place:
                    found = found.at[self._place[index] + 2].add(sign * pull)
        for thruster, told in zip(self._thrusters, given["thrusters"], strict=True):
            place = self._place[thruster["body"]]
            push = thrust(told, given["thruster"], rows[thruster["body"], 2])
            found = found.at[place : place + 3].add(push)
        return found


if __name__ == "__main__":
    serve_compiled(MjxScene, "mujoco-mjx")
