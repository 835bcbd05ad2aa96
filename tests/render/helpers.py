"""Worlds made by hand, and a slow reference of the pixel observation."""

import dataclasses
import types

import jax
import numpy as np

from kinetix.engine.types import Bodies, Joints, State, Thrusters, World

PARAMS = types.SimpleNamespace(pixels_per_unit=100)


def static_params(capacity=(7, 3, 4, 3), downscale=4, screen=(500, 500)):
    """Return the fields of StaticEnvParams that the renderer reads."""
    polygons, circles, joints, thrusters = capacity
    return types.SimpleNamespace(
        num_polygons=polygons,
        num_circles=circles,
        num_joints=joints,
        num_thrusters=thrusters,
        screen_dim=screen,
        downscale=downscale,
        max_shape_size=2,
    )


def random_env_state(seed, capacity=(7, 3, 4, 3), reach=0.5):
    """A scene with everything in it: tilted boxes, triangles, circles, joints, thrusters.

    Some slots are inactive and some bodies lie partly or wholly outside the picture.
    """
    rng = np.random.default_rng(seed)
    p, c, j, t = capacity
    b = p + c
    f32 = np.float32
    half = rng.uniform(0.1, 0.6, (p, 1, 2))
    signs = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]])
    vertices = half * signs
    vertices[0] = np.array([2.5, 5.2]) * signs
    count = np.full(p, 4)
    for k in range(4, p):
        if rng.random() < 0.4:
            count[k] = 3
            angles = np.sort(rng.uniform(0, 2 * np.pi, 3))[::-1]
            triangle = 0.6 * np.stack([np.cos(angles), np.sin(angles)], -1)
            vertices[k, :3] = triangle - triangle.mean(0)
            vertices[k, 3] = 0
    position = rng.uniform(-reach, 5 + reach, (b, 2))
    position[0] = (2.5, -4.8)
    rotation = rng.uniform(-7, 7, b)
    rotation[0] = 0
    rotation[p::2] = 0
    fixed = rng.random(b) < 0.3
    fixed[:4] = True
    active = rng.random(b) < 0.85
    active[:4] = True
    body = lambda n: rng.integers(0, b, n).astype(np.int32)  # noqa: E731
    anchor = lambda n: rng.uniform(-0.3, 0.3, (n, 2)).astype(f32)  # noqa: E731
    zeros = np.zeros(j, f32)
    world = World(
        bodies=Bodies(
            inverse_mass=np.where(fixed, 0, rng.uniform(0.5, 3, b)).astype(f32),
            inverse_inertia=np.where(fixed, 0, 1).astype(f32),
            friction=np.ones(b, f32),
            restitution=np.zeros(b, f32),
            collision_mode=np.ones(b, np.int32),
            active=active,
            vertices=vertices.astype(f32),
            vertex_count=count.astype(np.int32),
            radius=rng.uniform(0.08, 0.9, c).astype(f32),
        ),
        joints=Joints(
            body_a=body(j),
            body_b=body(j),
            anchor_a=anchor(j),
            anchor_b=anchor(j),
            active=rng.random(j) < 0.8,
            fixed=rng.random(j) < 0.3,
            reference_angle=zeros,
            motor_on=rng.random(j) < 0.6,
            motor_speed=zeros,
            motor_power=zeros,
            limited=np.zeros(j, bool),
            limit_min=zeros,
            limit_max=zeros,
        ),
        thrusters=Thrusters(
            body=body(t),
            position=anchor(t),
            angle=rng.uniform(-4, 4, t).astype(f32),
            power=np.ones(t, f32),
            active=rng.random(t) < 0.8,
        ),
        gravity=np.array([0, -9.81], f32),
        collides=np.ones((b, b), bool),
    )
    state = State(
        position=position.astype(f32),
        rotation=rotation.astype(f32),
        velocity=np.zeros((b, 2), f32),
        angular_velocity=np.zeros(b, f32),
        touching=np.zeros(1, bool),
        overflow=np.zeros((), bool),
        cache=None,
    )
    labels = {
        "role": rng.integers(0, 4, b).astype(np.int32),
        "motor_binding": rng.integers(0, 4, j).astype(np.int32),
        "thruster_binding": rng.integers(0, 2, t).astype(np.int32),
    }
    return EnvStateStub(world, state, LabelsStub(**labels))


@jax.tree_util.register_dataclass
@dataclasses.dataclass
class LabelsStub:
    """The labels that a picture needs."""

    role: object
    motor_binding: object
    thruster_binding: object


@jax.tree_util.register_dataclass
@dataclasses.dataclass
class EnvStateStub:
    """The fields of EnvState that the renderer reads."""

    world: World
    physics: State
    labels: LabelsStub


def stack(states):
    """Several states as one batch."""
    return jax.tree.map(lambda *leaves: np.stack(leaves), *states)


ROLES = np.array([(160, 160, 160), (0, 204, 0), (0, 102, 204), (255, 102, 102)], float)
BINDINGS = np.array([(255, 255, 0), (255, 0, 255), (0, 255, 255), (255, 153, 51)], float)
DOUBT = 2e-4
"""Pixels nearer than this to an edge [px] may fall on either side in single precision."""


def _turn(vector, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack(
        [cos * vector[..., 0] - sin * vector[..., 1], sin * vector[..., 0] + cos * vector[..., 1]],
        -1,
    )


def reference_picture(env_state, static):  # noqa: C901  (one rule after the other)
    """The rules of the pixel observation, pixel by pixel on the whole canvas, in float64.

    Returns:
        The picture [x, y, 3], 0..255; the mask of pixels that rounding may decide; the mask of
        pixels that belong to marks whose artwork is ours (thrusters, joints above one pixel).
    """
    world, state, labels = env_state.world, env_state.physics, env_state.labels
    q = PARAMS.pixels_per_unit // static.downscale
    margin = int(static.max_shape_size * q)
    width, height = (side // static.downscale for side in static.screen_dim)
    edge = {1: 2, 2: 1, 4: 0}[static.downscale]
    size = (width + 2 * margin, height + 2 * margin)
    px, py = np.meshgrid(np.arange(size[0]), np.arange(size[1]), indexing="ij")
    image = np.full((*size, 3), 255.0)
    doubt, art = np.zeros(size, bool), np.zeros(size, bool)
    position = state.position.astype(np.float64)
    rotation = state.rotation.astype(np.float64)
    fixed = world.bodies.inverse_mass == 0
    p = world.bodies.vertices.shape[0]

    def colour(body):
        base = ROLES[labels.role[body]]
        if not fixed[body]:
            return base
        return np.full(3, 80.0) if labels.role[body] == 0 else base / 2

    def patch(body):
        corner = np.trunc((position[body] - 1 + 2) * q)
        corner = np.clip(corner, 0, np.array(size) - margin)
        in_x = (px >= corner[0]) & (px < corner[0] + margin)
        return in_x & (py >= corner[1]) & (py < corner[1] + margin)

    def put(depth, body, region):
        """Paint where depth (distance inside, px) >= 0; black up to the edge's thickness."""
        inside = region & (depth >= 0)
        image[inside] = colour(body)
        image[inside & (depth < edge)] = 0
        near = np.abs(depth) < DOUBT
        if edge:
            near |= np.abs(depth - edge) < DOUBT
        doubt[...] |= region & near

    def polygon(body, turn, region):
        count = world.bodies.vertex_count[body]
        local = world.bodies.vertices[body, :count].astype(np.float64)
        v = ((_turn(local, rotation[body]) if turn else local) + position[body] + 2) * q
        depth = np.full(size, np.inf)
        for k in range(count):
            (ax, ay), (bx, by) = v[k], v[(k + 1) % count]
            cross = (ax - px) * (by - py) - (ay - py) * (bx - px)
            depth = np.minimum(depth, -cross / np.hypot(bx - ax, by - ay))
        put(depth, body, region)

    if world.bodies.active[0]:
        polygon(0, False, np.ones(size, bool))
    for body in range(4, p):
        if world.bodies.active[body]:
            polygon(body, True, patch(body))
    for circle in range(world.bodies.radius.shape[0]):
        body = p + circle
        if not world.bodies.active[body]:
            continue
        centre = (position[body] + 2) * q
        radius = float(world.bodies.radius[circle]) * q
        dx, dy = px - centre[0], py - centre[1]
        region, depth = patch(body), radius - np.hypot(dx, dy)
        put(depth, body, region)
        cos, sin = np.cos(rotation[body]), np.sin(rotation[body])
        across, along = dx * cos + dy * sin, -dx * sin + dy * cos
        image[region & (depth >= 0) & (np.abs(across) < 1) & (along >= 0)] = 0
        near = (np.abs(np.abs(across) - 1) < DOUBT) | (
            (np.abs(along) < DOUBT) & (np.abs(across) < 1)
        )
        doubt |= region & (depth >= 0) & near
    for joint in range(world.joints.active.shape[0]):
        if not world.joints.active[joint]:
            continue
        a, b = world.joints.body_a[joint], world.joints.body_b[joint]
        at_a = position[a] + _turn(world.joints.anchor_a[joint].astype(float), rotation[a])
        at_b = position[b] + _turn(world.joints.anchor_b[joint].astype(float), rotation[b])
        mass = world.bodies.inverse_mass[[a, b]].astype(float)
        at = at_a if mass[0] == 0 else at_b if mass[1] == 0 else (mass @ [at_a, at_b]) / mass.sum()
        exact = (at + 2) * q
        x, y = np.round(exact).astype(int)
        side = 6 // static.downscale
        low = (x - side // 2, y - side // 2)
        box = np.zeros(size, bool)
        box[max(low[0], 0) : max(low[0] + side, 0), max(low[1], 0) : max(low[1] + side, 0)] = True
        if side > 1:
            art |= box
            continue
        driven = world.joints.motor_on[joint] and not world.joints.fixed[joint]
        image[box] = BINDINGS[labels.motor_binding[joint]] if driven else 255
        if np.any(np.abs(np.abs(exact - np.floor(exact)) - 0.5) < DOUBT):
            doubt[max(x - 2, 0) : x + 3, max(y - 2, 0) : y + 3] = True
    for thruster in range(world.thrusters.active.shape[0]):
        if world.thrusters.active[thruster]:
            body = world.thrusters.body[thruster]
            local = world.thrusters.position[thruster].astype(float)
            at = np.round((position[body] + _turn(local, rotation[body]) + 2) * q)
            reach = 16 // static.downscale
            art |= (np.abs(px - at[0]) <= reach) & (np.abs(py - at[1]) <= reach)
    crop = (slice(margin, margin + width), slice(margin, margin + height))
    return image[crop], doubt[crop], art[crop]
