"""Brax (package `brax`): scenes as trees of links. See protocol.py.

A body that hangs at nothing slides along x and y and turns about z; a pin makes a body a child of
the other one; a weld is a pin with limits at zero, as links without freedom are unknown to it. What
a chain closes to a loop cannot be said. Shapes are those of planar_model.py.

Settings: `pipeline` (positional, spring, generalized), `substeps`.
"""

import functools
import warnings
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
from brax.generalized import pipeline as generalized
from brax.io import mjcf
from brax.positional import pipeline as positional
from brax.spring import pipeline as spring
from jax_scenes import motor_law, part, repeated, serve_compiled, thrust
from link_tree import Link, tree_of
from planar_model import empty_spec, may_meet, put_shape, quaternion, turned
from protocol import Scene, UnsaidError, axial_inertia

PIPELINES = {"positional": positional, "spring": spring, "generalized": generalized}
MOST_PAIRS = {"positional": 250, "spring": 250, "generalized": 30}
"""Pairs of bodies that may meet with which a step still takes no more than a second or so: all of
them are tested in every step, and each gives four contacts."""
STIFF = 1e-6
"""Half the range of the angle of a weld [rad]; there must be some."""

FLAT = 1e3
"""Moment of inertia about x and y [kg m²]. Two of its pipelines count on all six freedoms of a body
at a contact, at whose depth a small one would make everything yield."""

TWICE = 0.5
"""Share of a correction of places that is applied where boxes meet: it adds up those of all
contacts, of which thick boxes have two for every one in the plane."""


def model_of(scene: Scene, links: list[Link], timestep: float) -> mujoco.MjModel:
    """Return the tree as a model of MuJoCo, which is what Brax reads."""
    spec = empty_spec(scene, timestep)
    bodies = scene["bodies"]
    for index, body in enumerate(bodies):
        if not body["mass"]:
            geom = spec.worldbody.add_geom(name=f"g{index}", pos=[*body["position"], 0.0])
            geom.quat = quaternion(body["angle"])
            _fill(geom, body)
    made: dict[int | None, Any] = {None: spec.worldbody}
    origins = {link.index: link.origin for link in links}
    for link in links:
        made[link.index] = _add_link(made[link.parent], scene, link, origins)
    for i, j in _meeting(bodies):
        friction = max(bodies[k]["friction"] for k in (i, j))
        pair = spec.add_pair(geomname1=f"g{i}", geomname2=f"g{j}", condim=3)
        pair.friction = [friction, friction, 0.0, 0.0, 0.0]
    for name in _driven(scene, links):
        actuator = spec.add_actuator(target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_motor()
    return spec.compile()


def _driven(scene: Scene, links: list[Link]) -> list[str]:
    """Return joints of the model that need an actuator."""
    motors = [f"t{link.index}" for link in links if _motor(scene, link)]
    pushed = sorted({thruster["body"] for thruster in _thrusters(scene)})
    return [*motors, *(f"{axis}{index}" for index in pushed for axis in "xyt")]


def _motor(scene: Scene, link: Link) -> bool:
    return bool(scene["motor"] and link.joint and link.joint["motor"])


def _thrusters(scene: Scene) -> list[Scene]:
    return [each for each in scene["thrusters"] if scene["bodies"][each["body"]]["mass"]]


def _fill(geom: Any, told: Scene) -> None:
    """Shape, and no contacts but those of named pairs."""
    put_shape(geom, told)
    geom.contype = geom.conaffinity = 0
    geom.condim = 3
    geom.friction = [told["friction"], 0.0, 0.0]


def _add_link(parent: Any, scene: Scene, link: Link, origins: Any) -> Any:
    told, centre = scene["bodies"][link.index], [-x for x in link.origin]
    body = parent.add_body(name=f"b{link.index}")
    geom = body.add_geom(name=f"g{link.index}", pos=[*centre, 0.0])
    _fill(geom, told)
    body.explicitinertial = True
    body.mass, body.ipos = told["mass"], [*centre, 0.0]
    body.inertia = [FLAT, FLAT, told["inertia"]]
    if link.joint is None:
        for name, axis in (("x", [1, 0, 0]), ("y", [0, 1, 0])):
            body.add_joint(name=f"{name}{link.index}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    hinge = body.add_joint(name=f"t{link.index}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    if link.joint is None:
        return body
    place, angle = [0.0, 0.0], 0.0
    pin, holder = link.pin, scene["bodies"][link.holder]
    if link.parent is None:
        place, angle = holder["position"], holder["angle"]
    else:
        pin = [x - y for x, y in zip(pin, origins[link.parent], strict=True)]
    offset = turned([*pin, 0.0], angle)
    body.pos = [place[0] + offset[0], place[1] + offset[1], 0.0]
    body.quat = quaternion(angle + link.sign * link.joint["reference"])
    limits = [-STIFF, STIFF] if link.joint["weld"] else link.joint["limits"]
    if limits:
        hinge.limited = True
        hinge.range = sorted(link.sign * limit for limit in limits)
    return body


def start_of(scene: Scene, links: list[Link], model: mujoco.MjModel) -> tuple[Any, Any]:
    """Coordinates and speeds at the start, as the model orders them."""
    q, speeds = [0.0] * model.nq, [0.0] * model.nv
    for link in links:
        told = scene["bodies"][link.index]
        if link.joint is None:
            values = {"x": (told["position"][0], told["velocity"][0])}
            values["y"] = told["position"][1], told["velocity"][1]
            values["t"] = told["angle"], told["angular_velocity"]
        else:
            holder = scene["bodies"][link.holder]
            turn = told["angle"] - holder["angle"] - link.sign * link.joint["reference"]
            values = {"t": (turn, told["angular_velocity"] - holder["angular_velocity"])}
        for axis, (value, speed) in values.items():
            joint = model.joint(f"{axis}{link.index}")
            q[joint.qposadr[0]], speeds[joint.dofadr[0]] = float(value), float(speed)
    return q, speeds


class BraxScene:
    """One scene."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build the tree and Brax's system of it."""
        links = _sayable(scene, settings["pipeline"])
        self._pipeline = PIPELINES[settings["pipeline"]]
        self._substeps = settings["substeps"]
        self._recorded = scene["recorded"]
        self._model = model_of(scene, links, scene["dt"] / self._substeps)
        mjcf.validate_model(self._model)
        self._place = {link.index: self._model.body(f"b{link.index}").id - 1 for link in links}
        self._motors = [link for link in links if _motor(scene, link)]
        self._pushed = [thruster["body"] for thruster in _thrusters(scene)]
        q, speeds = start_of(scene, links, self._model)
        bodies = scene["bodies"]
        self.given = {
            "system": _system(scene, self._model),
            "q": q,
            "speeds": speeds,
            "bodies": [_seen_body(index, bodies, links) for index in range(len(bodies))],
            "motors": [_seen_motor(link, bodies) for link in self._motors],
            "thrusters": [part(t, "position", "angle", "power") for t in _thrusters(scene)],
            "motor": scene["motor"],
            "thruster": scene["thruster"],
        }

    def begin(self, given: Any) -> Any:
        """Its state at the start."""
        q, speeds = (jnp.asarray(given[key], jnp.float32) for key in ("q", "speeds"))
        return self._pipeline.init(given["system"], q, speeds)

    def advance(self, given: Any, state: Any) -> Any:
        """Advance by one frame."""
        return repeated(functools.partial(self._step, given), state, self._substeps)

    def _step(self, given: Any, state: Any) -> Any:
        return self._pipeline.step(given["system"], state, self._actions(given, state))

    def seen(self, given: Any, state: Any) -> jax.Array:
        """Return the poses and velocities, as the protocol asks."""
        return jnp.stack([self._row(given, state, index) for index in range(self._recorded)])

    def _row(self, given: Any, state: Any, index: int) -> jax.Array:
        told = given["bodies"][index]
        if index not in self._place:
            return jnp.asarray([*told["position"], told["angle"], 0.0, 0.0, 0.0])
        place = self._place[index]
        spot, rotation = state.x.pos[place], state.x.rot[place]
        angle, spin = 2 * jnp.arctan2(rotation[3], rotation[0]), state.xd.ang[place, 2]
        c, s, (x, y) = jnp.cos(angle), jnp.sin(angle), told["centre"]
        arm = jnp.stack([c * x - s * y, s * x + c * y])
        velocity = state.xd.vel[place, :2] + spin * jnp.stack([-arm[1], arm[0]])
        return jnp.concatenate([spot[:2] + arm, jnp.stack([angle]), velocity, jnp.stack([spin])])

    def _actions(self, given: Any, state: Any) -> jax.Array:
        """In the order of `_driven`."""
        found = []
        for link, told in zip(self._motors, given["motors"], strict=True):
            joint = self._model.joint(f"t{link.index}")
            turn, speed = state.q[joint.qposadr[0]], state.qd[joint.dofadr[0]]
            sign = told["sign"]
            pull = motor_law(told, given["motor"], sign * turn, sign * speed)
            found.append(sign * pull * told["inertia"])
        pushes: dict[int, Any] = {}
        for index, told in zip(self._pushed, given["thrusters"], strict=True):
            push = thrust(told, given["thruster"], self._row(given, state, index)[2])
            pushes[index] = pushes.get(index, 0.0) + push
        found += [pushes[index][k] for index in sorted(pushes) for k in range(3)]
        return jnp.stack(found) if found else jnp.zeros(0)


def _sayable(scene: Scene, pipeline: str) -> list[Link]:
    """Return the tree of a scene that Brax has words for.

    Raises:
        UnsaidError: It has none.
    """
    if scene["inactive"]:
        raise UnsaidError("bodies cannot be switched off")
    if pipeline == "generalized" and any(body["restitution"] for body in scene["bodies"]):
        raise UnsaidError("it has no coefficient of restitution")
    if len(_meeting(scene["bodies"])) > MOST_PAIRS[pipeline]:
        raise UnsaidError("more bodies than it can step in a reasonable time")
    links = tree_of(scene)
    if not links:
        raise UnsaidError("no body that moves")
    hanging = {link.index for link in links if link.joint is not None}
    if any(thruster["body"] in hanging for thruster in _thrusters(scene)):
        raise UnsaidError("a thruster on a body that hangs at another")
    return links


def _system(scene: Scene, model: mujoco.MjModel) -> Any:
    with warnings.catch_warnings():
        # It says of itself that it is no longer maintained.
        warnings.simplefilter("ignore", UserWarning)
        system = mjcf.load_model(model)
    bounce = [0.0] * model.ngeom
    for index, body in enumerate(scene["bodies"]):
        bounce[model.geom(f"g{index}").id] = body["restitution"]
    return system.replace(
        elasticity=jnp.asarray(bounce),
        collide_scale=jnp.asarray(TWICE if _boxes_meet(scene["bodies"]) else 1.0),
        # It is checked already, and is not the same for two scenes of a kind.
        mj_model=None,
    )


def _meeting(bodies: list[Scene]) -> list[tuple[int, int]]:
    """Pairs of bodies that may collide, of which one at least moves."""
    return [
        (j, i)
        for i, first in enumerate(bodies)
        for j, second in enumerate(bodies[:i])
        if may_meet(first, second) and (first["mass"] or second["mass"])
    ]


def _boxes_meet(bodies: list[Scene]) -> bool:
    return any("vertices" in bodies[i] and "vertices" in bodies[j] for i, j in _meeting(bodies))


def _seen_body(index: int, bodies: list[Scene], links: list[Link]) -> dict[str, Any]:
    origin = next((link.origin for link in links if link.index == index), [0.0, 0.0])
    told = bodies[index]
    return {
        "centre": [-x for x in origin],
        "position": told["position"],
        "angle": told["angle"],
    }


def _seen_motor(link: Link, bodies: list[Scene]) -> dict[str, Any]:
    joint = link.joint
    assert joint is not None
    inertia = axial_inertia(bodies[joint["a"]], bodies[joint["b"]])
    return part(joint, "motor", "limits") | {"inertia": inertia, "sign": link.sign}


if __name__ == "__main__":
    serve_compiled(BraxScene, "brax")
