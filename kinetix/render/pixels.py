"""The pixel observation: the look, the size and the axes that agents are trained on.

The picture keeps the conventions of the published environment: a pixel is tested at its integer
index, a polygon or circle is cut off outside a square patch round its body, nothing is
anti-aliased. It always uses the palette `KINETIX`. The thruster's mark is our own artwork, and so
is a joint's where it is larger than one pixel.
"""

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.aliases import also_named
from kinetix.engine.types import State, World
from kinetix.errors import KinetixError
from kinetix.forks import refuse_forked_process
from kinetix.pytree import pytree, static
from kinetix.render import poses
from kinetix.render.palette import KINETIX
from kinetix.render.spans import (
    FAR,
    Span,
    box_span,
    byte_rows,
    disc_span,
    intersection,
    paint,
    polygon_span,
    ray_span,
)
from kinetix.render.style import FIRST_POLYGON, FLOOR, THRUSTER_FLAME, THRUSTER_NOZZLE

if TYPE_CHECKING:
    from kinetix.environment.params import EnvParams, StaticEnvParams
    from kinetix.environment.state import EnvState

JOINT_PIXELS: Final = 6
"""Side of a joint's mark in the full-size picture at 100 pixels a metre."""
THRUSTER_PIXELS: Final = 16
"""Side of a thruster's mark in that picture."""

_FIXED: Final = 4
_BLACK: Final = 8
_BINDING: Final = 9
_WHITE: Final = 13
_NOZZLE: Final = 4
_COLOURS: Final = np.array(
    [
        *KINETIX.roles,
        # Half of the role's colour, not rounded: fixed red is (127.5, 51, 51).
        *(np.array(KINETIX.roles) * KINETIX.fixed_shade),
        KINETIX.outline,
        *KINETIX.motor_bindings,
        KINETIX.background,
    ],
    np.float32,
)
"""Colours by code: roles 0–3, fixed roles 4–7, black, bindings 9–12, white. [0, 255]"""


@pytree
class PixelGrid:
    """Sizes of one kind of pixel observation; nothing in it is traced."""

    width: int = static()
    height: int = static()
    per_metre: int = static()
    """Pixels per metre."""
    margin: int = static()
    """Hidden border round the picture, and side of the patch a body is drawn in [px]."""
    margin_metres: float = static()
    edge: float = static()
    """Thickness of the black edges [px]."""
    joint: int = static()
    """Side of a joint's mark [px]."""
    thruster: int = static()
    """Side of a thruster's mark [px]."""


def pixel_grid(env_params: "EnvParams", static_env_params: "StaticEnvParams") -> PixelGrid:
    """Return the sizes that these parameters ask for.

    Raises:
        KinetixError: The two are swapped, or nothing would be left of the picture.
    """
    if not hasattr(static_env_params, "downscale") or not hasattr(env_params, "pixels_per_unit"):
        kinds = f"{type(env_params).__name__}, {type(static_env_params).__name__}"
        raise KinetixError(f"expected EnvParams, StaticEnvParams, in this order, got {kinds}")
    if min(static_env_params.downscale, *static_env_params.screen_dim) < 1 or (
        static_env_params.downscale > min(*static_env_params.screen_dim, env_params.pixels_per_unit)
    ):
        raise KinetixError(
            f"downscale={static_env_params.downscale}: expected 1 up to the sides of "
            f"screen_dim={static_env_params.screen_dim} and to "
            f"pixels_per_unit={env_params.pixels_per_unit}"
        )
    downscale = static_env_params.downscale
    per_unit = int(env_params.pixels_per_unit)
    per_metre = per_unit // downscale
    width, height = (side // downscale for side in static_env_params.screen_dim)
    return PixelGrid(
        width=width,
        height=height,
        per_metre=per_metre,
        margin=int(static_env_params.max_shape_size * per_metre),
        margin_metres=float(static_env_params.max_shape_size),
        edge=float(2 // downscale),
        joint=math.ceil((JOINT_PIXELS // downscale) * per_unit / 100),
        thruster=math.ceil((THRUSTER_PIXELS // downscale) * per_unit / 100),
    )


def _canvas(point: Float[Array, "*s 2"], grid: PixelGrid) -> Float[Array, "*s 2"]:
    return (point + grid.margin_metres) * grid.per_metre


def _patch(position: Float[Array, "b 2"], grid: PixelGrid, x: Float[Array, " x"]) -> Span:
    """Return the square in which a body is drawn: what sticks out of it is cut off."""
    corner = jnp.trunc(_canvas(position - grid.margin_metres / 2, grid))
    most = jnp.array([grid.width + grid.margin, grid.height + grid.margin], corner.dtype)
    return box_span(jnp.clip(corner, 0, most[None, :]), grid.margin, x)


@pytree
class _Layers:
    """Shapes of one kind, with how many layers each of them has."""

    spans: Span
    shown: Bool[Array, " q"]
    code: Int[Array, " q"]


def _body_codes(world: World, role: Int[Array, " b"]) -> Int[Array, " b"]:
    return jnp.where(world.bodies.inverse_mass == 0, role + _FIXED, role)


def _polygons(
    world: World, state: State, role: Int[Array, " b"], grid: PixelGrid, x: Float[Array, " x"]
) -> list[_Layers]:
    """Floor and polygons; where there are edges, a black layer under each."""
    vertices = _canvas(poses.world_corners(world, state), grid)
    floor = _canvas(poses.corners(world)[FLOOR] + state.position[FLOOR][None, :], grid)
    count = vertices.shape[0]
    vertices = jnp.concatenate([floor[None], vertices[FIRST_POLYGON:]])
    code = _body_codes(world, role)
    keep = np.r_[FLOOR, FIRST_POLYGON:count]
    patch = _patch(state.position[:count], grid, x)
    everywhere = (
        jnp.full_like(patch[0][:1], -FAR),
        jnp.full_like(patch[1][:1], FAR),
    )
    patch = (
        jnp.concatenate([everywhere[0], patch[0][FIRST_POLYGON:]]),
        jnp.concatenate([everywhere[1], patch[1][FIRST_POLYGON:]]),
    )
    shown = world.bodies.active[keep]
    insets = ((0.0, jnp.full(len(keep), _BLACK)), (grid.edge, code[keep]))
    return [
        _Layers(
            spans=intersection(polygon_span(vertices, inset, x), patch),
            shown=shown,
            code=paint,
        )
        for inset, paint in (insets if grid.edge else insets[1:])
    ]


def _circles(
    world: World, state: State, role: Int[Array, " b"], grid: PixelGrid, x: Float[Array, " x"]
) -> list[_Layers]:
    """Return circles: edge, fill, radius line."""
    first = world.bodies.vertices.shape[0]
    position = state.position[first:]
    centre = _canvas(position, grid)
    patch = _patch(position, grid, x)
    shown = world.bodies.active[first:]
    black = jnp.full(shown.shape, _BLACK)
    radius = world.bodies.radius * grid.per_metre
    whole = intersection(disc_span(centre, radius, x), patch)
    inner = intersection(disc_span(centre, radius - grid.edge, x), patch)
    line = intersection(whole, ray_span(centre, state.rotation[first:], x))
    fill = _Layers(spans=inner, shown=shown, code=_body_codes(world, role)[first:])
    edge = _Layers(spans=whole, shown=shown, code=black)
    spoke = _Layers(spans=line, shown=shown, code=black)
    return [edge, fill, spoke] if grid.edge else [fill, spoke]


def _joints(
    world: World,
    state: State,
    binding: Int[Array, " j"],
    grid: PixelGrid,
    x: Float[Array, " x"],
) -> list[_Layers]:
    """Return joints: one pixel, or a square for a weld and a disc for a revolute joint."""
    joints = world.joints
    centre = jnp.round(_canvas(poses.joint_anchors(world, state), grid))
    square = box_span(centre - grid.joint // 2, grid.joint, x)
    half = (grid.joint - 1) / 2
    middle = centre - grid.joint // 2 + half
    # A quarter of a pixel more than half the side keeps small discs from turning into crosses.
    disc = disc_span(middle, jnp.full(middle.shape[:1], half + 0.25), x)
    weld = joints.fixed[:, None]
    spans = tuple(jnp.where(weld, s, d) for s, d in zip(square, disc, strict=True))
    driven = joints.motor_on & ~joints.fixed
    code = jnp.where(driven, binding + _BINDING, _WHITE)
    return [_Layers(spans=(spans[0], spans[1]), shown=joints.active, code=code)]


def _thrusters(
    world: World,
    state: State,
    binding: Int[Array, " t"],
    grid: PixelGrid,
    x: Float[Array, " x"],
) -> list[_Layers]:
    """Return thrusters: a flame in the binding's colour behind a grey nozzle."""
    position, direction = poses.thruster_poses(world, state)
    # The mark covers `thruster` pixels round the rounded attachment: its middle is half a pixel
    # lower.
    middle = jnp.round(_canvas(position, grid)) - 0.5
    layers = []
    for outline, code in (
        (THRUSTER_FLAME, binding + _BINDING),
        (THRUSTER_NOZZLE, jnp.full(binding.shape, _NOZZLE)),
    ):
        local = jnp.asarray(outline, jnp.float32)[None] * grid.thruster
        shape = (position.shape[0], *local.shape[1:])
        turned = poses.rotated(
            jnp.broadcast_to(local, shape), jnp.broadcast_to(direction[:, None], shape[:2])
        )
        spans = polygon_span(turned + middle[:, None, :], 0.0, x)
        layers.append(_Layers(spans=spans, shown=world.thrusters.active, code=code))
    return layers


def _interleaved(layers: list[_Layers], grid: PixelGrid) -> tuple[Array, Array, Array]:
    """All layers of a kind in drawing order: one shape after the other, its layers together."""
    rows = [byte_rows(s.spans, s.shown, grid.margin, grid.height) for s in layers]
    low, count = (jnp.stack(part, axis=1) for part in zip(*rows, strict=True))
    code = jnp.stack([layer.code for layer in layers], axis=1)
    flat = (-1, low.shape[-1])
    return low.reshape(flat), count.reshape(flat), code.reshape(-1)


def pixel_codes(
    world: World,
    state: State,
    role: Int[Array, " b"],
    motor_binding: Int[Array, " j"],
    thruster_binding: Int[Array, " t"],
    grid: PixelGrid,
) -> Int[Array, "x y"]:
    """Return each pixel's index into the table of colours.

    Args:
        world: What the level fixes.
        state: Where things are.
        role: Roles of the bodies, 0–3.
        motor_binding: Action channels of the joints, 0–3.
        thruster_binding: Action channels of the thrusters, 0–1.
        grid: Sizes of the picture.
    """
    x = jnp.arange(grid.width, dtype=jnp.float32) + grid.margin
    kinds = [
        _interleaved(layers, grid)
        for layers in (
            _polygons(world, state, role, grid, x),
            _circles(world, state, role, grid, x),
            _joints(world, state, motor_binding, grid, x),
            _thrusters(world, state, thruster_binding, grid, x),
        )
    ]
    low, count, code = (jnp.concatenate(part) for part in zip(*kinds, strict=True))
    # Without this the compiler computes the spans again for every pixel.
    low, count, code = jax.lax.optimization_barrier((low, count, code))
    return paint(low, count, code, _WHITE, grid.height)


@functools.lru_cache(maxsize=64)  # later calls get the compiled function
def _make_renderer(grid: PixelGrid, scale: float) -> Callable[["EnvState"], Float[Array, "x y 3"]]:
    colours = _COLOURS * np.float32(scale)

    @jax.jit  # by itself each of some three hundred operations would be compiled alone
    def draw(env_state: Any) -> Float[Array, "x y 3"]:
        labels = env_state.labels
        codes = pixel_codes(
            env_state.world,
            env_state.physics,
            labels.role,
            labels.motor_binding,
            labels.thruster_binding,
            grid,
        )
        # Painting works on bytes, the look-up on floats: fused, both would be as wide as floats.
        codes = jax.lax.optimization_barrier(codes)
        return jnp.asarray(colours).at[codes].get(mode="clip")

    def render(env_state: Any) -> Float[Array, "x y 3"]:
        refuse_forked_process()
        _check_state(env_state)
        return draw(env_state)

    return render


def _check_state(env_state: Any) -> None:
    if not hasattr(env_state, "labels"):
        inside = " (its field env_state is one)" if hasattr(env_state, "env_state") else ""
        raise KinetixError(f"state: expected an EnvState, got {type(env_state).__name__}{inside}")
    if batch := jnp.shape(env_state.physics.position)[:-2]:
        raise KinetixError(
            f"state: expected one state, got a batch of shape {batch}: use jax.vmap(render)"
        )


@also_named(static_params="static_env_params")
def make_render_pixels(
    env_params: "EnvParams", static_env_params: "StaticEnvParams"
) -> Callable[["EnvState"], Float[Array, "x y 3"]]:
    """Return a function that draws the pixel observation of a state.

    Args:
        env_params: Its `pixels_per_unit` counts.
        static_env_params: Its `screen_dim`, `downscale` and `max_shape_size` count.

    Returns:
        A function of one `EnvState` (use `jax.vmap` for more): a picture with the axes
        [x, y, channel], y upwards, values 0–255. Show it with `transpose(1, 0, 2)[::-1]`.

    Raises:
        KinetixError: The two are swapped, or so small a picture cannot be.
    """
    return _make_renderer(pixel_grid(env_params, static_env_params), 1.0)


@also_named(static_params="static_env_params")
def make_render_pixels_rl(
    env_params: "EnvParams", static_env_params: "StaticEnvParams"
) -> Callable[["EnvState"], Float[Array, "x y 3"]]:
    """Like `make_render_pixels`, with values 0–1: the image of the pixel observation."""
    return _make_renderer(pixel_grid(env_params, static_env_params), 1 / 255)


__all__ = [
    "PixelGrid",
    "make_render_pixels",
    "make_render_pixels_rl",
    "pixel_codes",
    "pixel_grid",
]
