"""Convex shapes as one span of pixels a column: the fast way to paint small pictures.

A convex shape meets each column of the picture in one span, which has a closed form. So the test of
every pixel against every edge of every shape shrinks to two byte-wide operations a pixel and shape
(`paint`), which the compiler turns into full vectors. docs/rendering.md has the measurements.

Spans are pairs of real arrays `(low, high)`, shape [shapes, columns]: the first and the last row,
as whole numbers, both included; empty where high < low. Positions are in pixels and a pixel is
tested at its integer index. Everything is elementwise, so batches come from `jax.vmap` at no cost.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt

Span = tuple[Float[Array, "q x"], Float[Array, "q x"]]

FAR = 1e6
"""Stands for "no bound" [px]: beyond every canvas, and a whole number in single precision."""


def polygon_span(
    vertices: Float[Array, "q v 2"], inset: float, columns: Float[Array, " x"]
) -> Span:
    """Return the rows inside convex polygons.

    The pixel p is inside when cross(a − p, b − p) ≤ −inset·|b − a| for each edge a → b. That is
    linear in the row: an edge that is not vertical bounds it from one side, a vertical one keeps or
    drops the column.

    Args:
        vertices: Corners [px], clockwise; repeated corners are harmless.
        inset: How far to move the edges inwards [px].
        columns: Indices of the columns [px].
    """
    low = jnp.full((vertices.shape[0], columns.shape[0]), -FAR)
    high = jnp.full_like(low, FAR)
    x = columns[None, :]
    count = vertices.shape[1]
    for corner in range(count):
        ax, ay = (vertices[:, corner, k, None] for k in range(2))
        bx, by = (vertices[:, (corner + 1) % count, k, None] for k in range(2))
        dx, dy = bx - ax, by - ay
        margin = inset * jnp.sqrt(dx * dx + dy * dy)
        # Written so that a horizontal edge bounds at exactly its own row.
        crossing = ay + ((x - ax) * dy - margin) / jnp.where(dx == 0, 1.0, dx)
        crossing = jnp.clip(crossing, -FAR, FAR)
        outside = (dx == 0) & ((ax - x) * dy > -margin)
        low = jnp.where(dx < 0, jnp.maximum(low, jnp.ceil(crossing)), low)
        high = jnp.where(dx > 0, jnp.minimum(high, jnp.floor(crossing)), high)
        high = jnp.where(outside, -FAR, high)
    return low, high


def disc_span(
    centre: Float[Array, "q 2"], radius: Float[Array, " q"], columns: Float[Array, " x"]
) -> Span:
    """Return rows of the pixels whose distance from the centre is at most the radius [px]."""
    dx = columns[None, :] - centre[:, 0, None]
    square = radius[:, None] * radius[:, None] - dx * dx
    half = jnp.where((square >= 0) & (radius[:, None] >= 0), jnp.sqrt(jnp.abs(square)), -FAR)
    return jnp.ceil(centre[:, 1, None] - half), jnp.floor(centre[:, 1, None] + half)


def ray_span(
    centre: Float[Array, "q 2"], angle: Float[Array, " q"], columns: Float[Array, " x"]
) -> Span:
    """Rows nearer than one pixel to a line from the centre along the local +y axis, on its +y side.

    Args:
        centre: Where the lines start [px].
        angle: Rotation of the local frames [rad].
        columns: Indices of the columns [px].
    """
    dx = columns[None, :] - centre[:, 0, None]
    y, sin, cos = centre[:, 1, None], jnp.sin(angle)[:, None], jnp.cos(angle)[:, None]
    # |dx·cos + dy·sin| < 1, open on both sides.
    steep = jnp.where(sin == 0, 1.0, sin)
    first, second = (-1 - dx * cos) / steep, (1 - dx * cos) / steep
    upright = jnp.where(jnp.abs(dx * cos) < 1, FAR, -FAR)
    below = jnp.where(sin == 0, -upright, jnp.minimum(first, second))
    above = jnp.where(sin == 0, upright, jnp.maximum(first, second))
    low = jnp.floor(y + jnp.clip(below, -FAR, FAR)) + 1
    high = jnp.ceil(y + jnp.clip(above, -FAR, FAR)) - 1
    # −dx·sin + dy·cos ≥ 0.
    start = jnp.clip(dx * sin / jnp.where(cos == 0, 1.0, cos), -FAR, FAR)
    low = jnp.where(cos > 0, jnp.maximum(low, jnp.ceil(y + start)), low)
    high = jnp.where(cos < 0, jnp.minimum(high, jnp.floor(y + start)), high)
    return low, jnp.where((cos == 0) & (dx * sin > 0), -FAR, high)


def box_span(corner: Float[Array, "q 2"], width: float, columns: Float[Array, " x"]) -> Span:
    """Return rows of squares of pixels.

    Args:
        corner: Indices of their lowest pixels [px].
        width: Their side [px].
        columns: Indices of the columns [px].
    """
    dx = columns[None, :] - corner[:, 0, None]
    inside = (dx >= 0) & (dx < width)
    low = jnp.broadcast_to(corner[:, 1, None], dx.shape)
    return low, jnp.where(inside, low + (width - 1), -FAR)


def intersection(first: Span, second: Span) -> Span:
    """Return rows that lie in both."""
    return jnp.maximum(first[0], second[0]), jnp.minimum(first[1], second[1])


def byte_rows(
    span: Span, shown: Bool[Array, " q"], first: int, rows: int
) -> tuple[UInt[Array, "q x"], UInt[Array, "q x"]]:
    """Spans in the form that `paint` takes.

    Args:
        span: The spans.
        shown: Which shapes are drawn at all.
        first: Index of the lowest visible row.
        rows: How many rows are visible.

    Returns:
        First visible row and number of rows, in the narrowest unsigned type that holds them.
    """
    dtype = jnp.uint8 if rows < 256 else jnp.uint16
    low = jnp.clip(span[0] - first, 0, rows)
    high = jnp.clip(span[1] - first, -1, rows - 1)
    count = jnp.where(shown[:, None], jnp.maximum(high - low + 1, 0), 0)
    return low.astype(dtype), count.astype(dtype)


def paint(
    low: UInt[Array, "q x"],
    count: UInt[Array, "q x"],
    code: Int[Array, " q"],
    background: int,
    rows: int,
) -> UInt[Array, "x y"]:
    """Paint the shapes over each other, the last one on top.

    Args:
        low: First row of each shape in each column.
        count: Number of rows.
        code: What to write, 0–255.
        background: What to write where no shape is.
        rows: How many rows the picture has.

    Returns:
        One code a pixel.
    """
    row = jnp.arange(rows, dtype=low.dtype)[None, :]
    codes = code.astype(jnp.uint8)
    picture = jnp.full((low.shape[1], rows), background, jnp.uint8)
    for shape in range(low.shape[0]):
        # One comparison tests both ends: below the span the difference wraps around.
        inside = (row - low[shape][:, None]) < count[shape][:, None]
        picture = jnp.where(inside, codes[shape], picture)
    return picture


__all__ = [
    "FAR",
    "Span",
    "box_span",
    "byte_rows",
    "disc_span",
    "intersection",
    "paint",
    "polygon_span",
    "ray_span",
]
