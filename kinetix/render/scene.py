"""The picture for people: `draw`, anti-aliased, at any resolution, in any palette."""

import dataclasses
import math

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from kinetix.engine.types import State, World
from kinetix.render import poses, raster
from kinetix.render.camera import Camera, to_pixels
from kinetix.render.marks import colour_table, joint_marks, role_glyphs, thruster_marks
from kinetix.render.palette import KINETIX, Palette
from kinetix.render.style import (
    FIRST_POLYGON,
    FLOOR,
    FLOOR_GLYPH_DEPTH,
    ROLE_PATTERNS,
    STYLE,
    Style,
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _View:
    """Facts that every part of the picture needs."""

    camera: Camera
    width: int
    height: int
    palette: Palette
    style: Style

    @property
    def scale(self) -> Float[Array, ""]:
        return jnp.asarray(self.camera.pixels_per_metre)

    @property
    def edge(self) -> Float[Array, ""]:
        return jnp.maximum(self.style.outline * self.scale, self.style.least_outline)

    def pixels(self, point: Float[Array, "*s 2"]) -> Float[Array, "*s 2"]:
        return to_pixels(point, self.camera, self.width, self.height)

    def fills(self, role: Int[Array, " b"], fixed: Bool[Array, " b"]) -> Float[Array, "b 3"]:
        table = [self.palette.fill(number, dark) for dark in (False, True) for number in range(4)]
        return colour_table(tuple(table))[role + 4 * fixed]

    def outlines(self, count: int) -> Float[Array, "c 3"]:
        return jnp.broadcast_to(colour_table((self.palette.outline,)), (count, 3))


def _patterned(
    layers: raster.Layers,
    position: Float[Array, "l 2"],
    angle: Float[Array, " l"],
    role: Int[Array, " l"],
    view: _View,
) -> raster.Layers:
    """Stripes that are fixed to the bodies, where the style asks for them."""
    families = []
    for family in range(2):
        directions = [
            pattern.angles[family] if pattern and len(pattern.angles) > family else math.nan
            for pattern in ROLE_PATTERNS
        ]
        turn = jnp.asarray(directions)[role] + angle
        period = jnp.asarray([p.period if p else 1.0 for p in ROLE_PATTERNS])[role] * view.scale
        normal = jnp.stack([jnp.sin(turn), jnp.cos(turn)], axis=-1) / period[:, None]
        offset = -jnp.sum(normal * view.pixels(position), axis=-1, keepdims=True)
        lines = jnp.concatenate([normal, offset], axis=-1)
        families.append(jnp.where(jnp.isnan(turn)[:, None], 0.0, lines))
    sizes = jnp.asarray([(p.period, p.width) if p else (1.0, 0.0) for p in ROLE_PATTERNS])[role]
    return dataclasses.replace(
        layers, stripes=jnp.stack(families, axis=1), stripe=sizes * view.scale
    )


def _plain(layers: raster.Layers, view: _View) -> raster.Layers:
    """Layers without a pattern, in the same structure as those that have one."""
    if not view.style.patterns:
        return layers
    count = layers.radius.shape[0]
    return dataclasses.replace(
        layers, stripes=jnp.zeros((count, 2, 3)), stripe=jnp.ones((count, 2))
    )


def _with_glyphs(
    bodies: list[raster.Layers],
    middle: Float[Array, "l 2"],
    angle: Float[Array, " l"],
    inscribed: Float[Array, " l"],
    role: Int[Array, " l"],
    fixed: Bool[Array, " l"],
    view: _View,
) -> raster.Layers:
    """Return bodies of one kind, each followed by what lies on it and its role's glyph."""
    layers = list(bodies)
    if view.style.glyphs:
        radius = jnp.minimum(view.style.glyph_radius, view.style.glyph_share * inscribed)
        glyphs = role_glyphs(
            view.pixels(middle),
            angle,
            radius * view.scale,
            role,
            fixed,
            bodies[0].shown,
            view.palette,
        )
        layers.extend(_plain(glyph, view) for glyph in glyphs)
    return raster.interleave(*layers)


def _polygons(world: World, state: State, role: Int[Array, " b"], view: _View) -> raster.Layers:
    count = world.bodies.vertices.shape[0]
    keep = jnp.array([FLOOR, *range(FIRST_POLYGON, count)])
    corners = poses.world_corners(world, state)[keep]
    role, angle, position = role[keep], state.rotation[keep], state.position[keep]
    fixed = world.bodies.inverse_mass[keep] == 0
    layers = raster.polygon_layers(
        view.pixels(corners),
        fill=view.fills(role, fixed),
        ink=view.outlines(len(keep)),
        edge=jnp.broadcast_to(view.edge, angle.shape),
        shown=world.bodies.active[keep],
    )
    if view.style.patterns:
        layers = _patterned(layers, position, angle, role, view)
    # The nearest edge, seen from the middle of the body.
    centroid = poses.centroids(corners)
    around = raster.polygon_layers(
        (corners - centroid[:, None]) * jnp.array([1.0, -1.0]),
        fill=layers.fill,
        ink=layers.ink,
        edge=layers.edge,
        shown=layers.shown,
    )
    on_floor = jnp.arange(len(keep)) == 0
    inscribed = jnp.where(on_floor, FLOOR_GLYPH_DEPTH, around.offset.min(axis=-1))
    surface = jnp.stack([position[:, 0], corners[..., 1].max(axis=-1) - FLOOR_GLYPH_DEPTH], axis=-1)
    middle = jnp.where(on_floor[:, None], surface, centroid)
    return _with_glyphs([layers], middle, angle, inscribed, role, fixed, view)


def _circles(world: World, state: State, role: Int[Array, " b"], view: _View) -> raster.Layers:
    first = world.bodies.vertices.shape[0]
    position, angle, role = state.position[first:], state.rotation[first:], role[first:]
    fixed = world.bodies.inverse_mass[first:] == 0
    active, radius = world.bodies.active[first:], jnp.asarray(world.bodies.radius)
    outline = view.outlines(radius.shape[0])
    edge = jnp.broadcast_to(view.edge, radius.shape)
    discs = raster.disc_layers(
        view.pixels(position),
        radius * view.scale,
        fill=view.fills(role, fixed),
        ink=outline,
        edge=edge,
        shown=active,
    )
    if view.style.patterns:
        discs = _patterned(discs, position, angle, role, view)
    half = jnp.maximum(view.style.spoke, view.style.least_outline / view.scale) / 2
    across = jnp.array([-1.0, 1.0, 1.0, -1.0])[None] * half
    along = jnp.array([1.0, 1.0, 0.0, 0.0])[None] * (radius[:, None] - half)
    local = jnp.stack([jnp.broadcast_to(across, along.shape), along], axis=-1)
    turned = poses.rotated(local, jnp.broadcast_to(angle[:, None], along.shape))
    spokes = raster.polygon_layers(
        view.pixels(turned + position[:, None, :]),
        fill=outline,
        ink=outline,
        edge=jnp.zeros_like(edge),
        shown=active,
    )
    bodies = [discs, _plain(spokes, view)]
    return _with_glyphs(bodies, position, angle, radius, role, fixed, view)


def _joints(world: World, state: State, binding: Int[Array, " j"], view: _View) -> raster.Layers:
    joints = world.joints
    table = colour_table((*view.palette.motor_bindings, view.palette.uncontrolled))
    driven = joints.motor_on & ~joints.fixed
    marks = joint_marks(
        view.pixels(poses.joint_anchors(world, state)),
        jnp.asarray(state.rotation)[joints.body_a],
        joints.fixed,
        table[jnp.where(driven, binding, 4)],
        joints.active,
        view.scale,
        view.palette,
        view.style,
    )
    return _plain(marks, view)


def _thrusters(world: World, state: State, binding: Int[Array, " t"], view: _View) -> raster.Layers:
    position, direction = poses.thruster_poses(world, state)
    marks = thruster_marks(
        view.pixels(position),
        direction,
        colour_table(view.palette.thruster_bindings)[binding],
        world.thrusters.active,
        view.scale,
        view.palette,
        view.style,
    )
    return _plain(raster.interleave(*marks), view)


def draw(  # noqa: PLR0913  (what is drawn, for whom, how large, in which look)
    world: World,
    state: State,
    role: Int[Array, " b"],
    motor_binding: Int[Array, " j"],
    thruster_binding: Int[Array, " t"],
    camera: Camera,
    *,
    width: int,
    height: int,
    palette: Palette = KINETIX,
    style: Style = STYLE,
) -> UInt8[Array, "h w 3"]:
    """Draw one world.

    Pure: put it under `jax.jit` with `width`, `height`, `palette` and `style` as static arguments.
    One world at a time; batches of small pictures are the business of `pixels.py`.

    Args:
        world: What the level fixes.
        state: Where things are.
        role: Roles of the bodies, 0–3.
        motor_binding: Action channels of the joints, 0–3.
        thruster_binding: Action channels of the thrusters, 0–1.
        camera: What the picture shows; traced.
        width: Width of the picture [px].
        height: Height of the picture [px].
        palette: The colours.
        style: Thicknesses and marks.

    Returns:
        The picture, row 0 at the top.
    """
    view = _View(camera=camera, width=width, height=height, palette=palette, style=style)
    layers = raster.concatenate(
        _polygons(world, state, role, view),
        _circles(world, state, role, view),
        _joints(world, state, motor_binding, view),
        _thrusters(world, state, thruster_binding, view),
    )
    return raster.paint(layers, palette.background, width, height)


__all__ = ["draw"]
