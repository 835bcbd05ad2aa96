"""Changed parts of a picture, each as the bytes of an image file."""

import io
from collections.abc import Sequence
from typing import Final, Literal

import numpy as np
from jaxtyping import Bool, UInt8
from PIL import Image

Box = tuple[int, int, int, int]
"""Left, top, right, bottom [px]."""
Picture = UInt8[np.ndarray, "height width 3"]
"""Red, green, blue; top row first."""
Kind = Literal["image/png", "image/jpeg"]

_TILE: Final = 32
"""Changes are found in squares of this side [px]."""
_EXACT: Final = 96 * 1024
"""Up to this area a part is sent without loss [px²]: above, that takes longer than a frame."""
_QUALITY: Final = 88


def changes(before: Picture | None, after: Picture) -> list[Box]:
    """Return boxes that cover all pixels in which two pictures differ.

    Args:
        before: The earlier picture; None, or one of another size: everything differs.
        after: The later picture.
    """
    height, width = after.shape[:2]
    if before is None or before.shape != after.shape:
        return [(0, 0, width, height)]
    rows = [
        (top, _differing_tiles(before[top : top + _TILE], after[top : top + _TILE]))
        for top in range(0, height, _TILE)
    ]
    boxes: list[Box] = []
    for top, tiles in rows:
        bottom = min(top + _TILE, height)
        for first, last in _runs(tiles):
            left, right = first * _TILE, min(last * _TILE, width)
            boxes = _added(boxes, (left, top, right, bottom))
    return boxes


def _differing_tiles(a: np.ndarray, b: np.ndarray) -> Bool[np.ndarray, " tiles"]:
    """Return which tiles of a row of tiles differ."""
    rows, width = a.shape[:2]
    count = -(-width // _TILE)
    if np.array_equal(a, b):
        return np.zeros(count, np.bool_)
    differs = (a != b).reshape(rows, width * 3).any(axis=0).reshape(width, 3).any(axis=1)
    return np.logical_or.reduceat(differs, np.arange(0, width, _TILE))


def _runs(tiles: np.ndarray) -> list[tuple[int, int]]:
    """Return the first index and the index after the last of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], tiles.astype(np.int8), [0]))))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _added(boxes: list[Box], box: Box) -> list[Box]:
    """Add a box, grown onto the one right above it where both are equally wide."""
    left, top, right, bottom = box
    for k, (l, t, r, b) in enumerate(boxes):
        if (l, r, b) == (left, right, top):
            return [*boxes[:k], (left, t, right, bottom), *boxes[k + 1 :]]
    return [*boxes, box]


def area(boxes: Sequence[Box]) -> int:
    """Return the area of boxes that do not overlap [px²]."""
    return sum((r - l) * (b - t) for l, t, r, b in boxes)


def kind_for(boxes: Sequence[Box]) -> Kind:
    """Return how to send what has changed: large changes with loss, to keep up with motion."""
    return "image/png" if area(boxes) <= _EXACT else "image/jpeg"


def encoded(picture: Picture, box: Box, kind: Kind) -> bytes:
    """Return a part of a picture as an image file."""
    left, top, right, bottom = box
    part = Image.fromarray(np.ascontiguousarray(picture[top:bottom, left:right]))
    file = io.BytesIO()
    if kind == "image/png":
        part.save(file, format="PNG", compress_level=1)
    else:
        # Thin lines and letters keep their colours only where these are not halved.
        part.save(file, format="JPEG", quality=_QUALITY, subsampling=0)
    return file.getvalue()
