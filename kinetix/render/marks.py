"""The marks of the picture for people: role glyphs, joints, thrusters."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.render import poses, raster
from kinetix.render.palette import Palette, ink
from kinetix.render.style import ROLE_GLYPHS, THRUSTER_FLAME, THRUSTER_NOZZLE, Style

LEAST_MARK = 2.5
"""Radius below which joints and thrusters do not shrink, however far one zooms out [px]."""


def colour_table(colours: tuple[tuple[int, int, int], ...]) -> Float[Array, "k 3"]:
    """Return colours as an array to be indexed."""
    return jnp.asarray(np.array(colours, np.float32))


def _square(
    centre: Float[Array, "l 2"], angle: Float[Array, " l"], half: Float[Array, "l 2"]
) -> Float[Array, "l 4 2"]:
    """Corners [px] of rectangles with these half sides, clockwise, turned by angles (y is down)."""
    signs = jnp.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
    corners = signs[None] * half[:, None, :]
    turned = poses.rotated(corners, jnp.broadcast_to(angle[:, None], corners.shape[:2]))
    return centre[:, None, :] + turned * jnp.array([1.0, -1.0])


def role_glyphs(
    centre: Float[Array, "l 2"],
    angle: Float[Array, " l"],
    radius: Float[Array, " l"],
    role: Int[Array, " l"],
    fixed: Bool[Array, " l"],
    shown: Bool[Array, " l"],
    palette: Palette,
) -> tuple[raster.Layers, raster.Layers]:
    """Return the two shapes of every body's glyph: ● green, ◎ blue, ✕ red, nothing for the others.

    Args:
        centre: Middle of the bodies [px].
        angle: Rotation of the bodies [rad].
        radius: Radius of the glyphs [px].
        role: Role numbers.
        fixed: Whether the bodies are fixed (their fill is darker).
        shown: Whether the bodies are drawn.
        palette: The colours in use.
    """
    fills = [palette.fill(number, dark) for dark in (False, True) for number in range(4)]
    kind = role + 4 * fixed
    body = colour_table(tuple(fills))[kind]
    sign = colour_table(tuple(ink(fill) for fill in fills))[kind]
    zero = jnp.zeros_like(radius)
    disc = jnp.asarray([glyph.disc if glyph else 0.0 for glyph in ROLE_GLYPHS])[role] * radius
    ring = jnp.asarray([(glyph and glyph.ring) or (0.0, 0.0) for glyph in ROLE_GLYPHS])[role]
    bar = jnp.asarray([(glyph and glyph.cross) or (0.0, 0.0) for glyph in ROLE_GLYPHS])[role]
    crossed = bar[:, 0] > 0
    rounded = (
        raster.disc_layers(
            centre,
            ring[:, 1] * radius,
            fill=body,
            ink=sign,
            edge=(ring[:, 1] - ring[:, 0]) * radius,
            shown=shown & (ring[:, 1] > 0),
        ),
        raster.disc_layers(centre, disc, fill=sign, ink=sign, edge=zero, shown=shown & (disc > 0)),
    )
    bars = [
        raster.polygon_layers(
            _square(centre, angle + turn, bar * radius[:, None]),
            fill=sign,
            ink=sign,
            edge=zero,
            shown=shown & crossed,
        )
        for turn in (math.pi / 4, -math.pi / 4)
    ]
    return (
        raster.choose(crossed, bars[0], rounded[0]),
        raster.choose(crossed, bars[1], rounded[1]),
    )


def joint_marks(  # noqa: PLR0913  (one argument a property of the mark)
    centre: Float[Array, "j 2"],
    angle: Float[Array, " j"],
    weld: Bool[Array, " j"],
    colour: Float[Array, "j 3"],
    shown: Bool[Array, " j"],
    scale: Float[Array, ""],
    palette: Palette,
    style: Style,
) -> raster.Layers:
    """Return a disc for a revolute joint, a square that turns with the first body for a weld.

    Args:
        centre: Where the joints are [px].
        angle: Rotation of the squares [rad].
        weld: Which joints are welds.
        colour: Fill of the marks.
        shown: Which joints are drawn.
        scale: Zoom [px/m].
        palette: The colours in use.
        style: The sizes in use.
    """
    radius = jnp.broadcast_to(jnp.maximum(style.joint_radius * scale, LEAST_MARK), angle.shape)
    edge = jnp.broadcast_to(_mark_edge(scale, style), angle.shape)
    outline = jnp.broadcast_to(colour_table((palette.outline,)), colour.shape)
    looks = {"fill": colour, "ink": outline, "edge": edge, "shown": shown}
    half = jnp.stack([radius, radius], axis=-1) * 0.9
    return raster.choose(
        weld,
        raster.polygon_layers(_square(centre, angle, half), **looks),
        raster.disc_layers(centre, radius, **looks),
    )


def _mark_edge(scale: Float[Array, ""], style: Style) -> Float[Array, ""]:
    return jnp.maximum(style.mark_outline * scale, style.least_outline / 2)


def thruster_marks(
    centre: Float[Array, "t 2"],
    direction: Float[Array, " t"],
    flame: Float[Array, "t 3"],
    shown: Bool[Array, " t"],
    scale: Float[Array, ""],
    palette: Palette,
    style: Style,
) -> tuple[raster.Layers, raster.Layers]:
    """Draw the flames and nozzles of thrusters.

    Args:
        centre: Where the thrusters sit [px].
        direction: Where they push [rad].
        flame: Colour of the flames.
        shown: Which thrusters are drawn.
        scale: Zoom [px/m].
        palette: The colours in use.
        style: The sizes in use.
    """
    size = jnp.maximum(style.thruster_size * scale, 4 * LEAST_MARK)
    edge = jnp.broadcast_to(_mark_edge(scale, style), direction.shape)
    outline = jnp.broadcast_to(colour_table((palette.outline,)), flame.shape)
    nozzle = jnp.broadcast_to(colour_table((palette.nozzle,)), flame.shape)
    made = []
    for points, fill in ((THRUSTER_FLAME, flame), (THRUSTER_NOZZLE, nozzle)):
        four = (*points, points[-1])[:4]
        local = jnp.asarray(np.array(four, np.float32))[None] * size
        shape = (centre.shape[0], 4)
        turned = poses.rotated(
            jnp.broadcast_to(local, (*shape, 2)), jnp.broadcast_to(direction[:, None], shape)
        )
        corners = centre[:, None, :] + turned * jnp.array([1.0, -1.0])
        made.append(raster.polygon_layers(corners, fill=fill, ink=outline, edge=edge, shown=shown))
    return made[0], made[1]


__all__ = ["LEAST_MARK", "colour_table", "joint_marks", "role_glyphs", "thruster_marks"]
