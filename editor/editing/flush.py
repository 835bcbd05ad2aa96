"""Corners that lie flush with slanted edges."""

import bisect
import math

from kinetix.level.model import Point


def flush(
    points: tuple[Point, ...], segments: tuple[tuple[Point, Point], ...], catch: float
) -> Point | None:
    """Return the least shift that puts one of the points on a slanted edge, or None.

    Args:
        points: What is dragged.
        segments: The edges.
        catch: How far a point may go [m].
    """
    best: tuple[float, Point] | None = None
    order = sorted(range(len(points)), key=lambda index: points[index][0])
    across = [points[index][0] for index in order]
    for (px, py), (qx, qy) in segments:
        dx, dy = qx - px, qy - py
        squared = dx * dx + dy * dy
        left = bisect.bisect_left(across, min(px, qx) - catch)
        right = bisect.bisect_right(across, max(px, qx) + catch)
        bottom, top = min(py, qy) - catch, max(py, qy) + catch
        near = [index for index in order[left:right] if bottom <= points[index][1] <= top]
        for x, y in (points[index] for index in sorted(near)):
            along = min(max(((x - px) * dx + (y - py) * dy) / squared, 0.0), 1.0)
            shift = (px + along * dx - x, py + along * dy - y)
            distance = math.hypot(*shift)
            if distance <= catch and (best is None or distance < best[0]):
                best = (distance, shift)
    return best[1] if best else None
