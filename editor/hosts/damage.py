"""Parts of the window that a frame changes: only they are drawn again.

Dear ImGui describes every frame from scratch. In software OpenGL filling all those pixels takes
longer than everything else together, and most frames differ from the one before by a highlight and
a number in the status bar. So the triangles of both frames are compared, window by window.
"""

import ctypes
import dataclasses
from collections.abc import Collection, Sequence
from typing import Any, Final

import numpy as np
from imgui_bundle import imgui
from jaxtyping import UInt32

Rect = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""
Command = tuple[Rect, int, int, int, int]
"""Clip rectangle, texture, number of indices, first index, first vertex."""

_MARGIN: Final = 2.0
"""Soft edges reach this far beyond the corners of their triangles [px]."""
_WORDS: Final = imgui.VERTEX_SIZE // 4
_MOST: Final = 4
"""Most rectangles drawn one by one: each costs a pass."""
_COMPARED: Final = 16
"""Most rectangles that are compared with each other."""
_WHOLE: Final = 0.75
"""From this share of the window on everything is drawn at once."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class DrawnList:
    """The triangles of one of Dear ImGui's windows."""

    name: str
    vertices: UInt32[np.ndarray, "n 5"]
    """Position and texture coordinate as the bits of floats, colour."""
    indices: UInt32[np.ndarray, " i"]
    commands: tuple[Command, ...]

    @property
    def clip(self) -> Rect:
        """Union of its commands' clip rectangles."""
        return union([command[0] for command in self.commands])


def drawn_lists(draw_data: imgui.ImDrawData) -> list[DrawnList]:
    """Copy what a frame draws, for comparing it with the next."""
    found = []
    for one in draw_data.cmd_lists:
        commands = []
        for command in one.cmd_buffer:
            clip = command.clip_rect
            commands.append(
                (
                    (clip.x, clip.y, clip.z, clip.w),
                    int(command.get_tex_id()),
                    command.elem_count,
                    command.idx_offset,
                    command.vtx_offset,
                )
            )
        vertices = _words(one.vtx_buffer, _WORDS).reshape(-1, _WORDS)
        indices = _words(one.idx_buffer, 1)
        found.append(
            DrawnList(
                name=one._owner_name,
                vertices=vertices,
                indices=indices,
                commands=tuple(commands),
            )
        )
    return found


def _words(buffer: Any, per_item: int) -> UInt32[np.ndarray, " n"]:
    count = buffer.size() * per_item
    if not count:
        return np.zeros(0, np.uint32)
    raw = (ctypes.c_uint32 * count).from_address(buffer.data_address())
    return np.frombuffer(raw, np.uint32).copy()


def union(rects: Sequence[Rect]) -> Rect:
    """Return the smallest rectangle around some; an empty one around none."""
    if not rects:
        return (0.0, 0.0, 0.0, 0.0)
    lows = (min(r[0] for r in rects), min(r[1] for r in rects))
    return (*lows, max(r[2] for r in rects), max(r[3] for r in rects))


def intersection(a: Rect, b: Rect) -> Rect:
    """Return the intersection of two rectangles; without width or height where there is none."""
    left, top = max(a[0], b[0]), max(a[1], b[1])
    return left, top, max(min(a[2], b[2]), left), max(min(a[3], b[3]), top)


def area(rect: Rect) -> float:
    """Return the area of a rectangle [px²]."""
    return max(rect[2] - rect[0], 0.0) * max(rect[3] - rect[1], 0.0)


def damage(
    before: Sequence[DrawnList],
    after: Sequence[DrawnList],
    size: tuple[int, int],
    touched: Collection[int] = (),
) -> list[Rect] | None:
    """Return the part of the window that has to be drawn again.

    Args:
        before: The last frame.
        after: This frame.
        size: Size of the window [px].
        touched: Textures whose content has changed.

    Returns:
        Rectangles on whole pixels that do not overlap much; None: everything.
    """
    old = {one.name: one for one in before}
    new = {one.name: one for one in after}
    if len(old) != len(before) or len(new) != len(after):
        return None
    kept = [one.name for one in after if one.name in old]
    if kept != [one.name for one in before if one.name in new]:
        return None  # windows have changed their order: what lies over what is another
    rects = [_box(one.vertices, one.clip) for one in before if one.name not in new]
    rects += [_box(one.vertices, one.clip) for one in after if one.name not in old]
    for name in kept:
        rects += _changed(old[name], new[name], touched)
    window = (0.0, 0.0, float(size[0]), float(size[1]))
    found = [intersection(_whole_pixels(rect), window) for rect in rects if area(rect) > 0]
    merged = _merged([rect for rect in found if area(rect) > 0])
    if sum(map(area, merged)) > _WHOLE * area(window):
        return None
    return merged


def _changed(old: DrawnList, new: DrawnList, touched: Collection[int]) -> list[Rect]:
    """Return the part in which one window differs."""
    rects = [
        _box(_used(new, command), command[0]) for command in new.commands if command[1] in touched
    ]
    if [c[:2] for c in old.commands] != [c[:2] for c in new.commands]:
        # The same triangles may be cut off elsewhere, or have another texture.
        rects += [command[0] for command in set(old.commands) ^ set(new.commands)]
    a, b = old.vertices, new.vertices
    clip = union([old.clip, new.clip])
    if len(a) == len(b):
        rows = (a != b).any(axis=1)
        if rows.any():
            return [*rects, _box(np.concatenate((a[rows], b[rows])), clip)]
        same = np.array_equal(old.indices, new.indices)
        return rects if same else [*rects, clip]
    short = min(len(a), len(b))
    head = _agreement(a[:short], b[:short])
    tail = min(_agreement(a[::-1][:short], b[::-1][:short]), short - head)
    changed = np.concatenate((a[head : len(a) - tail], b[head : len(b) - tail]))
    return [*rects, _box(changed, clip)]


def _agreement(a: np.ndarray, b: np.ndarray) -> int:
    """Count the rows that are equal from the start."""
    differing = (a != b).any(axis=1)
    return int(differing.argmax()) if differing.any() else len(a)


def _used(one: DrawnList, command: Command) -> np.ndarray:
    """Return the vertices of a command."""
    _, _, count, first, offset = command
    return one.vertices[one.indices[first : first + count].astype(np.int64) + offset]


def _box(vertices: np.ndarray, clip: Rect) -> Rect:
    """Around some vertices, with a margin, as far as the clip rectangle shows them."""
    if not len(vertices):
        return (0.0, 0.0, 0.0, 0.0)
    places = np.ascontiguousarray(vertices[:, :2]).view(np.float32)
    # A gap in a plotted curve leaves NaN corners: they draw nothing, but would make the box NaN.
    places = places[~np.isnan(places).any(axis=1)]
    if not len(places):
        return (0.0, 0.0, 0.0, 0.0)
    low, high = places.min(axis=0) - _MARGIN, places.max(axis=0) + _MARGIN
    return intersection((float(low[0]), float(low[1]), float(high[0]), float(high[1])), clip)


def _whole_pixels(rect: Rect) -> Rect:
    left, top, right, bottom = rect
    return float(left // 1), float(top // 1), float(-(-right // 1)), float(-(-bottom // 1))


def _merged(rects: list[Rect]) -> list[Rect]:
    """Few rectangles that cover the same: those that overlap, and the cheapest to join.

    Of very many, such as all cards of a gallery, neighbours in the order of drawing are joined
    unseen: looking at each pair of them would take longer than drawing the whole window.
    """
    found = list(dict.fromkeys(rects))
    while len(found) > _COMPARED:
        found = [union(found[k : k + 2]) for k in range(0, len(found), 2)]
    while len(found) > 1:
        pairs = [(i, j) for i in range(len(found)) for j in range(i)]
        costs = [
            area(union([found[i], found[j]])) - area(found[i]) - area(found[j]) for i, j in pairs
        ]
        best = min(range(len(pairs)), key=costs.__getitem__)
        if costs[best] > 0 and len(found) <= _MOST:
            break
        i, j = pairs[best]
        joined = union([found[i], found[j]])
        found = [rect for k, rect in enumerate(found) if k not in (i, j)] + [joined]
    return found
