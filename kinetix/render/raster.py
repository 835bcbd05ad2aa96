"""Anti-aliased convex shapes: signed distances, blending, and tiles that skip what is not there.

A `Layers` is a list of shapes in drawing order. The picture is cut into tiles; each tile paints
only the shapes whose boxes touch it, so the cost follows what is to be seen, not the capacity.
Positions are in pixels, y down; a pixel is sampled at its centre.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from kinetix.pytree import pytree
from kinetix.render.palette import Rgb

TILE_HEIGHT = 50
TILE_WIDTH = 100
"""Size of a tile [px]: small enough to stay in the cache, large enough to hide the loop."""

STRIPE_SHADE = 0.6
"""Share of the outline's colour in stripes, 0–1."""

_NOWHERE = 1e9
"""Distance that stands for "no edge here" [px]."""


@pytree
class Layers:
    """Convex shapes in drawing order: polygons with up to four edges, and discs."""

    normal: Float[Array, "l 4 2"]
    """Inward unit normals of the edges; zero for an edge that does not exist."""
    offset: Float[Array, "l 4"]
    """normal·p + offset is the distance inside the edge [px]."""
    centre: Float[Array, "l 2"]
    """Centre of a disc [px]."""
    radius: Float[Array, " l"]
    """Radius of a disc [px]; negative for polygons."""
    edge: Float[Array, " l"]
    """Thickness of the outline, inside the shape [px]."""
    fill: Float[Array, "l 3"]
    """Colour inside [0–255]."""
    ink: Float[Array, "l 3"]
    """Colour of the outline [0–255]."""
    box: Float[Array, "l 4"]
    """Left, top, right, bottom [px]."""
    shown: Bool[Array, " l"]
    """True where the shape is drawn at all."""
    stripes: Float[Array, "l 2 3"] | None = None
    """Two families of stripes: normal·p + offset counts periods; all zero for none."""
    stripe: Float[Array, "l 2"] | None = None
    """Period and width of the stripes [px]."""


def polygon_layers(
    corners: Float[Array, "l 4 2"],
    *,
    fill: Float[Array, "l 3"],
    ink: Float[Array, "l 3"],
    edge: Float[Array, " l"],
    shown: Bool[Array, " l"],
) -> Layers:
    """Return filled polygons with an outline.

    Args:
        corners: Corners [px], clockwise as seen; repeated ones are harmless.
        fill: Colour inside.
        ink: Colour of the outline.
        edge: Thickness of the outline [px].
        shown: Which are drawn.
    """
    along = jnp.roll(corners, -1, axis=1) - corners
    length = jnp.sqrt(jnp.sum(along * along, axis=-1, keepdims=True))
    exists = length > 1e-3
    inward = jnp.stack([-along[..., 1], along[..., 0]], axis=-1)
    normal = jnp.where(exists, inward / jnp.where(exists, length, 1.0), 0.0)
    offset = jnp.where(exists[..., 0], -jnp.sum(normal * corners, axis=-1), _NOWHERE)
    return Layers(
        normal=normal,
        offset=offset,
        centre=jnp.zeros_like(corners[:, 0]),
        radius=jnp.full_like(edge, -1.0),
        edge=edge,
        fill=fill,
        ink=ink,
        box=jnp.concatenate([corners.min(1), corners.max(1)], axis=-1),
        shown=shown,
    )


def disc_layers(
    centre: Float[Array, "l 2"],
    radius: Float[Array, " l"],
    *,
    fill: Float[Array, "l 3"],
    ink: Float[Array, "l 3"],
    edge: Float[Array, " l"],
    shown: Bool[Array, " l"],
) -> Layers:
    """Return filled discs with an outline; arguments as for `polygon_layers`."""
    count = radius.shape[0]
    return Layers(
        normal=jnp.zeros((count, 4, 2)),
        offset=jnp.full((count, 4), _NOWHERE),
        centre=centre,
        radius=jnp.maximum(radius, 0.0),
        edge=edge,
        fill=fill,
        ink=ink,
        box=jnp.concatenate([centre - radius[:, None], centre + radius[:, None]], axis=-1),
        shown=shown,
    )


def choose(first: Bool[Array, " l"], one: Layers, other: Layers) -> Layers:
    """Return row by row one or the other."""
    return jax.tree.map(
        lambda a, b: jnp.where(first.reshape((-1,) + (1,) * (a.ndim - 1)), a, b), one, other
    )


def interleave(*layers: Layers) -> Layers:
    """First row of each, then second row of each …: what belongs together stays together."""
    return jax.tree.map(
        lambda *rows: jnp.stack(rows, axis=1).reshape((-1, *rows[0].shape[1:])), *layers
    )


def concatenate(*layers: Layers) -> Layers:
    """Return one list after the other."""
    return jax.tree.map(lambda *rows: jnp.concatenate(rows), *layers)


def _pack(layers: Layers) -> Float[Array, "l k"]:
    """Return all numbers of a shape in one row, so that picking a shape is one copy."""
    count = layers.radius.shape[0]
    leaves = [leaf.reshape(count, -1).astype(jnp.float32) for leaf in jax.tree.leaves(layers)]
    return jnp.concatenate(leaves, axis=1)


def _unpack(row: Float[Array, " k"], layers: Layers) -> Layers:
    """Return one shape back from its row: the fields of `layers` without their first axis."""
    leaves, structure = jax.tree.flatten(layers)
    parts, start = [], 0
    for leaf in leaves:
        size = leaf[0].size
        parts.append(row[start : start + size].reshape(leaf.shape[1:]))
        start += size
    return jax.tree.unflatten(structure, parts)


def _depth(shape: Layers, x: Float[Array, "1 w"], y: Float[Array, "h 1"]) -> Float[Array, "h w"]:
    """Return the distance inside the shape [px], negative outside (near corners too large)."""

    def disc() -> Float[Array, "h w"]:
        dx, dy = x - shape.centre[0], y - shape.centre[1]
        return shape.radius - jnp.sqrt(dx * dx + dy * dy)

    def polygon() -> Float[Array, "h w"]:
        edges = [
            shape.normal[k, 0] * x + (shape.normal[k, 1] * y + shape.offset[k]) for k in range(4)
        ]
        return jnp.minimum(jnp.minimum(edges[0], edges[1]), jnp.minimum(edges[2], edges[3]))

    return jax.lax.cond(shape.radius >= 0, disc, polygon)


def _striped(shape: Layers, x: Float[Array, "1 w"], y: Float[Array, "h 1"]) -> Float[Array, "h w"]:
    """Return the share of each pixel that stripes cover."""
    assert shape.stripes is not None
    assert shape.stripe is not None
    covered = jnp.zeros((y.shape[0], x.shape[1]))
    for family in range(2):
        nx, ny, offset = (shape.stripes[family, k] for k in range(3))
        periods = nx * x + (ny * y + offset)
        distance = jnp.abs(periods - jnp.round(periods)) * shape.stripe[0]
        cover = jnp.clip(shape.stripe[1] / 2 - distance + 0.5, 0.0, 1.0)
        exists = (nx != 0) | (ny != 0)
        covered = jnp.where(exists, jnp.maximum(covered, cover), covered)
    return covered


def _paint_tile(
    layers: Layers,
    rows: Float[Array, "l k"],
    order: Int[Array, " l"],
    count: Int[Array, ""],
    corner: Int[Array, "2"],
    background: Rgb,
) -> UInt8[Array, "h w 3"]:
    x = corner[0].astype(jnp.float32) + jnp.arange(TILE_WIDTH, dtype=jnp.float32)[None, :] + 0.5
    y = corner[1].astype(jnp.float32) + jnp.arange(TILE_HEIGHT, dtype=jnp.float32)[:, None] + 0.5

    # The three channels are one array: three would be three loops over the tile for every shape.
    def blend(turn: Array, planes: Float[Array, "3 h w"]) -> Float[Array, "3 h w"]:
        row = jax.lax.dynamic_index_in_dim(rows, order[turn], keepdims=False)
        shape = _unpack(row, layers)
        depth = _depth(shape, x, y)
        cover = jnp.clip(depth + 0.5, 0.0, 1.0)
        inner = jnp.clip(depth - shape.edge + 0.5, 0.0, 1.0)
        if shape.stripes is not None:
            inner = inner * (1 - STRIPE_SHADE * _striped(shape, x, y))
        fill, ink = shape.fill[:, None, None], shape.ink[:, None, None]
        colour = ink + (fill - ink) * inner[None]
        return planes + (colour - planes) * cover[None]

    blank = jnp.broadcast_to(
        jnp.array(background, jnp.float32)[:, None, None], (3, TILE_HEIGHT, TILE_WIDTH)
    )
    planes = jax.lax.fori_loop(0, count, blend, blank)
    return jnp.moveaxis((planes + 0.5).astype(jnp.uint8), 0, -1)


def paint(layers: Layers, background: Rgb, width: int, height: int) -> UInt8[Array, "h w 3"]:
    """Blend all shapes over the background.

    Args:
        layers: The shapes, the last one on top.
        background: Colour where nothing is.
        width: Width of the picture [px].
        height: Height of the picture [px].

    Returns:
        The picture, row 0 at the top.
    """
    across, down = -(-width // TILE_WIDTH), -(-height // TILE_HEIGHT)
    left = jnp.arange(across) * TILE_WIDTH
    top = jnp.arange(down) * TILE_HEIGHT
    corner = jnp.stack(jnp.meshgrid(left, top), axis=-1).reshape(-1, 2)
    box = layers.box[None]
    touches = (
        layers.shown[None]
        & (box[..., 0] < corner[:, :1] + (TILE_WIDTH + 1))
        & (box[..., 2] > corner[:, :1] - 1)
        & (box[..., 1] < corner[:, 1:] + (TILE_HEIGHT + 1))
        & (box[..., 3] > corner[:, 1:] - 1)
    )
    # The touching shapes first, in their order.
    order = jnp.argsort(~touches, axis=1, stable=True)
    packed = _pack(layers)
    tiles = jax.lax.map(
        lambda tile: _paint_tile(layers, packed, tile[0], tile[1], tile[2], background),
        (order, touches.sum(axis=1), corner),
    )
    bands = tiles.reshape(down, across, TILE_HEIGHT, TILE_WIDTH, 3).swapaxes(1, 2)
    return bands.reshape(down * TILE_HEIGHT, across * TILE_WIDTH, 3)[:height, :width]


__all__ = [
    "TILE_HEIGHT",
    "TILE_WIDTH",
    "Layers",
    "choose",
    "concatenate",
    "disc_layers",
    "interleave",
    "paint",
    "polygon_layers",
]
